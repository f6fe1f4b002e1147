"""How many touches far off all plays may be accidents."""

import scipy

MOST_OUTLIERS = 0.05
"""Share of touches, in the mean of many campaigns, up to which those far off are accidents."""
RARELY = 0.01
"""Chance of more of them than that, or of so many to one side, makes no accident."""


def fall_to_either_side(far: int, beyond: int) -> bool:
    """Tell whether of so many touches far off some lie to either side, as of accidents half do."""
    most = max(beyond, far - beyond)
    return most < far and bool(scipy.stats.binom.sf(most - 1, far, 0.5) > RARELY)


def may_be_accidents(far: int, touches: int, share: float = MOST_OUTLIERS, told: str = "") -> bool:
    """Tell whether so many may be far off where such a share is, in the mean; none that is told."""
    return bool(not told and far <= scipy.stats.binom.ppf(1.0 - RARELY, touches, share))
