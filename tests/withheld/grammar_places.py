"""Where in the chain a stranger may sit: every quantity that a touch has of its own.

Left out are the resolution and the tick (whatever a coarseness goes with, `encoder_quantisation`
and `timer_quantisation` say what is), the scan period (it is a grid of all touches, and none of
one) and losing touches (`lost_trigger` says what is).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from skiplatch.campaign import Nominal
from tests.withheld.chain import BoolArray, FloatArray, Hook, Setup, State, Step
from tests.withheld.conditions import Recording
from tests.withheld.effects import BOTH, PLC, SKIP
from tests.withheld.forms import Amount, adds
from tests.withheld.sizes import spreads

OFF_GRID = 0.01
"""Of a scan period: a shift of scans that counts as one spread, as stamps tell much less."""
MOST_SCANS_OLD = 3.0

Hang = Callable[[Amount], Mapping[Step, Hook]]
Belief = Callable[[Nominal], float]


@dataclass(frozen=True)
class Seen:
    """How an amount at a place is seen in what is recorded.

    Attributes:
        observable: What it moves: a length along the approach, or one of the times.
        factor: That by the amount, shape (n,).
        noise: Its nominal standard deviation, shape (n,).
        rows: Touches in which it is seen, shape (n,).
    """

    observable: str
    factor: FloatArray
    noise: FloatArray
    rows: BoolArray


@dataclass(frozen=True)
class Place:
    """A quantity of the chain.

    Attributes:
        stage: Where it lies.
        hang: Makes hooks of an amount in its unit.
        see: Tells how it is seen.
        recordings: In which it is seen at all.
        paths: Input paths that it concerns.
        belief: How far it may fall short of what is believed; None if either sense is as good.
        most: The largest amount that makes sense.
    """

    stage: str
    hang: Hang
    see: Callable[[Setup, Recording], Seen]
    recordings: frozenset[Recording]
    paths: frozenset[str] = BOTH
    belief: Belief | None = None
    most: Callable[[Nominal], float] = lambda _: np.inf


def _hook(step: Step, name: str) -> Hang:
    return lambda amount: {step: adds(name, amount)}


def _errs_in_coordinate(amount: Amount) -> Mapping[Step, Hook]:
    return {Step.POSITION: adds("deviation_um", lambda s: s.sign * amount(s))}


def _is_off(amount: Amount) -> Mapping[Step, Hook]:
    """Let the real feed be off by a share."""

    def hook(s: State) -> None:
        s.feed_um_us = s.feed_um_us * (1 + amount(s))

    return {Step.RIG: hook}


def _is_weak(amount: Amount) -> Mapping[Step, Hook]:
    """Let the time of acceleration be longer by a share."""

    def hook(s: State) -> None:
        s.accel_um_us2 = s.accel_um_us2 / (1 + amount(s))

    return {Step.RIG: hook}


def _is_late(amount: Amount) -> Mapping[Step, Hook]:
    """Let scans start late, all of those near a touch alike."""

    def hook(s: State) -> None:
        s.start_us = s.start_us + np.broadcast_to(amount(s), (s.n,))[:, None]

    return {Step.SCAN: hook}


def _is_old(amount: Amount) -> Mapping[Step, Hook]:
    """Let the input image be older than the scan."""

    def hook(s: State) -> None:
        s.image_us = s.image_us - np.broadcast_to(amount(s), (s.n,))[:, None]

    return {Step.IMAGE: hook}


def _reads_old(amount: Amount) -> Mapping[Step, Hook]:
    return {Step.READ: adds("read_us", lambda s: -np.asarray(amount(s)))}


def _length(factor: Callable[[Setup], FloatArray]) -> Callable[[Setup, Recording], Seen]:
    """See an amount as a length: on the PLC too if stamps tell how long it waited."""

    def see(setup: Setup, recording: Recording) -> Seen:
        noise = spreads(setup)["deviation_um"]
        nominal = setup.nominal
        known = np.hypot(nominal.axis.resolution_um / np.sqrt(12), nominal.probe.repeatability_um)
        on_plc = noise if recording is Recording.POSITION else np.full(len(noise), known)
        noise = np.where(setup.touches.on_plc, on_plc, noise)
        return Seen("length", factor(setup), noise, np.ones(len(noise), bool))

    return see


def _before_latch(factor: Callable[[Setup], FloatArray]) -> Callable[[Setup, Recording], Seen]:
    """See an amount as a length on the skip path alone: the PLC's wait swallows it."""

    def see(setup: Setup, _: Recording) -> Seen:
        noise = spreads(setup)["deviation_um"]
        return Seen("length", factor(setup), noise, setup.touches.on_skip)

    return see


def _time(observable: str, column: str) -> Callable[[Setup, Recording], Seen]:
    def see(setup: Setup, _: Recording) -> Seen:
        n = len(setup.touches)
        return Seen(observable, np.ones(n), spreads(setup)[column], setup.touches.on_skip)

    return see


def _report(setup: Setup, _: Recording) -> Seen:
    n = len(setup.touches)
    return Seen("report", np.ones(n), spreads(setup)["report_us"], np.ones(n, bool))


