"""A recorded campaign as residuals of the nominal chain, stage by stage.

Each stream is what one stretch of the chain adds, as far as it was recorded: with time stamps and
edges the stretches come apart, and the likelihood is a product over them.
"""

from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Axis, Campaign, InputPath, Kind, Nominal, Status, Touches
from skiplatch.campaign.datum import DatumFreedom
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.datum import SHIFTED
from skiplatch.diagnosis.grid import off_grid
from skiplatch.diagnosis.law import Law
from skiplatch.motion import Contact, expected_contact
from skiplatch.units import UM_PER_MM

CodeArray = NDArray[np.intp]

LOBES = 3.0
UM_US_PER_MM_S = 1e-3
FEWEST_POSITIONS = 8
"""Distinct positions that tell a wave: it has amplitude, phase, period and mean."""
DISTINCT_DIGITS = 2
OF_TOUCHES = frozenset(
    {
        *("is_machine", "plc", "sign", "latched_mm", "false", "has_stamps", "shortest_wave_mm"),
        *("alpha", "alpha_before", "cos_beta", "rest_s", "follows"),
    }
)
"""Cached properties of a scene that no number of nominal.toml changes."""
OF_MOTION = frozenset({"contact", "speed"})
"""Those that depend on the axis alone, beside the touches."""
OF_DATUM = frozenset({"datum_names", "datum_groups", "datum_count"})
"""Those that depend on how the datum is free."""
CLOSE = 0.1
"""Share of the gaps between distinct positions that are smaller than what counts as spacing."""


@dataclass(frozen=True, eq=False)
class Stream:
    """Residuals of one stretch of the chain and their nominal law; arrays of shape (n,).

    A touch in which something for it was not recorded is not in `rows`.
    """

    name: str
    unit: str
    stages: tuple[str, ...]
    residuals: FloatArray
    chain: Law
    """Of the nominal chain alone."""
    rows: BoolArray
    law: Law
    """Of the rig that is believed in: the chain with the effects that it is believed to have."""

    @property
    def is_polled(self) -> bool:
        """It holds touches on the PLC path alone."""
        return self.name.endswith("_plc")

    @cached_property
    def indices(self) -> NDArray[np.intp]:
        """Numbers of the touches in `rows`."""
        return np.flatnonzero(self.rows)

    @cached_property
    def known(self) -> FloatArray:
        """The residuals of `rows` alone."""
        return self.residuals[self.rows]

    @cached_property
    def far(self) -> float:
        """Size that a tenth of the residuals exceeds."""
        return float(np.quantile(np.abs(self.known), 0.9))

    @cached_property
    def _parts(self) -> dict[bytes, "Stream"]:
        return {}

    def part(self, rows: BoolArray) -> "Stream":
        """Give the same for some of the touches; an onset that is searched for asks often."""
        key = rows.tobytes()
        if key not in self._parts:
            self._parts[key] = replace(self, rows=self.rows & rows)
        return self._parts[key]

    def off(self, law: Law) -> float:
        """Root mean square distance of the residuals from a law's mean, without the worst."""
        off = np.abs(self.residuals - law.mean)[self.rows]
        return float(np.sqrt(np.mean(off[off <= np.quantile(off, 0.95)] ** 2)))


