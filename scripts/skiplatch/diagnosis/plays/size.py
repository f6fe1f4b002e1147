"""How large a difference between touches and their plays is: few far off count for little."""

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, winsorised
from skiplatch.statistics import robust_deviation

FAR = 6.0
"""Standard deviations beyond all plays from which on a touch is far off."""


def apart(off: FloatArray, high: BoolArray, kind: str) -> float:
    """Give half the difference of middle or scatter between touches; of all of them from 0."""
    measures = (np.median, _calm_mean) if kind == "shift" else (_calm_spread,)
    if high.all():
        return max(abs(float(measure(off))) for measure in measures)
    if not high.any():
        return 0.0
    # What happens to less than half of them moves no median.
    return max(0.5 * abs(float(measure(off[high]) - measure(off[~high]))) for measure in measures)


def wider(off: FloatArray, played: FloatArray) -> float:
    """Give the scatter on top of that of plays, shape (r, m), in the same measure; else 0."""
    spreads = [_calm_spread(one[~np.isnan(one)]) for one in played if not np.isnan(one).all()]
    usual = np.median(spreads) if spreads else 0.0
    return float(np.sqrt(max(0.0, _calm_spread(off) ** 2 - usual**2)))


def _calm_mean(values: FloatArray) -> float:
    return float(np.mean(winsorised(values)))


def _calm_spread(values: FloatArray) -> float:
    return float(np.std(winsorised(values)))


def far_off(off: FloatArray, reach: FloatArray | float, step: float) -> BoolArray:
    """Tell which touches, so far off the middle of their plays, are beyond all those reach."""
    known = off[~np.isnan(off)]
    usual = FAR * max(robust_deviation(known), step) if len(known) else 0.0
    return np.abs(off) > 2.0 * reach + usual


def upper(values: FloatArray) -> BoolArray:
    """Tell which values lie above their middle, or in it if none does; NaN is in neither half."""
    above = values > np.nanmedian(values)
    return above if above.any() else np.asarray(values >= np.nanmedian(values))