def _scans(noise: float) -> Callable[[Setup, Recording], Seen]:
    def see(setup: Setup, _: Recording) -> Seen:
        n = len(setup.touches)
        unit = np.full(n, noise * setup.nominal.plc.scan_us)
        return Seen("scan", np.ones(n), unit, setup.touches.on_plc)

    return see


def _feed(setup: Setup, recording: Recording) -> Seen:
    """See the feed by when the surface is met, or without stamps by the way made in the delays."""
    nominal, speed = setup.nominal, setup.feed_um_us
    if recording is Recording.POSITION:
        late_us = nominal.probe.delay_us + nominal.input.filter_us + nominal.skip.latency_us
        return _before_latch(lambda _: speed * late_us)(setup, recording)
    early = -setup.touches.approach_mm * 1e3 / speed
    return Seen("start", early, spreads(setup)["latch_us"], setup.touches.on_skip)


def _acceleration(setup: Setup, _: Recording) -> Seen:
    late = setup.feed_um_us / (2e-9 * setup.nominal.axis.accel_mm_s2)
    return Seen("start", late, spreads(setup)["latch_us"], setup.touches.on_skip)


def _one(setup: Setup) -> FloatArray:
    return np.ones(len(setup.touches))


def _sense(setup: Setup) -> FloatArray:
    return setup.touches.sign.astype(float)


def _speed(setup: Setup) -> FloatArray:
    return setup.feed_um_us


def _scan_us(nominal: Nominal) -> float:
    return MOST_SCANS_OLD * nominal.plc.scan_us


ANYWHERE = frozenset(Recording)
STAMPED = frozenset({Recording.STAMPED})
MACHINE = frozenset({Recording.STAMPED, Recording.POSITION})
WITH_STAMPS = frozenset({Recording.BENCH, Recording.STAMPED})
SLOWER = 3.0
OFF_FEED = 0.4

PLACES: Mapping[str, Place] = {
    "feed": Place("motion", _is_off, _feed, MACHINE, most=lambda _: OFF_FEED),
    "acceleration": Place(
        "motion", _is_weak, _acceleration, STAMPED, belief=lambda _: 0.0, most=lambda _: SLOWER
    ),
    "start": Place("motion", _hook(Step.MOVE, "contact_us"), _time("start", "latch_us"), STAMPED),
    "pretravel": Place(
        "probe",
        _hook(Step.PROBE, "pretravel_um"),
        _before_latch(_one),
        MACHINE,
        belief=lambda nominal: 0.5 * nominal.probe.pretravel_um,
    ),
    "delay": Place(
        "probe",
        _hook(Step.PROBE, "delay_us"),
        _before_latch(_speed),
        MACHINE,
        belief=lambda nominal: nominal.probe.delay_us,
    ),
    "link": Place(
        "link",
        _hook(Step.EDGE, "edge_us"),
        _before_latch(_speed),
        MACHINE,
        belief=lambda nominal: nominal.probe.delay_us,
    ),
    "input": Place(
        "input",
        _hook(Step.PIN, "pin_us"),
        _before_latch(_speed),
        ANYWHERE,
        belief=lambda nominal: nominal.input.filter_us,
    ),
    "skip": Place(
        "latch",
        _hook(Step.SKIP, "skip_us"),
        _before_latch(_speed),
        ANYWHERE,
        paths=SKIP,
        belief=lambda nominal: nominal.skip.latency_us,
    ),
    "clock": Place("latch", _hook(Step.STAMP, "stamp_us"), _time("stamp", "latch_us"), WITH_STAMPS),
    "scan": Place("scan", _is_late, _scans(OFF_GRID), WITH_STAMPS, paths=PLC, belief=lambda _: 0.0),
    "image": Place(
        "scan",
        _is_old,
        _scans(1 / np.sqrt(12)),
        WITH_STAMPS,
        paths=PLC,
        belief=lambda _: 0.0,
        most=_scan_us,
    ),
    "latch": Place(
        "latch", _hook(Step.LATCH, "latch_us"), _length(_speed), WITH_STAMPS, belief=lambda _: 0.0
    ),
    "reading": Place(
        "position", _reads_old, _length(lambda s: -_speed(s)), ANYWHERE, belief=lambda _: 0.0
    ),
    "position": Place("position", _hook(Step.POSITION, "deviation_um"), _length(_one), ANYWHERE),
    "coordinate": Place("position", _errs_in_coordinate, _length(_sense), ANYWHERE),
    "report": Place(
        "report",
        _hook(Step.REPORT, "report_us"),
        _report,
        WITH_STAMPS,
        belief=lambda nominal: nominal.report.latency_us,
    ),
}

LATE = frozenset({"delay", "link", "input", "skip", "latch", "reading"})
"""Places where a constant amount is a delay."""
SHARES: Mapping[str, float] = {"position": 3.0, "coordinate": 2.0, "pretravel": 2.0, "skip": 1.5}
"""Of places among strangers; 1 for the others."""


def draw_place(rng: np.random.Generator, recording: Recording) -> str:
    """Draw a place that is seen in a kind of recording, by its name."""
    names = [name for name, place in PLACES.items() if recording in place.recordings]
    shares = np.array([SHARES.get(name, 1.0) for name in names])
    return names[int(rng.choice(len(names), p=shares / shares.sum()))]