class BelievedPhysics(Protocol):
    """Effects that a rig is believed to have, where touches are made."""

    def change(self, scene: "Scene") -> Change:
        """Give what they make of the physics of the chain."""

    def law(self, scene: "Scene", stream: Stream) -> Law:
        """Give the law of a stream's residuals, all n of them."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The touches of a campaign in order of time, and what the nominal chain says of each."""

    nominal: Nominal
    touches: Touches
    whole: "Scene | None" = None
    """The scene that this one is a part of, for what depends on the touches before."""
    chosen: NDArray[np.intp] | None = None
    """Which touches of the whole these are; shape (n,)."""
    moved_at: int | None = None
    """Number of a touch from which on the datum may be another one."""
    physics: BelievedPhysics | None = None
    """Of the effects in the nominal chain, if there are any."""
    stood_in: frozenset[str] = frozenset()
    """Columns with values that nobody recorded."""
    is_directed: bool = True
    """It was recorded in which direction of the probe touches were made, where that matters."""

    @classmethod
    def of(cls, campaign: Campaign, physics: BelievedPhysics | None = None) -> "Scene":
        """Take a campaign's touches in order of time."""
        return cls(campaign.nominal, campaign.touches.in_order_of_time(), physics=physics)

    def select(self, rows: BoolArray | NDArray[np.intp]) -> "Scene":
        """Give some of the touches."""
        chosen = np.arange(len(self))[rows]
        return replace(self, touches=self.touches.select(rows), whole=self, chosen=chosen)

    def in_sequence(self, most: int) -> tuple["Scene", NDArray[np.intp]]:
        """Give the largest scene, of at most so many touches, that this one is a part of.

        And which of its touches these are; shape (n,).
        """
        if self.whole is None or self.chosen is None or len(self.whole) > most:
            return self, np.arange(len(self))
        sequence, rows = self.whole.in_sequence(most)
        return sequence, rows[self.chosen]

    def with_nominal(self, nominal: Nominal) -> "Scene":
        """Give the same touches under another belief."""
        whole = None if self.whole is None else self.whole.with_nominal(nominal)
        moved = replace(self, nominal=nominal, whole=whole)
        kept = set(OF_TOUCHES)
        if nominal.axis == self.nominal.axis:
            kept |= OF_MOTION
        if nominal.datum == self.nominal.datum:
            kept |= OF_DATUM
        # What was derived from what stays the same; beliefs are tried out by the hundred.
        moved.__dict__.update({n: v for n, v in self.__dict__.items() if n in kept})
        return moved

    def with_datum_moved(self, touch: int) -> "Scene":
        """Give the same touches, the datum of which may be another one from a touch on."""
        return replace(self, moved_at=touch)

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
    def warmth(self) -> FloatArray:
        """Degrees above the calibration; shape (n,)."""
        calibrated_at_c = self.nominal.probe.calibrated_at_c
        return np.nan_to_num(self.touches.temp_c, nan=calibrated_at_c) - calibrated_at_c

    @cached_property
    def lobes_um(self) -> FloatArray:
        """What the calibrated lobes add to the pretravel of each touch; shape (n,)."""
        probe = self.nominal.probe
        azimuth = LOBES * (self.alpha - np.deg2rad(probe.lobe_phase_deg))
        return np.asarray(probe.lobe_um * self.cos_beta * np.cos(azimuth))

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
        axis = self.touches.axis
        return np.select([axis == Axis.Y, axis == Axis.Z], [y, z], 0.0)

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
        return 2.0 * spacing(self.touches.position_mm)

    @cached_property
    def datum_groups(self) -> CodeArray | None:
        """Number of the datum that each touch has, shape (n,); None where it is known."""
        names = self.datum_names
        return None if names is None else np.searchsorted(np.unique(names), names)

    @cached_property
    def datum_names(self) -> NDArray[np.str_] | None:
        """Names of the data of the touches, shape (n,); None where they are known."""
        names = datum_names(self.nominal, self.touches)
        if names is None or self.moved_at is None:
            return names
        return np.char.add(names, np.where(self.touches.touch < self.moved_at, "", " moved"))

    @cached_property
    def datum_count(self) -> int:
        """How many data there are, at least one."""
        return 1 if self.datum_groups is None else int(self.datum_groups.max(initial=0)) + 1

    @property
    def datum_u_um(self) -> float | None:
        """Standard uncertainty of each about 0; None for a datum that may be anywhere."""
        return self.nominal.datum.u_um

    def datum_of(self, stream: Stream) -> CodeArray:
        """Number of the datum of each touch in a stream's rows; 0 where it is known."""
        if self.datum_groups is None:
            return np.zeros(len(stream.indices), dtype=np.intp)
        return self.datum_groups[stream.indices]

    def per_datum_um(self, stream: Stream) -> FloatArray:
        """By how much a µm of datum shifts the residuals of a stream; shape (n,)."""
        if stream.name not in SHIFTED:
            return np.zeros(len(self))
        return 1.0 / self.speed if stream.unit == "µs" else np.ones(len(self))

    @cached_property
    def has_stamps(self) -> BoolArray:
        """The latch was stamped; shape (n,)."""
        return ~np.isnan(self.touches.latch_us)

    @cached_property
    def begin_us(self) -> FloatArray:
        """What the latch is counted from: the recorded edge, or the expected contact."""
        edge = self.touches.edge_us
        return (
            self.contact.time_us
            if self.is_machine
            else np.where(np.isnan(edge), self.contact.time_us, edge)
        )

    @cached_property
    def streams(self) -> dict[str, Stream]:
        """All streams in which something was recorded, by name."""
        streams = (
            self._motion(),
            self._latch("skip", ~self.plc),
            self._latch("plc", self.plc),
            self._lattice(),
            self._position(),
            self._deviation("skip", ~self.plc),
            self._deviation("plc", self.plc),
            self._report(),
        )
        recorded = (stream for stream in streams if stream.rows.any())
        return {stream.name: self._as_believed(stream) for stream in recorded}

    @cached_property
    def believed(self) -> Change:
        """What the effects that are believed in make of the physics of the chain."""
        return Change() if self.physics is None else self.physics.change(self)

    def with_beliefs(self, change: Change) -> Change:
        """Give a change of the believed rig as one of the chain."""
        return change if self._is_plain else self.believed.joined(change)

    @property
    def _is_plain(self) -> bool:
        return self.physics is None or not self.nominal.believed_effects

    def _as_believed(self, stream: Stream) -> Stream:
        if self.physics is None or self._is_plain:
            return stream
        return replace(stream, law=self.physics.law(self, stream))

    def _full(self, value: float | FloatArray) -> FloatArray:
        return np.broadcast_to(np.asarray(value, dtype=float), (len(self),)).copy()

    def _stream(
        self,
        name: str,
        unit: str,
        stages: tuple[str, ...],
        residuals: FloatArray,
        law: tuple[float | FloatArray, ...],
        rows: BoolArray,
    ) -> Stream:
        known = rows & ~np.isnan(residuals) & ~self.false
        offset, sigma, box_a, box_b = map(self._full, law)
        full_law = Law(offset, sigma, box_a, box_b)
        return Stream(name, unit, stages, np.nan_to_num(residuals), full_law, known, full_law)

    def _motion(self) -> Stream:
        residuals = self.touches.edge_us - self.contact.time_us
        law = (0.0, self.nominal.bench.reference_jitter_us, 0.0, 0.0)
        here = np.full(len(self), not self.is_machine)
        return self._stream("motion", "µs", ("motion",), residuals, law, here)

    def _latch(self, path: str, rows: BoolArray) -> Stream:
        """Latch stamp after begin, less what the nominal chain needs at least."""
        expected = self.pretravel_um / self.speed + self.wait_us
        residuals = self.touches.latch_us - self.begin_us - expected
        tick = self.nominal.skip.tick_us
        law = (-tick, self.mechanics_us, self.scatter_us, tick)
        stages = ("motion", "probe", "link", "input", "latch" if path == "skip" else "scan")
        return self._stream(f"latch_{path}", "µs", stages, residuals, law, rows)

    def _lattice(self) -> Stream:
        """PLC stamps off the grid of scans, whose phase is taken from the stamps themselves."""
        period, tick = self.nominal.plc.scan_us, self.nominal.skip.tick_us
        stamps = self.touches.latch_us
        rows = self.plc & self.has_stamps
        residuals = off_grid(np.where(rows, stamps, np.nan), period)
        return self._stream(
            "lattice", "µs", ("scan",), residuals, (-tick / 2.0, tick / 4.0, tick, 0.0), rows
        )

    def _position(self) -> Stream:
        """Latched position less the way since the begin, by the latch's own stamp."""
        way = self.speed * (self.touches.latch_us - self.begin_us)
        residuals = self.touches.deviation_um - way
        resolution, tick = self.nominal.axis.resolution_um, self.nominal.skip.tick_us
        sigma = 0.0 if self.is_machine else self.speed * self.nominal.bench.reference_jitter_us
        law = (-resolution / 2.0, sigma, self.speed * tick, resolution)
        everywhere = np.full(len(self), fill_value=True)
        return self._stream("position", "µm", ("position",), residuals, law, everywhere)

    def _deviation(self, path: str, rows: BoolArray) -> Stream:
        """Where nothing but the position was recorded: the whole chain in one number."""
        expected = self.pretravel_um + self.speed * self.wait_us
        residuals = self.touches.deviation_um - expected
        resolution = self.nominal.axis.resolution_um
        law = (
            -resolution / 2.0,
            self.speed * self.mechanics_us,
            self.speed * self.scatter_us,
            resolution,
        )
        stages = (
            "motion",
            "probe",
            "link",
            "input",
            "latch" if path == "skip" else "scan",
            "position",
        )
        return self._stream(
            f"deviation_{path}", "µm", stages, residuals, law, rows & ~self.has_stamps
        )

    def _report(self) -> Stream:
        residuals = self.touches.report_us - self.touches.latch_us - self.nominal.report.latency_us
        law = (0.0, 0.0, self.nominal.report.jitter_us, self.nominal.skip.tick_us)
        everywhere = np.full(len(self), fill_value=True)
        return self._stream("report", "µs", ("report",), residuals, law, everywhere)


