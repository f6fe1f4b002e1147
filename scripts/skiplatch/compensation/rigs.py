"""The rigs of the document on variable-speed compensation, as the simulation plays them.

Where a figure of the simulation comes from stands beside it in `Rig.origins`: what was set so that
it agrees with the document is no evidence for the document.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import (
    AxisNominal,
    BenchNominal,
    InputNominal,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
)
from skiplatch.compensation.firmware import Side
from skiplatch.compensation.touching import Directions, Target
from skiplatch.simulator.rig import Seat
from skiplatch.units import US_PER_MS

M_PER_MM = 1e-3
UM_PER_M = 1e6
POLE_DEG = 90.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reported:
    """What the document prints of a rig; None where it prints nothing."""

    tau_ms: float
    vr_before_um: float
    vr_after_um: float
    feed_min_mm_min: float
    feed_max_mm_min: float
    time_increase: float | None = None
    single_before_um: float | None = None
    single_after_um: float | None = None
    vr_equator_um: float | None = None
    vr_top_um: float | None = None
    """At β = 80°."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rig:
    """A rig, its probe, and how it was measured."""

    title: str
    nominal: Nominal
    """What the engineer knows: no lobes, and the delay, which the experiment finds anew."""
    seat: Seat
    ring: Target
    """What the delay is measured on, in directions of β = 0°."""
    ring_directions: Directions
    ring_feeds_mm_min: tuple[float, ...]
    ring_runs: int
    """At each feed."""
    target: Target
    """What the map is measured on."""
    directions: Directions
    runs: int
    feed_mm_min: float
    """Of the map before compensation."""
    reported: Reported
    origins: Mapping[str, str]
    """Parameter of the simulation, and where its value comes from."""

    @property
    def touches(self) -> int:
        """Of the ring, of the map before and of the one after."""
        ring = len(self.ring_directions) * self.ring_runs * len(self.ring_feeds_mm_min)
        return ring + 2 * self.runs * len(self.directions)


def grid(betas_deg: tuple[float, ...], azimuths: int, *, with_pole: bool = False) -> Directions:
    """Give so many azimuths, evenly, at each β, and the pole on top."""
    alpha_deg, beta_deg = np.meshgrid(np.arange(azimuths) * 360.0 / azimuths, betas_deg)
    alphas, betas = alpha_deg.ravel(), beta_deg.ravel()
    if with_pole:
        alphas, betas = np.append(alphas, 0.0), np.append(betas, POLE_DEG)
    return Directions(alphas, betas)


def _stem_n_m2(stylus_mm: float, bending_um_n: float) -> float:
    """Give the flexural rigidity of a clamped bar that bends so much at its end."""
    return (stylus_mm * M_PER_MM) ** 3 * UM_PER_M / (3.0 * bending_um_n)


def _seat(
    spring_n: float,
    seat_ratio: float,
    bending_um_n: float,
    axial_um_n: float,
    evenness: float,
    stylus_mm: float,
    azimuth_deg: float,
) -> Seat:
    return Seat(
        spring_n=spring_n,
        seat_mm=seat_ratio * stylus_mm,
        stylus_mm=stylus_mm,
        stem_n_m2=_stem_n_m2(stylus_mm, bending_um_n),
        axial_um_n=axial_um_n,
        evenness=evenness,
        azimuth_deg=azimuth_deg,
        reseat_um=0.3,
    )


def _nominal(repeatability_um: float, tau_ms: float, axis: AxisNominal) -> Nominal:
    return Nominal(
        kind=Kind.MACHINE,
        probe=ProbeNominal(
            pretravel_um=0.0,
            lobe_um=0.0,
            lobe_phase_deg=0.0,
            repeatability_um=repeatability_um,
            delay_us=tau_ms * US_PER_MS,
        ),
        input=InputNominal(filter_us=5.0),
        skip=SkipNominal(latency_us=2.0, jitter_us=1.0, tick_us=0.25),
        plc=PlcNominal(scan_us=4000.0),
        axis=axis,
        report=ReportNominal(latency_us=500.0, jitter_us=50.0),
        bench=BenchNominal(reference_jitter_us=0.0),
    )


