"""Touches that are off as those made just before them were: drifts, and states that come and go.

Where touches know nothing of each other, the products of scores so many touches apart are nothing
in the mean. Their sum over several lags (Box and Pierce, Journal of the American Statistical
Association 65 (1970) 1509) is skewed, as each score is in many of them: so is Pearson's law of
type III.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.scene.covariates import Order
from skiplatch.statistics import errors_of

WINDOWS = (1, 2, 5, 15)
"""Touches before each that are held against it."""
FEWEST_A_LAG = 4
"""Touches, and pairs of them, for each of these that it takes."""


@dataclass(frozen=True, slots=True, eq=False)
class Memory:
    """How far back touches go with each other.

    Attributes:
        window: So many touches.
        rows: Those about which the others within it are high; shape (m,).
        z: Standard errors of the best window, all that were tried counted (Bonferroni).
    """

    window: int
    rows: BoolArray
    z: float


def remembered(order: Order, rows: BoolArray, scores: FloatArray) -> Memory | None:
    """Find the window in which touches go most with those before them; None for too few.

    Args:
        order: Of all touches, n.
        rows: Which of them have scores; shape (n,).
        scores: Normal ones, shape (m,).
    """
    windows = [window for window in WINDOWS if len(scores) >= FEWEST_A_LAG * window]
    if not windows or np.ptp(scores) == 0.0:
        return None
    off = np.full(len(rows), np.nan)
    off[rows] = scores - scores.mean()
    chances = _chances(order, off, windows)
    best = int(np.argmin(chances))
    window = windows[best]
    others = np.nansum([order.back(off, k) for k in range(-window, window + 1) if k], axis=0)[rows]
    z = errors_of(min(1.0, len(windows) * chances[best]))
    return Memory(window, others > np.median(others), z)


def _chances(order: Order, off: FloatArray, windows: list[int]) -> list[float]:
    """Give the chance of as much by accident for each window."""
    m = np.count_nonzero(~np.isnan(off))
    variance = float(np.nanmean(off**2))
    together, pairs, chances = 0.0, 0, []
    for lag in range(1, max(windows) + 1):
        products = off * order.back(off, lag)
        known = int(np.count_nonzero(~np.isnan(products)))
        # Taking the mean out leaves any two of them a little apart.
        together += float(np.nansum(products)) / variance + known / m
        pairs += known
        if lag in windows:
            chances.append(_chance(together, pairs, lag))
    return chances


def _chance(together: float, pairs: int, lags: int) -> float:
    """Give how often noise is together by as much; always, where the record has too few pairs."""
    if pairs < FEWEST_A_LAG * lags:
        return 1.0
    root = np.sqrt(pairs)
    return float(scipy.stats.pearson3.sf(together / root, 3.0 * (lags - 1.0) / root))
