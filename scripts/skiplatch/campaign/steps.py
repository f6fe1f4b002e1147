"""The step in which recorded numbers go."""

import numpy as np

from skiplatch.arrays import FloatArray

FEWEST_VALUES = 3
SLACK = 0.05  # of a step: what the decimals of a table cut off
FEWEST_PER_VALUE = 2.0  # numbers a different value; fewer come from the decimals alone


def common_step(values: FloatArray) -> float | None:
    """Give the step that all differences are multiples of, or None where none shows.

    A step shows where numbers fall on the same values again and again.

    Args:
        values: Shape (n,); NaN counts as not there.
    """
    known = np.unique(values[np.isfinite(values)])
    if len(known) < FEWEST_VALUES or np.isfinite(values).sum() < FEWEST_PER_VALUE * len(known):
        return None
    ways = known - known[0]
    step = float(np.diff(known).min())
    for way in ways[1:].tolist():  # the longer the way, the finer it tells the step
        step = way / max(round(way / step), 1)
    multiples = ways / step
    if np.abs(multiples - np.round(multiples)).max() > SLACK:
        return None
    return step
