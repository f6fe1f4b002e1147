"""Types of arrays (shapes stand where they are documented), and what is told of any array."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IndexArray = NDArray[np.intp]

WITHOUT_WORST = (0.02, 0.98)
"""Quantiles beyond which values count no further."""


def median(values: FloatArray) -> float:
    """Give the median of known values; shape (n,), n > 0.

    What np.median does without its checks, which take longer than the middle of some hundred.
    """
    low, high = (len(values) - 1) // 2, len(values) // 2
    parted = values.copy()
    parted.partition((low, high))
    return float(parted[low] + parted[high]) / 2.0


def is_varied(values: FloatArray) -> bool:
    """Tell whether some values differ; NaN is none."""
    known = values[~np.isnan(values)]
    return bool(len(known) and np.ptp(known) > 0.0)


def drawn(count: int, most: int, seed: int) -> IndexArray:
    """Number things, of which there are `count`: at most so many, drawn evenly, in their order."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(seed).choice(count, most, replace=False))


def spaced(count: int, most: int) -> IndexArray:
    """Number things, of which there are `count`: at most so many from the first to the last."""
    return np.linspace(0, count - 1, min(count, most)).round().astype(np.intp)


def winsorised(values: FloatArray) -> FloatArray:
    """Cut the few least and greatest of known values, shape (n,), to the rest; n > 0."""
    return np.clip(values, *np.quantile(values, WITHOUT_WORST))


def calmed(values: FloatArray, error_variance: float) -> FloatArray:
    """Draw estimates towards their mean by the share of their variance that is their error."""
    variance = float(np.var(values))
    kept = max(0.0, 1.0 - error_variance / variance) if variance > 0.0 else 0.0
    return np.asarray(values.mean() + kept * (values - values.mean()))
