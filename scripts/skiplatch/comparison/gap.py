"""How far recorded touches lie from simulated ones, and from chance.

All is in terms of residuals: a touch's value minus the mean of simulated touches in the very same
conditions. That takes out what the conditions alone spread (lobes, ramps), and leaves the gap.
"""

import numpy as np

from skiplatch import statistics
from skiplatch.arrays import FloatArray
from skiplatch.statistics import Interval

RESOLVABLE = 1e-6  # µm or µs: what differs by less is the rounding of the computer


def quantiles_of(reference: FloatArray) -> FloatArray:
    """Give n quantiles of simulated residuals, shape (r, n): the middle of each n-th of them."""
    n = reference.shape[-1]
    return np.asarray(np.quantile(reference, (np.arange(n) + 0.5) / n))


def distance_to(quantiles: FloatArray, residuals: FloatArray) -> FloatArray:
    """Wasserstein distance of samples, shape (…, n), from the quantiles, shape (n,).

    It is the length or time by which a touch has to be moved, on average, to turn one distribution
    into the other.
    """
    return np.asarray(np.mean(np.abs(np.sort(residuals, axis=-1) - quantiles), axis=-1))


def adjusted_p_values(distances: FloatArray, replicates: FloatArray) -> FloatArray:
    """Test every distance, corrected for looking at many at once.

    Single-step maxT of Westfall and Young: the largest of all distances, each in units of its own
    scatter, is compared with the largest of each replicate. Under no gap the recorded campaign is
    one replicate more, so the family-wise false-alarm rate is exact.

    Args:
        distances: Of the recorded touches, shape (cells,).
        replicates: Of simulated replicates, shape (r, cells).

    Returns:
        Shape (cells,); never below 1/(r + 1).
    """
    centre = replicates.mean(axis=0)
    width = np.maximum(replicates.std(axis=0), RESOLVABLE)
    largest = ((replicates - centre) / width).max(axis=1)
    reached = largest[:, None] >= (distances - centre) / width
    return np.asarray((1 + reached.sum(axis=0)) / (1 + len(replicates)))


def mean_interval(residuals: FloatArray) -> Interval:
    """Mean of residuals, shape (n,) with n ≥ 2."""
    return statistics.mean(float(residuals.mean()), float(residuals.std(ddof=1)), len(residuals))


def spread_interval(residuals: FloatArray, simulated: float) -> Interval:
    """Standard deviation of residuals, shape (n,), minus the simulated one."""
    fourth_moment = float(np.mean((residuals - residuals.mean()) ** 4))
    spread = statistics.standard_deviation(float(residuals.std()), fourth_moment, len(residuals))
    return Interval(spread.value - simulated, spread.low - simulated, spread.high - simulated)
