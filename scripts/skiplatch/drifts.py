"""By what touches drift: by their number, with time, or with a temperature."""

from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Touches
from skiplatch.settled import Settled, settle
from skiplatch.statistics import Interval
from skiplatch.surface_fit import NOTHING, Grid, fit_surfaces
from skiplatch.units import S_PER_H

FEWEST_FREE = 2
"""Degrees of freedom, of all surfaces together, from which on a scatter is told."""
TIME_GAINS = 10.0
"""Twice the log likelihood that a drift with time is better by than one by number, to be taken. The
number is as good where touches follow at one pace, and two lines to choose from find more by luck.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """What a drift goes with.

    Attributes:
        x: The number of each touch, or its time in touches of the mean pace; shape (n,).
        per_h: Touches an hour at that pace; None where the number counts.
    """

    x: FloatArray
    per_h: float | None = None


def with_drift(
    course: Course, conditions: dict[str, FloatArray], sign: FloatArray
) -> dict[str, FloatArray]:
    """Give the lines that touches may have; an axis may drift where they have both senses."""
    lines = {"order": course.x, **conditions}
    if np.ptp(sign) > 0.0:  # NaN, where a sense is not known, is not
        lines["axis"] = (course.x - course.x.mean()) * sign
    return lines


def course_of(
    touches: Touches,
    y: FloatArray,
    dummies: FloatArray,
    conditions: dict[str, FloatArray],
    usual: BoolArray,
    grid: Grid,
) -> Course:
    """Take the time where it is known and the touches go by it better than by their number.

    Args:
        touches: In order of time; n of them.
        y: What repeats; shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        conditions: What there may be a line in besides.
        usual: No first touches; shape (n,).
        grid: What readings are rounded to.
    """
    n = len(y)
    by_number, span_s = Course(np.arange(n, dtype=float)), float(np.ptp(touches.time_s))
    if not span_s > 0.0:  # NaN where a time is not known
        return by_number
    with_time = (touches.time_s - touches.time_s[0]) / span_s * (n - 1)
    by_time = Course(with_time, (n - 1) / span_s * S_PER_H)
    if np.allclose(by_time.x, by_number.x):
        return by_number
    one, other = (
        settle(y, dummies, with_drift(course, conditions, touches.sign), usual, usual, grid)
        for course in (by_number, by_time)
    )
    return by_time if _gain(one, other) > TIME_GAINS else by_number


def _gain(one: Settled, other: Settled) -> float:
    """Give twice the log likelihood that another fit has more, on the touches of both."""
    both = one.regular & other.regular
    squares = [max(float(np.sum(s.fit.residuals[both] ** 2)), NOTHING) for s in (one, other)]
    return float(both.sum() * np.log(squares[0] / squares[1]))


def per_kelvin(
    touches: Touches, offsets: FloatArray, regular: BoolArray, surfaces: int
) -> dict[str, Interval]:
    """Give the slope against each thermometer that moves, in place of the drift by number."""
    named = touches.thermometers
    is_named = any(np.array_equal(touches.temp_c, t, equal_nan=True) for t in named.values())
    warmth = dict(named) if is_named else {"machine": touches.temp_c, **named}
    found = {}
    for name, values in warmth.items():
        rows = regular & ~np.isnan(values)
        if rows.sum() > surfaces + FEWEST_FREE and np.ptp(values[rows]) > 0.0:
            line = {"order": np.nan_to_num(values - values[rows].mean())}
            fit = fit_surfaces(np.nan_to_num(offsets), np.ones((len(offsets), 1)), line, rows)
            slope = fit.interval("order")
            if slope is not None:
                found[name] = slope
    return found
