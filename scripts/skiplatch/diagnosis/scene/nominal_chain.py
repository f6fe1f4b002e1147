"""Touches, and what the nominal chain says of each."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.campaign import Axis, InputPath, Kind, Nominal, Status, Touches
from skiplatch.diagnosis.scene.grid import off_grid
from skiplatch.diagnosis.scene.periodogram import shortest_wave
from skiplatch.motion import Contact, expected_contact
from skiplatch.simulator.playing import warmths_k
from skiplatch.units import UM_PER_MM, UM_US_PER_MM_S

LOBES = 3.0
FALLEN = 0.1
"""Cosine of the elevation, or share of the lobes by which they differ with it, that shows them."""


@dataclass(frozen=True, eq=False)
class NominalChain:
    """The touches of a campaign in order of time, and what the nominal chain says of each."""

    nominal: Nominal
    touches: Touches
    whole: Self | None = None
    """That of which this one is a part, for what depends on the touches before."""
    chosen: IndexArray | None = None
    """Which touches of the whole these are; shape (n,)."""

    def __len__(self) -> int:
        return len(self.touches)

    @cached_property
    def is_machine(self) -> bool:
        """A probe touches a surface; otherwise edges are injected."""
        return self.nominal.kind == Kind.MACHINE

    @cached_property
    def plc(self) -> BoolArray:
        """Latched by the PLC task; shape (n,)."""
        return np.asarray(self.touches.path == InputPath.PLC)

    @cached_property
    def contact(self) -> Contact:
        """When and how fast the surface is expected to be met."""
        return expected_contact(self.nominal, self.touches)

    @cached_property
    def speed(self) -> FloatArray:
        """Speed at the contact in µm/µs; shape (n,)."""
        return self.contact.speed_mm_s * UM_US_PER_MM_S

    @cached_property
    def alpha(self) -> FloatArray:
        """Azimuth in radians; shape (n,)."""
        return np.deg2rad(np.nan_to_num(self.touches.alpha_deg))

    @cached_property
    def cos_beta(self) -> FloatArray:
        """Cosine of the elevation; shape (n,)."""
        return np.cos(np.deg2rad(np.nan_to_num(self.touches.beta_deg)))

    @cached_property
    def sign(self) -> FloatArray:
        """Sense of the motion, 1 where it was not recorded; shape (n,)."""
        return np.nan_to_num(self.touches.sign, nan=1.0)

    @cached_property
    def latched_mm(self) -> FloatArray:
        """Coordinate of the axis at the latch, NaN where it was not recorded; shape (n,)."""
        beyond_mm = np.nan_to_num(self.touches.deviation_um) / UM_PER_MM
        return np.asarray(self.touches.position_mm + self.sign * beyond_mm)

    @cached_property
    def warmths(self) -> FloatArray:
        """Degrees above the calibration by each thermometer, temp_c first; shape (1 + t, n)."""
        return warmths_k(self.touches, self.nominal.probe.calibrated_at_c)

    @cached_property
    def warmth_before_k_s(self) -> FloatArray:
        """Degrees above it times seconds, up to the start of each touch's motion; shape (n,)."""
        if self.whole is not None:
            return self.whole.warmth_before_k_s[self.chosen]
        steps_s = np.diff(self.touches.time_s, prepend=0.0)
        return np.asarray(np.cumsum(self.warmths[0] * steps_s))

    @cached_property
    def lobes_um(self) -> FloatArray:
        """What the calibrated lobes add to the pretravel of each touch; shape (n,)."""
        probe = self.nominal.probe
        azimuth = LOBES * (self.alpha - np.deg2rad(probe.lobe_phase_deg))
        return np.asarray(probe.lobe_um * self.cos_beta * np.cos(azimuth))

    @cached_property
    def off_grid_us(self) -> FloatArray:
        """PLC stamps off the grid of scans, whose phase they tell; NaN for others; shape (n,)."""
        stamps = np.where(self.plc & self.has_stamps, self.touches.latch_us, np.nan)
        return off_grid(stamps, self.nominal.plc.scan_us)

    @property
    def least_pretravel_um(self) -> float:
        """What no pretravel is below."""
        return 0.0 if self.nominal.version == 1 else -np.inf

    @cached_property
    def pretravel_um(self) -> FloatArray:
        """Calibrated pretravel in the direction of each touch; shape (n,)."""
        calibrated = self.nominal.probe.pretravel_um + self.lobes_um
        return np.asarray(np.maximum(self.least_pretravel_um, calibrated)) * self.is_machine

    @cached_property
    def wait_us(self) -> FloatArray:
        """From the mechanical trigger to the earliest latch; shape (n,)."""
        latency = np.where(self.plc, 0.0, self.nominal.skip.latency_us)
        return self.nominal.probe.delay_us + self.nominal.input.filter_us + latency

    @cached_property
    def scatter_us(self) -> FloatArray:
        """Width of the latch's own box: jitter of the interrupt, or period of the scan."""
        return np.where(self.plc, self.nominal.plc.scan_us, self.nominal.skip.jitter_us)

    @cached_property
    def mechanics_us(self) -> FloatArray:
        """Scatter of the trigger by the probe's repeatability, or of the recorded edge; 1 sigma."""
        if self.is_machine:
            return self.nominal.probe.repeatability_um / self.speed
        return np.full(len(self), self.nominal.bench.reference_jitter_us)

    @cached_property
    def false(self) -> BoolArray:
        """Latched with no contact: nothing of it is an outcome of the chain; shape (n,)."""
        return np.asarray(self.touches.status == Status.FALSE)

    def over_x(self, y_excess_ratio: float, z_excess_ratio: float) -> FloatArray:
        """Give what an error that differs from axis to axis is over that of X; shape (n,)."""
        return 1.0 + self.beyond_x(y_excess_ratio, z_excess_ratio)

    def beyond_x(self, y: float, z: float) -> FloatArray:
        """Give what the touches of Y and Z have more than those of X; shape (n,)."""
        of_y, of_z = self._axes_beyond_x
        return np.asarray(y * of_y + z * of_z)

    @cached_property
    def _axes_beyond_x(self) -> FloatArray:
        axis = self.touches.axis
        return np.array([axis == Axis.Y, axis == Axis.Z], dtype=float)

    @cached_property
    def rest_s(self) -> FloatArray:
        """From the start of the move before to that of this one, the first like the second."""
        if self.whole is not None:
            return self.whole.rest_s[self.chosen]
        steps = np.diff(self.touches.time_s)
        return np.concatenate([steps[:1], steps]) if len(steps) else np.zeros(len(self))

    @cached_property
    def follows(self) -> BoolArray:
        """The touch before is the last one that was made, by their numbers; shape (n,)."""
        if self.whole is not None:
            return self.whole.follows[self.chosen]
        return np.asarray(np.diff(self.touches.touch, prepend=self.touches.touch[:1] - 2) == 1)

    @cached_property
    def alpha_before(self) -> FloatArray:
        """Azimuth of the touch before in radians; shape (n,)."""
        if self.whole is not None:
            return self.whole.alpha_before[self.chosen]
        return np.roll(self.alpha, 1)

    @cached_property
    def shortest_wave_mm(self) -> float:
        """Shortest period that the positions can show; infinite for too few of them."""
        return shortest_wave(self.touches.position_mm)

    @cached_property
    def is_sideways(self) -> BoolArray:
        """The stylus is pushed to a side that is known, where lobes show; shape (n,)."""
        return ~np.isnan(self.touches.alpha_deg) & (self.cos_beta > FALLEN)

    @cached_property
    def shortest_lobe_deg(self) -> float:
        """Shortest period that the azimuths can show; infinite for too few of them."""
        return shortest_wave(self.touches.alpha_deg[self.is_sideways])

    @cached_property
    def has_stamps(self) -> BoolArray:
        """The latch was stamped; shape (n,)."""
        return ~np.isnan(self.touches.latch_us) & (self.nominal.arrival_us is None)

    @cached_property
    def has_arrivals(self) -> BoolArray:
        """An arrival stands for the stamp; shape (n,)."""
        return ~np.isnan(self.touches.latch_us) & (self.nominal.arrival_us is not None)

    @cached_property
    def begin_us(self) -> FloatArray:
        """What the latch is counted from: the recorded edge, or the expected contact."""
        edge = self.touches.edge_us
        return (
            self.contact.time_us
            if self.is_machine
            else np.where(np.isnan(edge), self.contact.time_us, edge)
        )
