"""What each method can tell of a run, in numbers, and where a result lies outside of it."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import hypot, pi, sinh

import numpy as np

from skiplatch.tables import compact, number
from skiplatch.transmission.firmware import BACKWARD, Method, Points
from skiplatch.transmission.pulses import Pulses
from skiplatch.transmission.values import Values
from skiplatch.units import NS_PER_S

ARCSEC_PER_TURN = 1_296_000.0
LEAST_GAIN = 0.5
"""Of the meter, for a steady phase: below, it follows the flip-flop instead of its mean."""
GOOD_GAIN = 0.95
WORTH_TELLING = 0.1
"""Share of the total error from which an error of the method is told."""
SAFE_SHARE = 0.5
"""Of the change a point that the phase can have without being taken for another line."""


@dataclass(slots=True)
class Pace:
    """How the points of a run follow one another, taken block by block."""

    points: int = 0
    first_ns: int = 0
    last_ns: int = 0
    greatest_step_arcsec: float = 0.0
    """Between neighbouring points."""
    _tail_arcsec: list[float] = field(default_factory=list)

    def add(self, points: Points) -> None:
        """Take a block."""
        if not len(points.t_ns):
            return
        if not self.points:
            self.first_ns = int(points.t_ns[0])
        self.points += len(points.t_ns)
        self.last_ns = int(points.t_ns[-1])
        delta = np.append(self._tail_arcsec[-1:], points.delta_arcsec)
        if len(delta) > 1:
            step = float(np.max(np.abs(np.diff(delta))))
            self.greatest_step_arcsec = max(self.greatest_step_arcsec, step)
        self._tail_arcsec = delta[-1:].tolist()


class Periods:
    """How the periods of the denser train, divided, differ from one to the next."""

    def __init__(self, channel: int, lines: int) -> None:
        """Begin.

        Args:
            channel: Of the denser train.
            lines: Of it in a period.
        """
        self._channel, self._lines = channel, lines
        self._seen = 0
        self._tail_ns = np.empty(0, dtype=np.int64)
        self._least = self._most = 0.0

    @property
    def uneven(self) -> float:
        """Range of what a period has more than the one before, as a share."""
        return self._most - self._least

    def add(self, pulses: Pulses) -> None:
        """Take a block; the sense does not matter."""
        own = pulses.t_ns[(pulses.channel & ~np.uint8(BACKWARD)) == self._channel]
        ends = own[-self._seen % self._lines :: self._lines]
        self._seen += len(own)
        t_ns = np.append(self._tail_ns, ends)
        periods = np.diff(t_ns)
        if len(periods) > 1:
            more = np.diff(periods) / np.maximum(periods[:-1], 1)
            self._least = min(self._least, float(more.min()))
            self._most = max(self._most, float(more.max()))
        self._tail_ns = t_ns[-2:]


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a method for one run.

    Attributes:
        numbers: By name, with their units.
        warnings: Where the result lies outside, a sentence each.
        fault: Why the method can tell nothing of this run; None where it can.
    """

    numbers: dict[str, float]
    warnings: tuple[str, ...]
    fault: str | None


@dataclass(frozen=True, slots=True)
class Run:
    """What the limits follow from.

    Attributes:
        method: Which of the five.
        line_arcsec: A line of the denser train at the output.
        ratio: Turns of the input in a turn of the output.
        meter_s: Time constant of the analog meter.
        pace: How the points follow one another.
        tick_ns: Of the clock.
        uneven: How much longer or shorter a period of the divided trains is than the one before:
            range, as a share.
        values: What the method says.
    """

    method: Method
    line_arcsec: float
    ratio: float
    meter_s: float
    pace: Pace
    tick_ns: int
    uneven: float
    values: Values

    @property
    def turn_s(self) -> float:
        """Time of an output turn."""
        seconds = (self.pace.last_ns - self.pace.first_ns) / NS_PER_S
        return seconds / self.values.turns

    @property
    def period_s(self) -> float:
        """Time from point to point."""
        return (self.pace.last_ns - self.pace.first_ns) / NS_PER_S / max(self.pace.points - 1, 1)


def limits_of(run: Run) -> Limits:
    """Give the limits of a run, and what lies outside of them."""
    values = run.values
    if values.turns <= 0.0:
        return Limits({}, (), "a single point tells no error")
    per_turn = (values.points - 1) / values.turns
    numbers = {"lowest_order": 1.0 / values.turns, "highest_order": 0.5 * per_turn}
    own, found, fault = _OWN[run.method](run, per_turn)
    return Limits(numbers | own, (*_of_all(run, numbers), *found), fault)


