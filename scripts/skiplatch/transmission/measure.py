"""From a file of pulses to the transmission error: the firmware counts, Python evaluates."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.errors import InputError
from skiplatch.tables import compact
from skiplatch.transmission.counted import Counted
from skiplatch.transmission.firmware import (
    BACKWARD,
    INPUT,
    OUTPUT,
    Counters,
    Method,
    Points,
    Transmission,
    TransmissionError,
)
from skiplatch.transmission.flanks import Flanks, survey
from skiplatch.transmission.limits import ARCSEC_PER_TURN, Limits, Pace, Periods, Run, limits_of
from skiplatch.transmission.pulses import Pulses, read_pulses, tells_edges
from skiplatch.transmission.train import GearTrain
from skiplatch.transmission.values import Backlash, Evaluation, Values
from skiplatch.transmission.waves import IntArray

PENDING = 64
"""More gating pulses than wait for a point at the end of a block."""
LEAST_LINES = 4
"""Of the denser train in a period, as in firmware/comp."""
NAMES = {INPUT: "input", OUTPUT: "output"}


class NotMeasurableError(InputError):
    """The pulses are in order, but this method can do nothing with them."""


@dataclass(frozen=True, slots=True)
class Chain:
    """The encoders, and what is between them."""

    lines1: int
    lines2: int
    ratio: Fraction
    """Turns of the input in a turn of the output."""
    meter_s: float
    """Time constant of the meter of analog phase comparison."""

    @property
    def line_arcsec(self) -> float:
        """A line of the denser train at the output: what counting alone resolves."""
        return ARCSEC_PER_TURN / max(float(self.lines1 * self.ratio), float(self.lines2))

    @property
    def period_lines(self) -> int:
        """Lines of the denser train in a period of the highest common frequency; at least four."""
        divided = self.lines1 * self.ratio / self.lines2
        lines = max(divided.numerator, divided.denominator)
        return lines * -(-LEAST_LINES // lines)

    def pitch_turns(self, train: GearTrain | None) -> float:
        """One tooth pitch in output turns; of a train that is not described, an input turn."""
        teeth = train.mesh_order if train is not None else None
        return 1.0 / (teeth or max(float(self.ratio), 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """What one method says of two trains."""

    values: Values
    backlash: Backlash | None
    """Of a run in both senses."""
    counters: dict[int, Counters]
    """By channel."""
    limits: Limits
    """What the method can tell of this run."""
    mark_widths: dict[int, float | None]
    """Of a line, as a share of its pitch, by channel; None where the file does not tell."""


def measure_all(
    path: Path, chain: Chain, train: GearTrain | None
) -> dict[str, Measurement | NotMeasurableError]:
    """Measure by each method; what one of them cannot do stands in its place.

    Raises:
        InputError: The file is wrong.
    """
    results: dict[str, Measurement | NotMeasurableError] = {}
    for method in Method:
        try:
            results[method.value] = measure(path, chain, method, train)
        except NotMeasurableError as error:
            results[method.value] = error
    return results


def measure(path: Path, chain: Chain, method: Method, train: GearTrain | None) -> Measurement:
    """Read a file of pulses and evaluate it, a block at a time.

    Raises:
        NotMeasurableError: The trains in it give no transmission error by this method.
        InputError: The file is wrong.
    """
    try:
        firmware = Transmission(
            chain.lines1, chain.lines2, chain.ratio, method, meter_s=chain.meter_s
        )
    except TransmissionError as error:
        raise NotMeasurableError(path, None, None, str(error)) from error
    lines = float(chain.lines2 if firmware.gate_is_output else chain.lines1 * chain.ratio)
    evaluation = Evaluation(lines, chain.pitch_turns(train))
    spans = _Spans(path)
    pace, counted = Pace(), Counted()
    periods = Periods(INPUT if firmware.gate_is_output else OUTPUT, chain.period_lines)
    gate = _Gate(OUTPUT if firmware.gate_is_output else INPUT)
    flanks = survey(read_pulses(path)) if tells_edges(path) else None
    blocks = read_pulses(path) if flanks is None else map(flanks.kept, read_pulses(path))
    evaluation.take(
        gate.placed(pulses, _fed(path, firmware, pulses, pace))
        for pulses in _each(spans.watched(blocks), periods.add, counted.add)
    )
    spans.refuse_apart()
    values = evaluation.values()
    if values is None:
        message = "the trains are too short: no point of the transmission error came of them"
        raise NotMeasurableError(path, None, None, message)
    limits = limits_of(
        Run(
            method,
            chain.line_arcsec,
            float(chain.ratio),
            chain.meter_s,
            pace,
            counted.tick_ns,
            periods.uneven,
            values,
        )
    )
    if limits.fault is not None:
        raise NotMeasurableError(path, None, None, f"{method.value}: {limits.fault}")
    counters = {channel: firmware.counters(channel) for channel in NAMES}
    widths = {c: None if flanks is None else flanks.trains[c].width for c in NAMES}
    backlash, told = _of_one_flank(evaluation.backlash(), flanks, chain)
    apart = counted.told(chain.lines1, chain.lines2, chain.ratio)
    limits = replace(limits, warnings=(*apart, *limits.warnings, *told))
    return Measurement(values, backlash, counters, limits, widths)


def _of_one_flank(
    backlash: Backlash | None, flanks: Flanks | None, chain: Chain
) -> tuple[Backlash | None, list[str]]:
    """Take off a backlash what is that of the flanks; with what there is to be said of it."""
    if backlash is None:
        return None, []
    line1 = ARCSEC_PER_TURN / float(chain.lines1 * chain.ratio)
    line2 = ARCSEC_PER_TURN / chain.lines2
    if flanks is None:
        said = (
            "the file does not tell rising from falling edges: the backlash is right if the same "
            "flank of each mark was stamped in both senses; with rising edges in both it is off "
            f"by up to {compact(line1 + line2)}″"
        )
        return backlash, [said]
    more = flanks.shift(line1, line2)
    if more is None:
        said = (
            "rising edges alone were stamped in both senses: the width of the marks, up to "
            f"{compact(line1 + line2)}″, cannot be told from backlash, and none is given"
        )
        return None, [said]
    return backlash.shifted(more), []


def _each(blocks: Iterator[Pulses], *watches: Callable[[Pulses], None]) -> Iterator[Pulses]:
    for pulses in blocks:
        for watch in watches:
            watch(pulses)
        yield pulses


def _fed(path: Path, firmware: Transmission, pulses: Pulses, pace: Pace) -> Points:
    try:
        points = firmware.feed(pulses.channel, pulses.t_ns)
    except TransmissionError as error:
        raise InputError(path, None, None, f"pulse {error.pulse}: {error}") from error
    pace.add(points)
    return points


class _Gate:
    """The pulses at which points stand: the first of all is line 0, each has a sense."""

    def __init__(self, channel: int) -> None:
        self._channel = channel
        self._seen = 0
        self._zero: int | None = None
        self._t_ns = np.empty(0, dtype=np.int64)
        self._sense = np.empty(0, dtype=np.int64)

    def placed(self, pulses: Pulses, points: Points) -> tuple[IntArray, FloatArray, IntArray]:
        """Give line, error and sense of each point that a block of pulses has brought."""
        gating = (pulses.channel & ~np.uint8(BACKWARD)) == self._channel
        sense = np.where(pulses.channel[gating] & BACKWARD, -1, 1)
        t_ns = np.append(self._t_ns, pulses.t_ns[gating])
        senses = np.append(self._sense, sense)
        at = np.minimum(np.searchsorted(t_ns, points.t_ns), max(len(t_ns) - 1, 0))
        if self._zero is None and len(at):
            before = self._seen - len(self._t_ns) + int(at[0])
            self._zero = int(points.line[0]) - int(senses[at[0]]) * before
        self._seen += int(gating.sum())
        self._t_ns, self._sense = t_ns[-PENDING:], senses[-PENDING:]
        return points.line - (self._zero or 0), points.delta_arcsec, senses[at]


class _Spans:
    """From when to when each train lasts."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._first: dict[int, int] = {}
        self._last: dict[int, int] = {}

    def watched(self, blocks: Iterator[Pulses]) -> Iterator[Pulses]:
        """Pass blocks on."""
        for pulses in blocks:
            self._add(pulses)
            yield pulses

    def _add(self, pulses: Pulses) -> None:
        base = pulses.channel & ~np.uint8(BACKWARD)
        for channel in NAMES:
            seen = np.flatnonzero(base == channel)
            if len(seen):
                self._first.setdefault(channel, int(pulses.t_ns[seen[0]]))
                self._last[channel] = int(pulses.t_ns[seen[-1]])

    def refuse_apart(self) -> None:
        """Raise InputError where a train is missing, or both do not overlap in time."""
        for channel, name in NAMES.items():
            if channel not in self._first:
                message = f"no pulse of the {name} (channel {channel})"
                raise InputError(self._path, None, None, message)
        if max(self._first.values()) >= min(self._last.values()):
            spans = ", ".join(
                f"{name} from {self._first[channel]} to {self._last[channel]} ns"
                for channel, name in NAMES.items()
            )
            raise InputError(self._path, None, None, f"the trains do not overlap: {spans}")
