"""Whether a gap grew steadily or in steps, and how fast.

A step and a line that leaves a level have as many parameters: level, size and the campaign that
they begin with. So the one that fits better is the likelier one. A line that ends has one more, and
several steps have more. The Bayesian information criterion (Schwarz, Annals of Statistics 6 (1978)
461) charges for that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import numpy.typing as npt
import scipy

from skiplatch.fleet.budget import MONTH
from skiplatch.fleet.chart import FEWEST
from skiplatch.statistics import CONFIDENCE, Interval

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]

CLEAR = 6.0
"""Difference of the criterion from which on something is told: 20 times as likely."""
OF_LINE = 3
"""Parameters of a line, and of a step: level, slope or size, and date; an end is one more."""
SHORTEST = FEWEST - 1
"""Campaigns that a growth takes at least."""
MOST_DATES = 400
"""Campaigns at which a line may begin or end; of more, so many are tried."""


@dataclass(frozen=True, slots=True)
class Drift:
    """A gap that moves steadily from one campaign to another.

    Attributes:
        rate: How much a month, in the unit of the gap. Its 95 % interval knows that the dates are
            estimates as well.
        earliest: The first campaign after which it may have begun, with 95 % confidence.
        latest: The last one.
        end: The campaign with which it was over; None if it goes on.
        before: The gap before it.
        after: The gap at its end.
    """

    rate: Interval
    earliest: int
    latest: int
    end: int | None
    before: float
    after: float


def drift(times: Sequence[datetime], gaps: Floats, steps: Sequence[int], seen: int) -> Drift | None:
    """Tell a steady growth; None unless it is clearly likelier than steps.

    Args:
        times: Of the campaigns.
        gaps: In their unit, shape (n,).
        steps: Campaigns at which a chart says that they moved.
        seen: The campaign with which the first of these was found: the growth had begun by then.
    """
    bends = _some(0, min(seen, len(gaps) - SHORTEST))
    if len(bends) == 0:
        return None
    ends = _some(SHORTEST, len(gaps))
    months = np.array([(time - times[0]) / MONTH for time in times])
    lines = _fitted(months, gaps, bends[:, None], ends[None, :])
    too_short = ends - bends[:, None] < SHORTEST
    lines.squares[too_short] = math.inf
    goes_on = _criterion(lines.squares[:, -1].min(), len(gaps), OF_LINE)
    ended = _criterion(lines.squares.min(), len(gaps), OF_LINE + 1)
    is_over = goes_on - ended > CLEAR
    if _of_steps(gaps, steps) - (ended if is_over else goes_on) < CLEAR:
        return None
    if not is_over:
        lines.squares[:, :-1] = math.inf
    return _likeliest(lines, bends, ends, months, gaps, is_over=is_over)


def _some(first: int, end: int) -> Numbers:
    """Give the numbers from the first up to the end, or so many of them, with both ends."""
    count = min(max(end - first, 0), MOST_DATES)
    return np.linspace(first, end - 1, count).round().astype(np.int64)


@dataclass(frozen=True, slots=True)
class _Fits:
    """Lines through gaps, by where they begin and end.

    Attributes:
        slopes: Of each.
        squares: Sum of squares about each; infinite if it cannot be.
        spread: Sum of squares of the growth about its mean, at a slope of 1.
        growth: Its mean, at a slope of 1.
    """

    slopes: Floats
    squares: Floats
    spread: Floats
    growth: Floats


def _fitted(months: Floats, gaps: Floats, bends: Numbers, ends: Numbers) -> _Fits:
    """Fit lines that are level up to a bend and from an end on.

    By sums up to each campaign, as there are many bends and ends.
    """
    values, count = gaps - gaps.mean(), len(gaps)
    terms = np.stack([months, months**2, values, months * values])
    sums = np.concatenate([np.zeros((4, 1)), terms.cumsum(1)], axis=1)
    x, xx, y, xy = sums[:, ends + 1] - sums[:, bends + 1]
    begun, rise = months[bends], months[ends] - months[bends]
    within, later = ends - bends, count - 1 - ends
    total = x - within * begun + later * rise
    spread = xx - 2.0 * begun * x + within * begun**2 + later * rise**2 - total**2 / count
    product = xy - begun * y - rise * sums[2, ends + 1]
    can_be = (rise > 0.0) & (spread > 0.0)
    slopes = np.divide(product, spread, where=can_be, out=np.zeros_like(spread))
    squares = np.maximum((values**2).sum() - slopes * product, 0.0)
    return _Fits(slopes, np.where(can_be, squares, math.inf), spread, total / count)


def _of_steps(gaps: Floats, steps: Sequence[int]) -> float:
    """Give the criterion of the steps that a chart tells, or of the best one, if that is lower.

    A step is a line from one campaign to the next, however long that takes.
    """
    numbers = np.arange(len(gaps))
    one = _fitted(numbers.astype(np.float64), gaps, numbers[:-1], numbers[1:])
    several = sum(((part - part.mean()) ** 2).sum() for part in np.split(gaps, steps))
    return min(
        _criterion(one.squares.min(), len(gaps), OF_LINE),
        _criterion(several, len(gaps), 1 + 2 * len(steps)),
    )


def _criterion(squares: float, count: int, parameters: int) -> float:
    """Give the Bayesian information criterion: the lower, the likelier."""
    scatter = max(squares / count, float(np.finfo(np.float64).tiny))
    return count * math.log(scatter) + parameters * math.log(count)


def _likeliest(
    lines: _Fits, bends: Numbers, ends: Numbers, months: Floats, gaps: Floats, *, is_over: bool
) -> Drift:
    """Give the best line, with the interval of its likelihood over all dates."""
    place = np.unravel_index(lines.squares.argmin(), lines.squares.shape)
    freedom = len(gaps) - OF_LINE - is_over
    quantile = float(scipy.special.fdtri(1, freedom, CONFIDENCE))
    most = lines.squares[place] * (1.0 + quantile / freedom)
    likely = lines.squares <= most
    half = np.sqrt((most - lines.squares[likely]) / lines.spread[likely])
    slope, slopes = float(lines.slopes[place]), lines.slopes[likely]
    rate = Interval(slope, float((slopes - half).min()), float((slopes + half).max()))
    begun = bends[likely.any(1)]
    bend, end = bends[place[0]], ends[place[1]]
    before = float(gaps.mean() - slope * lines.growth[place])
    after = before + slope * float(months[end] - months[bend])
    return Drift(rate, int(begun[0]), int(begun[-1]), int(end) if is_over else None, before, after)