def _of_all(run: Run, numbers: dict[str, float]) -> Iterator[str]:
    lowest, highest = numbers["lowest_order"], numbers["highest_order"]
    if run.values.turns < 1.0:
        yield (
            f"{compact(run.values.turns)} turns of the output: orders below {compact(lowest)} are "
            f"out of reach; a trend of {number(run.values.trend_arcsec)}″ peak to peak is fitted "
            "in their place"
        )
    if highest < run.ratio:
        yield (
            f"{compact(2.0 * highest)} points a turn: orders above {compact(highest)} are out of "
            f"reach and fold into lower ones, among them that of the input, {compact(run.ratio)}"
        )


_Found = tuple[dict[str, float], list[str], str | None]


def _subdivided(run: Run, per_turn: float) -> _Found:
    del per_turn
    quantum = _clock_arcsec(run)
    return {"quantum_arcsec": quantum}, _coarse(run, quantum, "a tick of the clock"), None


def _direct(run: Run, per_turn: float) -> _Found:
    del per_turn
    found = _coarse(run, run.line_arcsec, "a line of the denser train")
    return {"quantum_arcsec": run.line_arcsec}, found, None


def _clock_arcsec(run: Run) -> float:
    return ARCSEC_PER_TURN * run.tick_ns / NS_PER_S / run.turn_s


def _coarse(run: Run, quantum: float, what: str) -> list[str]:
    if quantum <= WORTH_TELLING * run.values.total_arcsec:
        return []
    total = number(run.values.total_arcsec)
    return [f"{what} is {number(quantum)}″ of the {total}″ that are told: smaller errors are lost"]


def _phase_subdivided(run: Run, per_turn: float) -> _Found:
    del per_turn
    most = 0.5 * run.line_arcsec
    step = run.pace.greatest_step_arcsec
    found = []
    if step > SAFE_SHARE * most:
        found.append(
            f"the error changes by up to {number(step)}″ from point to point: from "
            f"{number(most)}″ on it is taken for another line"
        )
    own = {"step_arcsec": most, "quantum_arcsec": _clock_arcsec(run)}
    return own, found, None


def _phase_digital(run: Run, per_turn: float) -> _Found:
    span = ARCSEC_PER_TURN / per_turn
    ripple = 0.5 * span * run.uneven
    own = {"range_arcsec": span, "speed_ripple_arcsec": ripple}
    total = run.values.total_arcsec
    said = (
        f"a period is {number(span)}″, and the speed changes by {number(100.0 * run.uneven, 2)} % "
        f"from one to the next, which counts as up to {number(ripple)}″ of the {number(total)}″"
    )
    if ripple >= SAFE_SHARE * total > 0.0:
        return own, [], f"{said}: hardly more than the speed is seen"
    return own, [said] if ripple > WORTH_TELLING * total else [], None


def _phase_analog(run: Run, per_turn: float) -> _Found:
    span = ARCSEC_PER_TURN / per_turn
    half = 0.5 * run.period_s / run.meter_s
    gain = half / sinh(half) if 0.0 < half < 300.0 else float(half <= 0.0)
    corner = run.turn_s / (2.0 * pi * run.meter_s)
    own = {"range_arcsec": span, "meter_gain": gain, "meter_corner_order": corner}
    period = f"a period of {compact(1e3 * run.period_s)} ms"
    meter = f"the meter's {compact(1e3 * run.meter_s)} ms"
    if gain < LEAST_GAIN:
        return (
            own,
            [],
            (
                f"{period} is too long for {meter}, which follows the flip-flop and not its mean: "
                f"it needs less than {compact(1e3 * _longest(LEAST_GAIN) * run.meter_s)} ms"
            ),
        )
    found = []
    if gain < GOOD_GAIN:
        found.append(f"{period} beside {meter}: errors show {compact(gain)} times as large")
    largest = run.values.orders[0].order if run.values.orders else 1.0
    shown = 1.0 / hypot(1.0, largest / corner)
    if shown < GOOD_GAIN:
        found.append(
            f"{meter} pass orders up to {compact(corner)}: order {compact(largest, 5)} shows "
            f"{compact(shown)} times as large"
        )
    return own, found, None


def _longest(gain: float) -> float:
    """Give the period, in time constants, at which the meter has this gain."""
    low, high = 0.0, 100.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 0.5 * middle / sinh(0.5 * middle) > gain else (low, middle)
    return low


_OWN = {
    Method.SUBDIVIDED: _subdivided,
    Method.DIRECT: _direct,
    Method.PHASE_SUBDIVIDED: _phase_subdivided,
    Method.PHASE_DIGITAL: _phase_digital,
    Method.PHASE_ANALOG: _phase_analog,
}
