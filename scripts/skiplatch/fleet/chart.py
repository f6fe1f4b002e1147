"""A control chart that needs no figures of the rig beforehand: has its mean changed, and when?

The changepoint model of Hawkins, Qiu and Kang (Journal of Quality Technology 35 (2003) 355): with
each new value, the newest m are held against all before them by Student's t test, for several m.
Mean and scatter are those of the rig itself. A value counts as an alarm from a probability on that
is handed in, shared by all m (Bonferroni), so that is what at most a false alarm has.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy  # its parts load when they are first used, which takes most of a second

Floats = npt.NDArray[np.float64]

FEWEST_BEFORE = 4
"""Values that tell a scatter at all; with them t has at least four degrees of freedom."""
NEWEST = (2, 3, 5, 8, 13, 21)
"""Sizes m of the newest values: a step shows in few, a drift in many. One alone is an outlier."""


@dataclass(frozen=True, slots=True)
class Shift:
    """A change of the mean.

    Attributes:
        start: Where the values before it begin.
        began: The first value after it.
        seen: The value at which it was found.
        end: One past the last value after it.
    """

    start: int
    began: int
    seen: int
    end: int


def shifts(values: Floats, levels: Floats) -> list[Shift]:
    """Find each change of the mean; after one the chart begins anew.

    Args:
        values: In the order of time, shape (n,).
        levels: Probability of a false alarm that each value may have, shape (n,).
    """
    found = list(_alarms(values, levels))
    return [
        Shift(start, began, seen, end=found[i + 1][1] if i + 1 < len(found) else len(values))
        for i, (start, began, seen) in enumerate(found)
    ]


def _alarms(values: Floats, levels: Floats) -> Iterator[tuple[int, int, int]]:
    """Give the start of the chart, where its values have changed, and where that was seen."""
    start = 0
    while (seen := _first_alarm(values[start:], levels[start:])) is not None:
        began = start + _split(values[start : start + seen + 1])
        yield start, began, start + seen
        start = began


def _first_alarm(values: Floats, levels: Floats) -> int | None:
    """Give the first value at which a test falls below its share of the level."""
    is_alarm = np.zeros(len(values), dtype=bool)
    for size in NEWEST:
        last = np.arange(FEWEST_BEFORE + size - 1, len(values))
        if len(last):
            steps = _steps(values, last + 1 - size, last + 1)
            is_clear = steps.probability * len(NEWEST) < levels[last]
            is_alarm[last] |= is_clear & _both_moved(values, last, steps)
    return int(np.argmax(is_alarm)) if is_alarm.any() else None


@dataclass(frozen=True, slots=True)
class _Steps:
    """Two-sample t tests of values[:split] against values[split:end]."""

    before: Floats
    after: Floats
    probability: Floats


def _steps(values: Floats, split: npt.NDArray[np.int64], end: npt.NDArray[np.int64]) -> _Steps:
    centred = values - values.mean()  # so that sums of squares keep their digits
    sums = np.concatenate(([0.0], np.cumsum(centred)))
    squares = np.concatenate(([0.0], np.cumsum(centred**2)))
    before = sums[split] / split
    after = (sums[end] - sums[split]) / (end - split)
    within = squares[end] - split * before**2 - (end - split) * after**2
    freedom = end - 2.0
    error = np.sqrt(np.maximum(within, 0.0) / freedom * (1.0 / split + 1.0 / (end - split)))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.abs(after - before) / error
    t = np.nan_to_num(t, nan=0.0, posinf=np.inf)
    probability = 2.0 * scipy.special.stdtr(freedom, -t)
    return _Steps(before + values.mean(), after + values.mean(), probability)


def _both_moved(
    values: Floats, last: npt.NDArray[np.int64], steps: _Steps
) -> npt.NDArray[np.bool_]:
    """Tell where the last two are nearer to the mean after than to that before.

    So a single wild value is none, however wild.
    """
    middle, way = (steps.before + steps.after) / 2.0, np.sign(steps.after - steps.before)
    moved = ((values[last - back] - middle) * way > 0.0 for back in (0, 1))
    return np.logical_and(*moved)


def _split(values: Floats) -> int:
    """Give where two means fit best: the most likely first value after the change."""
    splits = np.arange(FEWEST_BEFORE, len(values) - 1)
    steps = _steps(values, splits, np.full(len(splits), len(values)))
    sizes = splits * (len(values) - splits) * (steps.after - steps.before) ** 2
    return int(splits[np.argmax(sizes)])
