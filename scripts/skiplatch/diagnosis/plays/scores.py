"""Where touches stand among plays: their ranks as normal scores."""

import numpy as np
import scipy

from skiplatch.arrays import FloatArray

AROUND = 8
"""Touches before within which plays that share something go with each other."""
SHARED = 6.0
"""Standard errors by which they do so, in the mean of all plays, if that is no accident."""


def normal_scores(
    recorded: FloatArray, played: FloatArray, among_equals: FloatArray | float = 0.5
) -> FloatArray:
    """Rank touches, shape (n,), among their plays, shape (r, n); NaN where there is none.

    Args:
        recorded: The touches.
        played: Their plays.
        among_equals: Where among plays that are the same a touch stands, from 0 to 1; shape (n,).
    """
    known = ~np.isnan(played)
    below = np.where(known, played < recorded, False).sum(axis=0)
    same = np.where(known, played == recorded, False).sum(axis=0)
    count = known.sum(axis=0)
    share = (below + among_equals * (same + 1.0)) / (count + 1.0)
    return np.where(np.isnan(recorded) | (count == 0), np.nan, scipy.stats.norm.ppf(share))


def shares_among(pool: FloatArray, values: FloatArray) -> FloatArray:
    """Give the shares of a sorted pool that lie below values, within 0 and 1; NaN is left out."""
    known = values[~np.isnan(values)]
    below, upto = (np.searchsorted(pool, known, side) for side in ("left", "right"))
    return np.asarray((0.5 * (below + upto) + 0.5) / (len(pool) + 1.0))


def way_from_normal(scores: FloatArray) -> float:
    """Give the mean way from scores to those of as many normal ones (Wasserstein's distance)."""
    known = np.sort(scores[~np.isnan(scores)])
    shares = (np.arange(len(known)) + 0.5) / len(known)
    return float(np.mean(np.abs(known - scipy.stats.norm.ppf(shares))))


def go_together(scores: FloatArray) -> bool:
    """Tell whether touches of a play go with those before, by their scores among other plays.

    Args:
        scores: Of each play; shape (r, m).
    """
    off = np.nan_to_num(scores)
    off = off - off.mean(axis=1, keepdims=True)
    square = np.maximum((off**2).mean(axis=1), np.finfo(float).tiny)
    together = (
        float(np.mean((off[:, by:] * off[:, :-by]).mean(axis=1) / square))
        for by in range(1, min(AROUND + 1, off.shape[1]))
    )
    return any(abs(mean) * np.sqrt(off.size) > SHARED for mean in together)
