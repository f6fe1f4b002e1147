"""What touches keep of those before them: how little they scatter in a row, and how few count."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.statistics import CONFIDENCE, Interval
from skiplatch.surface_fit import NOTHING

TOLD_BY_CHANCE = 0.01
"""Chance with which touches that keep nothing of those before are said to."""
LIKEST = 0.99
"""Correlation of one touch with the next from which on more tells no more."""
FEWEST = 6
"""Pairs in a row from which on their scatter is told from that of all."""


@dataclass(frozen=True, slots=True)
class InARow:
    """How touches of one surface scatter that follow each other, with no other in between.

    Attributes:
        sigma: The standard deviation of a touch that half of the mean squared difference gives.
        is_less: Whether that is shown to be less than what all touches scatter by.
    """

    sigma: Interval
    is_less: bool


def in_a_row(
    residuals: FloatArray, surface: NDArray[np.intp], regular: BoolArray, sigma: float
) -> InARow | None:
    """Compare each touch with the one before it, if that is of the same surface.

    The ratio to the variance of all is that of von Neumann (1941); where nothing is kept from touch
    to touch it is 1, with a variance of one over the number of pairs. None for want of pairs.

    Args:
        residuals: Of all touches about the middles of their surfaces, in their order; shape (n,).
        surface: The number of each one's surface; shape (n,).
        regular: Those that enter; shape (n,).
        sigma: What these scatter by.
    """
    pairs = regular[1:] & regular[:-1] & (surface[1:] == surface[:-1])
    count = int(pairs.sum())
    if count < FEWEST or sigma < NOTHING:
        return None
    variance = float(np.mean(np.diff(residuals)[pairs] ** 2)) / 2.0
    # Differences share touches: so many pairs tell as much as two thirds of them would.
    freedom = 2.0 * count / 3.0
    low, high = (
        float(np.sqrt(variance * freedom / scipy.stats.chi2.ppf(0.5 + half, freedom)))
        for half in (CONFIDENCE / 2.0, -CONFIDENCE / 2.0)
    )
    errors = (1.0 - variance / sigma**2) * np.sqrt(count)
    is_less = bool(errors > scipy.stats.norm.isf(TOLD_BY_CHANCE))
    return InARow(Interval(float(np.sqrt(variance)), low, high), is_less)


def independent_share(residuals: FloatArray) -> float:
    """Give which share of touches in a row, shape (n,), counts as independent for a drift.

    By Bartlett (1935), for a correlation that falls off geometrically, as far as it is shown.
    """
    n = len(residuals)
    if n < FEWEST:
        return 1.0
    by_chance = scipy.stats.norm.isf(TOLD_BY_CHANCE) / np.sqrt(n)
    if _seen(residuals) + 1.0 / n <= by_chance:
        return 1.0
    kept = follows(residuals)
    return (1.0 - kept) / (1.0 + kept)


def follows(series: FloatArray) -> float:
    """Give the correlation of a series with itself one reading later, at most LIKEST.

    What it comes short of the truth in a series of this length is added, by Kendall (1954).
    """
    if _squares(series) < NOTHING:
        return 0.0
    seen = _seen(series)
    return min(seen + (1.0 + 4.0 * seen) / len(series), LIKEST)


def _seen(series: FloatArray) -> float:
    """Give the same as it shows in the series itself; 0 of one that does not vary."""
    off, squares = series - series.mean(), _squares(series)
    return float(np.sum(off[1:] * off[:-1])) / squares if squares >= NOTHING else 0.0


def _squares(series: FloatArray) -> float:
    return float(np.sum((series - series.mean()) ** 2))
