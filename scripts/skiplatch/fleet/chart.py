"""A control chart that needs no figures of the rig beforehand: has its mean changed, and when?

The changepoint model of Hawkins, Qiu and Kang (Journal of Quality Technology 35 (2003) 355): with
each new value, the newest m are held against all before them by Student's t test, for several m.
Mean and scatter are those of the rig itself. A value counts as an alarm from a probability on that
is handed in, shared by all m (Bonferroni), so that is what at most a false alarm has.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

Floats = npt.NDArray[np.float64]

FEWEST_BEFORE = 4
"""Values that tell a scatter at all; with them t has at least four degrees of freedom."""
FEWEST_AGAIN = 2
"""Values of a level that was found, before it is left: the levels before it tell the scatter."""
NEWEST = (2, 3, 5, 8, 13, 21)
"""Sizes m of the newest values: a step shows in few, a drift in many. One alone is an outlier."""

FEWEST = FEWEST_BEFORE + min(NEWEST)
"""Values in which a change can be found."""


@dataclass(frozen=True, slots=True)
class Shift:
    """A change of the mean, and its return if the new level was short.

    Attributes:
        start: Where the values before it begin.
        began: The first value after it.
        seen: The value at which it was found.
        end: One past the last value at the new level.
        until: One past the last value before the next change. From `end` on the values lie back
            on the side of the old level.
        back_seen: The value at which that was found; None where they are too few to tell, or none.
    """

    start: int
    began: int
    seen: int
    end: int
    until: int
    back_seen: int | None = None


@dataclass(frozen=True, slots=True)
class _Chart:
    """Where a chart begins, and what is known before: also what others of its levels scattered.

    Attributes:
        start: Its first value.
        first: The first value that has told nothing yet.
        squares: Sum of squares about the means of all levels before.
        freedom: Degrees of freedom of that.
    """

    start: int = 0
    first: int = 0
    squares: float = 0.0
    freedom: int = 0

    @property
    def fewest(self) -> int:
        """Values before a change."""
        return FEWEST_AGAIN if self.freedom else FEWEST_BEFORE

    def next(self, values: Floats, began: int, seen: int) -> "_Chart":
        """Begin anew after a change."""
        level = values[self.start : began]
        squares = float(np.sum((level - level.mean()) ** 2))
        return _Chart(began, seen + 1, self.squares + squares, self.freedom + len(level) - 1)


def shifts(values: Floats, levels: Floats) -> list[Shift]:
    """Find each change of the mean; after one the chart begins anew.

    Chance that raises an alarm is gone with the next values, which is no second alarm. So where a
    level ends that was too short to tell its own scatter, that is a part of the change to it.

    Args:
        values: In the order of time, shape (n,).
        levels: Probability of a false alarm that each value may have, shape (n,).
    """
    found: list[Shift] = []
    for start, began, seen in _alarms(values, levels):
        if found and _is_return(values, found[-1], start, began):
            found[-1] = replace(found[-1], end=began, back_seen=seen)
            continue
        if found:
            found[-1] = _ended(found[-1], began)
        found.append(Shift(start, began, seen, end=len(values), until=len(values)))
    return [*found[:-1], *(_left(values, last) for last in found[-1:])]


def _is_return(values: Floats, last: Shift, start: int, began: int) -> bool:
    if start != last.began or began - start >= FEWEST_BEFORE:
        return False
    old, short, new = (
        values[part].mean()
        for part in (slice(last.start, start), slice(start, began), slice(began, began + 2))
    )
    return bool((old - short) * (new - short) > 0.0)


def _ended(shift: Shift, following: int) -> Shift:
    return replace(shift, end=min(shift.end, following), until=following)


def _left(values: Floats, last: Shift) -> Shift:
    """Leave out of the last level the newest values that lie nearer to the one before."""
    if last.back_seen is not None:
        return last
    before = values[last.start : last.began].mean()
    after = values[last.began : last.seen + 1].mean()
    is_new = (values[last.seen + 1 :] - (before + after) / 2.0) * (after - before) > 0.0
    return replace(last, end=last.seen + 2 + int(np.max(np.nonzero(is_new)[0], initial=-1)))


def _alarms(values: Floats, levels: Floats) -> Iterator[tuple[int, int, int]]:
    """Give the start of the chart, where its values have changed, and where that was seen."""
    chart = _Chart()
    while (seen := _first_alarm(values, levels, chart)) is not None:
        began = _split(values, chart, seen)
        yield chart.start, began, seen
        chart = chart.next(values, began, seen)


def _first_alarm(values: Floats, levels: Floats, chart: _Chart) -> int | None:
    """Give the first value at which a test falls below its share of the level."""
    is_alarm = np.zeros(len(values), dtype=bool)
    for size in NEWEST:
        earliest = max(chart.start + chart.fewest + size - 1, chart.first)
        last = np.arange(earliest, len(values))
        if len(last):
            steps = _steps(values, last + 1 - size, last + 1, chart)
            is_clear = steps.probability * len(NEWEST) < levels[last]
            is_alarm[last] |= is_clear & _both_moved(values, last, steps)
    return int(np.argmax(is_alarm)) if is_alarm.any() else None


@dataclass(frozen=True, slots=True)
class _Steps:
    """Two-sample t tests of a chart's values up to a split against those up to an end."""

    before: Floats
    after: Floats
    probability: Floats


def _steps(
    values: Floats, splits: npt.NDArray[np.int64], ends: npt.NDArray[np.int64], chart: _Chart
) -> _Steps:
    """Test the values of a chart; few before tell no scatter, so the levels before help them."""
    own = values[chart.start :]
    split, end = splits - chart.start, ends - chart.start
    centred = own - own.mean()  # so that sums of squares keep their digits
    sums = np.concatenate(([0.0], np.cumsum(centred)))
    squares = np.concatenate(([0.0], np.cumsum(centred**2)))
    before = sums[split] / split
    after = (sums[end] - sums[split]) / (end - split)
    within = squares[end] - split * before**2 - (end - split) * after**2
    are_few = split < FEWEST_BEFORE
    freedom = end - 2.0 + are_few * chart.freedom
    scatter = (np.maximum(within, 0.0) + are_few * chart.squares) / freedom
    error = np.sqrt(scatter * (1.0 / split + 1.0 / (end - split)))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.abs(after - before) / error
    t = np.nan_to_num(t, nan=0.0, posinf=np.inf)
    probability = 2.0 * scipy.special.stdtr(freedom, -t)
    return _Steps(before + own.mean(), after + own.mean(), probability)


def _both_moved(
    values: Floats, last: npt.NDArray[np.int64], steps: _Steps
) -> npt.NDArray[np.bool_]:
    """Tell where the last two are nearer to the mean after than to that before.

    So a single wild value is none, however wild.
    """
    middle, way = (steps.before + steps.after) / 2.0, np.sign(steps.after - steps.before)
    moved = ((values[last - back] - middle) * way > 0.0 for back in (0, 1))
    return np.logical_and(*moved)


def _split(values: Floats, chart: _Chart, seen: int) -> int:
    """Give where two means fit best: the most likely first value after the change."""
    splits = np.arange(chart.start + chart.fewest, seen)
    steps = _steps(values, splits, np.full(len(splits), seen + 1), chart)
    sizes = (splits - chart.start) * (seen + 1 - splits) * (steps.after - steps.before) ** 2
    return int(splits[np.argmax(sizes)])