_FITTED = "fitted to the document's V_r and range of feeds"
_ORIGINS = {
    "spring_n, seat_mm, stem_n_m2, axial_um_n, evenness": _FITTED,
    "stylus_mm": "the document",
    "delay_us": "the document's tau",
    "feed before compensation": "the document",
    "directions of the map": "their number, where the document gives one; the grid is ours",
    "azimuth_deg, reseat_um": "ours",
    "filter_us, latency_us, jitter_us, tick_us, scan_us": "ours",
    "resolution_um, accel_mm_s2, approach, offset of the artefact": "ours",
}

_PIEZO = AxisNominal(resolution_um=0.01, accel_mm_s2=500.0)
_MACHINE = AxisNominal(resolution_um=0.1, accel_mm_s2=1000.0)

# The tip stands in the artefact, which the table moves against it.
_ARTEFACT = Target(
    side=Side.INSIDE,
    radius_mm=0.05,
    offset_mm=(0.002, -0.0015, 0.001),
    is_moved=True,
    clearance_mm=0.0,
)
_LAB = Rig(
    title="lab, OMP40-2, 50 mm stylus",
    nominal=_nominal(0.45, 12.68, _PIEZO),
    seat=_seat(5.85, 0.0855, 20.67, 2.17, 0.121, 50.0, 0.0),
    ring=_ARTEFACT,
    ring_directions=grid((0.0,), 36),
    ring_feeds_mm_min=(25.0, 50.0, 75.0),
    ring_runs=5,
    target=_ARTEFACT,
    directions=grid((0.0, 20.0, 40.0, 60.0, 80.0), 36),
    runs=10,
    feed_mm_min=50.0,
    reported=Reported(
        tau_ms=12.68,
        vr_before_um=11.0,
        vr_after_um=1.0,
        feed_min_mm_min=26.46,
        feed_max_mm_min=69.87,
        vr_equator_um=8.6,
        vr_top_um=2.3,
    ),
    origins={**_ORIGINS, "repeatability_um": "from the document's V_r after compensation"},
)

RIGS: Mapping[str, Rig] = {
    "omp40-2": _LAB,
    "omp60": replace(
        _LAB,
        title="lab, OMP60, 50 mm stylus",
        nominal=_nominal(0.45, 25.35, _PIEZO),
        seat=_seat(5.30, 0.1415, 22.66, 2.17, 0.121, 50.0, 0.0),
        reported=Reported(
            tau_ms=25.35,
            vr_before_um=16.8,
            vr_after_um=1.0,
            feed_min_mm_min=31.24,
            feed_max_mm_min=66.18,
        ),
    ),
    "haas": Rig(
        title="Haas VF7, OMP40-2, 100 mm stylus",
        nominal=_nominal(0.9, 14.5, _MACHINE),
        seat=_seat(5.85, 0.0427, 88.4, 0.05 * 88.4, 0.15, 100.0, 5.0),
        ring=Target(
            side=Side.INSIDE,
            radius_mm=26.0 - 3.0,
            offset_mm=(0.008, -0.005, 0.0),
            is_moved=False,
            clearance_mm=21.0,
        ),
        ring_directions=grid((0.0,), 36),
        ring_feeds_mm_min=(50.0, 100.0, 150.0),
        ring_runs=5,
        target=Target(
            side=Side.OUTSIDE,
            radius_mm=12.5 + 3.0,
            offset_mm=(0.006, 0.004, -0.007),
            is_moved=False,
            clearance_mm=2.0,
        ),
        directions=grid((0.0, 40.0, 80.0), 36, with_pole=True),
        runs=10,
        feed_mm_min=100.0,
        reported=Reported(
            tau_ms=14.5,
            vr_before_um=21.0,
            vr_after_um=2.0,
            feed_min_mm_min=43.594,
            feed_max_mm_min=131.277,
            time_increase=0.046,
            single_before_um=23.0,
            single_after_um=6.0,
        ),
        origins={
            **_ORIGINS,
            "repeatability_um": "from the document's V_r and single-run maximum after compensation",
            "ring, feeds, runs": "the document",
        },
    ),
}
