"""By what touches drift: by their number, with time, or with a temperature."""

from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Touches
from skiplatch.settled import TOLD_BY_CHANCE, Settled, settle
from skiplatch.statistics import CONFIDENCE, Interval
from skiplatch.succession import follows
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


@dataclass(frozen=True, slots=True)
class Warmth:
    """How touches go with a thermometer.

    Attributes:
        slope: A kelvin.
        sigma: What touches scatter by without it, and without any drift by number or time.
        is_told: Whether the slope is shown, as many as were looked at.
    """

    slope: Interval
    sigma: Interval
    is_told: bool


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


def by_temperature(
    touches: Touches,
    y: FloatArray,
    dummies: FloatArray,
    conditions: dict[str, FloatArray],
    regular: BoolArray,
) -> dict[str, Warmth]:
    """Give the line in each thermometer that moves, in place of the drift by number.

    Intervals hold for all thermometers together, as the one that fits best is looked at.

    Args:
        touches: In order of time; n of them.
        y: What repeats; shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        conditions: What there is a line in besides, fitted together with that in each thermometer.
        regular: The touches that are fitted; shape (n,).
    """
    named = touches.thermometers
    is_named = any(np.array_equal(touches.temp_c, t, equal_nan=True) for t in named.values())
    warmth = dict(named) if is_named else {"machine": touches.temp_c, **named}
    known = {name: (t, regular & ~np.isnan(t)) for name, t in warmth.items()}
    surfaces = dummies.shape[1]
    tried = {
        name: (t, rows)
        for name, (t, rows) in known.items()
        if rows.sum() > surfaces + FEWEST_FREE and np.ptp(t[rows]) > 0.0
    }
    lines = {
        name: _in_readings(t, y, dummies, conditions, rows) for name, (t, rows) in tried.items()
    }
    found = {}
    for name, line in lines.items():
        if line is not None:
            t, rows = tried[name]
            warm = {"warmth": np.nan_to_num(t - t[rows].mean())}
            fit = fit_surfaces(y, dummies, warm | conditions, rows)
            reach, needed = (
                line.error * float(scipy.stats.t.isf(chance / 2.0 / len(tried), line.freedom))
                for chance in (1.0 - CONFIDENCE, TOLD_BY_CHANCE)
            )
            slope = Interval(line.slope, line.slope - reach, line.slope + reach)
            found[name] = Warmth(slope, fit.sigma, is_told=abs(line.slope) > needed)
    return found


@dataclass(frozen=True, slots=True)
class _Line:
    """A slope, its standard error, and the degrees of freedom of independent readings."""

    slope: float
    error: float
    freedom: float


def _in_readings(
    t: FloatArray,
    y: FloatArray,
    dummies: FloatArray,
    conditions: dict[str, FloatArray],
    rows: BoolArray,
) -> _Line | None:
    """Fit a line to the means of touches that share a reading; None where these are too few.

    Readings that are alike to those before, while what is left is too, count as fewer.
    """
    beside, both = (np.column_stack(of)[rows] for of in ([dummies, *conditions.values()], [t, y]))
    x, off = (both - beside @ np.linalg.lstsq(beside, both, rcond=None)[0]).T
    reading = np.cumsum(np.diff(t[rows], prepend=np.nan) != 0.0) - 1
    count = np.bincount(reading)
    x, off = (np.bincount(reading, values) / count for values in (x, off))
    squares = float(np.sum(count * x**2))
    free = min(len(count) - 2 - len(conditions), len(both) - beside.shape[1] - 1)
    if free < FEWEST_FREE or squares < NOTHING:
        return None
    slope = float(np.sum(count * x * off)) / squares
    left = off - slope * x
    share = _independent(x, left)
    variance = float(np.sum(count * left**2)) / free
    return _Line(slope, float(np.sqrt(variance / squares / share)), max(free * share, 1.0))


def _independent(x: FloatArray, left: FloatArray) -> float:
    """Give which share of readings counts as independent, by how both follow from one to another.

    By Bartlett (1935), for two series whose correlation falls off geometrically.
    """
    both = follows(x) * follows(left)
    return (1.0 - both) / (1.0 + both) if both > 0.0 else 1.0
