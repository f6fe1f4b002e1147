"""Whether a change goes with a condition that another one does not go with."""

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.covariates import conditions, varying
from skiplatch.diagnosis.law import SMALLEST
from skiplatch.diagnosis.laws import law_under
from skiplatch.diagnosis.scene import Scene

GOES_WITH, GOES_WITHOUT = 0.9, 0.3
"""Correlations of a shift with a condition that it goes with, and with one that it does not."""


def goes_its_own_way(scene: Scene, change: Change, other: Change) -> bool:
    """Tell whether a change shifts some stream with a condition that the other does not go with."""
    for stream in scene.streams.values():
        rows = stream.rows
        own, others = (
            (law_under(scene, stream, c).mean - stream.law.mean)[rows] for c in (change, other)
        )
        for values in varying(conditions(scene), rows).values():
            goes, other_goes = (_correlation(shift, values) for shift in (own, others))
            if goes > GOES_WITH and other_goes < GOES_WITHOUT:
                return True
    return False


def _correlation(shift: FloatArray, values: FloatArray) -> float:
    """Size of the correlation of two arrays, where the values are known; 0 if one is constant."""
    known = ~np.isnan(values)
    if min(np.ptp(shift[known]), np.ptp(values[known])) < SMALLEST:
        return 0.0
    return abs(float(np.corrcoef(shift[known], values[known])[0, 1]))
