"""By what touches drift: by their number, with time, or with a temperature."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Touches
from skiplatch.settled import CONDITION, TOLD_BY_CHANCE, WARMTH, Settled, fit_shown, settle
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
        sigma: What touches scatter by without it, and without the lines beside it.
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
    """Give the line in each thermometer that moves.

    Intervals hold for all thermometers together, as the one that fits best is looked at.

    Args:
        touches: In order of time; n of them.
        y: What repeats; shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        conditions: What there is a line in besides, fitted together with that in each thermometer.
        regular: The touches that are fitted; shape (n,).
    """
    known = {name: (t, regular & ~np.isnan(t)) for name, t in _thermometers(touches).items()}
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
                line.error * float(stats.t.isf(chance / 2.0 / len(tried), line.freedom))
                for chance in (1.0 - CONFIDENCE, TOLD_BY_CHANCE)
            )
            slope = Interval(line.slope, line.slope - reach, line.slope + reach)
            found[name] = Warmth(slope, fit.sigma, is_told=abs(line.slope) > needed)
    return found


def beside_warmth(
    touches: Touches,
    y: FloatArray,
    dummies: FloatArray,
    lines: dict[str, FloatArray],
    found: Settled,
    grid: Grid,
) -> tuple[Settled, dict[str, Warmth]]:
    """Fit drifts and the slope with the feed together with the thermometer that is told.

    It is looked for in place of a drift, and else beside one: what grows with the time of day may
    grow with the temperature. Of two that tell the same, fitted together, that stays which is shown
    better. The scatter is given with what goes with the temperature still in it.

    Args:
        touches: In order of time; n of them.
        y: What repeats; shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        lines: What there may be a line in besides; shape (n,) each.
        found: What touches show without a thermometer.
        grid: What readings are rounded to.
    """

    def warmth_beside(names: Iterable[str]) -> dict[str, Warmth]:
        return by_temperature(touches, y, dummies, {n: lines[n] for n in names}, found.regular)

    shown = found.fit.lines
    first = warmth_beside(name for name in shown if name == CONDITION)
    tried = [first, warmth_beside(shown)] if {*shown} - {CONDITION} else [first]
    for name in dict.fromkeys(name for warmth in tried for name in _told(warmth)):
        t = _thermometers(touches)[name]
        rows = found.regular & ~np.isnan(t)
        warm = np.nan_to_num(t - t[rows].mean())
        joint = fit_shown(y, dummies, lines | {WARMTH: warm}, rows, grid.finest(y[rows]))
        warmth = warmth_beside(each for each in joint.fit.lines if each != WARMTH)
        if WARMTH in joint.fit.lines and name in warmth and warmth[name].is_told:
            fit = joint.fit.with_line_left_in(WARMTH, warm, rows)
            return Settled(fit, found.regular, joint.intervals), warmth
    return found, {name: replace(warmth, is_told=False) for name, warmth in tried[-1].items()}


def _told(warmth: dict[str, Warmth]) -> list[str]:
    """Give the thermometers that are told, first that which leaves the least scatter."""
    told = [name for name, each in warmth.items() if each.is_told]
    return sorted(told, key=lambda name: warmth[name].sigma.value)


def _thermometers(touches: Touches) -> dict[str, FloatArray]:
    """Give all of them by their names, that of the machine among them."""
    named = touches.thermometers
    is_named = any(np.array_equal(touches.temp_c, t, equal_nan=True) for t in named.values())
    return dict(named) if is_named else {"machine": touches.temp_c, **named}


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
