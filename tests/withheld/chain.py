"""The nominal chain, written a second time: plain numpy, all touches at once, room for other forms.

This is not the simulator under test and shares nothing with it but the format of campaigns. The
chain is a row of steps; a form of an effect hangs hooks behind some of them. Times are on the
master clock in µs, lengths in µm, speeds in µm/µs.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign import Kind, Nominal, Status, Touches

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Numbers = NDArray[np.floating[Any]] | float

UM_US_PER_MM_MIN = 1.0 / 60_000.0
BEFORE = 6  # scans looked at before the one that is due after the edge
SCANS = np.arange(-BEFORE, 26)


class Step(Enum):
    """The steps of the chain; a hook runs behind its step."""

    RIG = auto()
    MOVE = auto()
    PROBE = auto()
    EDGE = auto()
    PIN = auto()
    SKIP = auto()
    SCAN = auto()
    IMAGE = auto()
    LATCH = auto()
    READ = auto()
    POSITION = auto()
    ROUND = auto()
    STAMP = auto()
    REPORT = auto()


@dataclass(frozen=True, eq=False)
class Setup:
    """A rig and its touches, in the order of time, before anything was played.

    Attributes:
        nominal: What the engineer believes.
        touches: The conditions of all touches, complete, without outcomes.
        scan_phase_us: When scan 0 starts.
    """

    nominal: Nominal
    touches: Touches
    scan_phase_us: float

    @property
    def feed_um_us(self) -> FloatArray:
        """Programmed speeds, shape (n,)."""
        return self.touches.feed_mm_min * UM_US_PER_MM_MIN

    @property
    def on_bench(self) -> bool:
        """Whether edges are injected, so that there is no probe."""
        return self.nominal.kind is Kind.BENCH

    def retimed(self, delay_s: FloatArray) -> "Setup":
        """Start every move later, shape (n,), on whole microseconds."""
        time_s = np.round(self.touches.time_s + delay_s, 6)
        return replace(self, touches=replace(self.touches, time_s=time_s))


class State:
    """One play under way: every array has the shape (n,), those of the scans (n, scans)."""

    def __init__(self, setup: Setup, rng: np.random.Generator) -> None:
        n = len(setup.touches)
        self.setup = setup
        self.touches = setup.touches
        self.rng = rng
        self.n = n
        self.sign = setup.touches.sign
        # What is true of the rig; the first step takes it from what is believed.
        self.feed_um_us = setup.feed_um_us
        self.accel_um_us2 = np.full(n, setup.nominal.axis.accel_mm_s2 * 1e-9)
        self.filter_us: Numbers = setup.nominal.input.filter_us
        self.scan_us: Numbers = setup.nominal.plc.scan_us
        self.resolution_um: Numbers = setup.nominal.axis.resolution_um
        self.tick_us = np.full(n, setup.nominal.skip.tick_us)
        # What becomes of each touch.
        zero = np.zeros(n)
        self.speed_um_us = zero
        self.contact_us = zero
        self.pretravel_um = zero
        self.delay_us = zero
        self.edge_us = zero
        self.pin_us = zero
        self.skip_us = zero
        self.scan_number = np.zeros((n, len(SCANS)))
        self.start_us = np.zeros((n, len(SCANS)))
        self.image_us = np.zeros((n, len(SCANS)))
        self.latch_us = zero
        self.read_us = zero
        self.deviation_um = zero
        self.stamp_us = zero
        self.report_us = zero
        self.missed: BoolArray = np.zeros(n, bool)
        self.false: BoolArray = np.zeros(n, bool)


Hook = Callable[[State], None]


@dataclass(frozen=True, eq=False)
class Outcomes:
    """What was recorded: arrays of shape (n,), NaN where a touch was missed."""

    edge_us: FloatArray
    latch_us: FloatArray
    report_us: FloatArray
    deviation_um: FloatArray
    status: NDArray[np.int8]


def play(
    setup: Setup, hooks: Sequence[Mapping[Step, Hook]], rng: np.random.Generator
) -> tuple[Outcomes, State]:
    """Play all touches once, with the hooks of some effects behind the steps."""
    state = State(setup, rng)
    for step in Step:
        if step in STEPS:
            STEPS[step](state)
        for hung in hooks:
            if step in hung:
                hung[step](state)
    return _recorded(state), state


def travel_us(approach_um: FloatArray, feed_um_us: FloatArray, accel: FloatArray) -> FloatArray:
    """Time from rest to the surface under constant acceleration in µm/µs²."""
    ramp = feed_um_us**2 / (2 * accel)
    cruising = feed_um_us / accel + (approach_um - ramp) / feed_um_us
    return np.where(approach_um < ramp, np.sqrt(2 * approach_um / accel), cruising)


def meet(s: State, approach_um: FloatArray) -> None:
    """Meet a surface so far from where each move starts, shape (n,)."""
    s.contact_us = s.touches.time_s * 1e6 + travel_us(approach_um, s.feed_um_us, s.accel_um_us2)
    s.speed_um_us = np.minimum(s.feed_um_us, np.sqrt(2 * s.accel_um_us2 * approach_um))


def _move(s: State) -> None:
    meet(s, s.touches.approach_mm * 1e3)


def lobes_um(touches: Touches, amplitude_um: float, phase_deg: float) -> FloatArray:
    """The three lobes of the pretravel, shape (n,)."""
    azimuth = np.radians(touches.alpha_deg - phase_deg)
    lobes: FloatArray = amplitude_um * np.cos(np.radians(touches.beta_deg)) * np.cos(3 * azimuth)
    return lobes


def _probe(s: State) -> None:
    probe = s.setup.nominal.probe
    scatter = s.rng.normal(0.0, 1.0, s.n) * probe.repeatability_um
    lobes = lobes_um(s.touches, probe.lobe_um, probe.lobe_phase_deg)
    s.pretravel_um = probe.pretravel_um + lobes + scatter
    s.delay_us = np.full(s.n, probe.delay_us)


def _edge(s: State) -> None:
    least = 0.0 if s.setup.nominal.version == 1 else -np.inf
    s.edge_us = s.contact_us + np.maximum(s.pretravel_um, least) / s.speed_um_us + s.delay_us


def _pin(s: State) -> None:
    s.pin_us = s.edge_us + s.filter_us


def _skip(s: State) -> None:
    skip = s.setup.nominal.skip
    s.skip_us = s.pin_us + skip.latency_us + s.rng.uniform(0.0, 1.0, s.n) * skip.jitter_us


def _scan(s: State) -> None:
    due = np.ceil((s.pin_us - s.setup.scan_phase_us) / s.scan_us)
    s.scan_number = due[:, None] + SCANS
    s.start_us = s.setup.scan_phase_us + s.scan_number * np.reshape(s.scan_us, (-1, 1))


def _image(s: State) -> None:
    s.start_us = np.maximum.accumulate(s.start_us, axis=1)
    s.image_us = s.start_us


def _latch(s: State) -> None:
    first = np.argmax(s.image_us >= s.pin_us[:, None], axis=1)
    s.latch_us = np.where(s.touches.on_plc, s.start_us[np.arange(s.n), first], s.skip_us)


def _read(s: State) -> None:
    s.read_us = s.latch_us


def _position(s: State) -> None:
    s.deviation_um = s.speed_um_us * (s.read_us - s.contact_us)


def _round(s: State) -> None:
    s.deviation_um = np.round(s.deviation_um / s.resolution_um) * s.resolution_um


def _stamp(s: State) -> None:
    s.stamp_us = s.latch_us


def _report(s: State) -> None:
    report = s.setup.nominal.report
    s.report_us = s.latch_us + report.latency_us + s.rng.uniform(0.0, 1.0, s.n) * report.jitter_us


STEPS: Mapping[Step, Hook] = {
    Step.MOVE: _move,
    Step.PROBE: _probe,
    Step.EDGE: _edge,
    Step.PIN: _pin,
    Step.SKIP: _skip,
    Step.SCAN: _scan,
    Step.IMAGE: _image,
    Step.LATCH: _latch,
    Step.READ: _read,
    Step.POSITION: _position,
    Step.ROUND: _round,
    Step.STAMP: _stamp,
    Step.REPORT: _report,
}


def _recorded(s: State) -> Outcomes:
    """Round to the columns' decimals and empty what was missed."""

    def column(values: FloatArray) -> FloatArray:
        return np.where(s.missed, np.nan, np.round(values, 3) + 0.0)

    edge = np.full(s.n, np.nan)
    if s.setup.on_bench:
        noise = s.rng.normal(0.0, 1.0, s.n) * s.setup.nominal.bench.reference_jitter_us
        edge = np.round(s.edge_us + noise, 3)
    status = np.where(s.missed, Status.MISSED, np.where(s.false, Status.FALSE, Status.OK))
    return Outcomes(
        edge_us=edge,
        latch_us=column(np.floor(s.stamp_us / s.tick_us) * s.tick_us),
        report_us=column(s.report_us),
        deviation_um=column(s.deviation_um),
        status=status.astype(np.int8),
    )
