"""How many false alarms a fleet may give, shared out over its rigs and its time."""

from collections.abc import Sequence
from datetime import datetime, timedelta
from itertools import pairwise

import numpy as np
import numpy.typing as npt

MONTH = timedelta(days=365.25 / 12)
ALARMS_A_MONTH = 0.02
"""False alarms of the whole fleet in a month: one in four years."""


def levels(
    times: Sequence[datetime], charts: int, alarms_a_month: float = ALARMS_A_MONTH
) -> npt.NDArray[np.float64]:
    """Give the probability of a false alarm that each value of a chart may have.

    Every chart has the same share, and spends it as time passes: so the rate stays what it is,
    however many rigs there are and however often they touch. By Boole's inequality the charts
    need not be independent.

    Args:
        times: Of the values.
        charts: Their number in the whole fleet.
        alarms_a_month: False alarms that are expected of all charts together, at most.
    """
    passed = [min(later - earlier, MONTH) for earlier, later in pairwise(times)]
    share = alarms_a_month / charts
    return np.array([0.0, *(share * (step / MONTH) for step in passed)][: len(times)])