def spacing(values: FloatArray) -> float:
    """Give how far apart distinct values lie, where they are close; infinite for too few.

    No wave of less than twice that can be told from a longer one.
    """
    distinct = np.unique(np.round(values[~np.isnan(values)], DISTINCT_DIGITS))
    if len(distinct) < FEWEST_POSITIONS:
        return np.inf
    return float(np.quantile(np.diff(distinct), CLOSE))


def rounding_step(scene: Scene, stream: Stream) -> float:
    """What the residuals of a stream are rounded to, in its unit."""
    if stream.unit == "µs":
        return scene.nominal.skip.tick_us
    return scene.nominal.axis.resolution_um


def datum_names(nominal: Nominal, touches: Touches) -> NDArray[np.str_] | None:
    """Name the datum of each touch, the same in every part of a campaign; shape (n,).

    None where it is known.
    """
    if nominal.datum.free is DatumFreedom.NONE:
        return None
    axes = np.array([*(axis.name for axis in Axis), "axis"])[touches.axis]
    parts = {
        DatumFreedom.CAMPAIGN: [np.full(len(touches), "campaign")],
        DatumFreedom.AXIS: [axes],
        DatumFreedom.AXIS_SENSE: [axes, np.where(touches.sign < 0.0, "-", "+")],
        DatumFreedom.SESSION: [axes],
    }[nominal.datum.free]
    # What was homed or clamped anew has a datum of its own.
    if len(touches.session_names) > 1:
        sessions = np.array([f" session {name}" for name in touches.session_names])
        parts.append(sessions[touches.session])
    return reduce(np.char.add, parts)
