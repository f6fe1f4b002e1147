"""Cells: the touches of one path and one feed, which differ in little but their noise."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign import InputPath, Touches

MOST_FEEDS = 12
FEED_GROUPS = 8

Rows = NDArray[np.intp]


def feed_groups(feed_mm_min: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the feed of each touch, shape (n,), or the middle one of its group.

    Groups of neighbouring feeds, with as many touches each, stand in for the feeds themselves
    where nearly every touch has its own.
    """
    if len(np.unique(feed_mm_min)) <= MOST_FEEDS:
        return feed_mm_min
    inner = np.quantile(feed_mm_min, np.arange(1, FEED_GROUPS) / FEED_GROUPS)
    group = np.searchsorted(inner, feed_mm_min)
    middles = {number: np.median(feed_mm_min[group == number]) for number in np.unique(group)}
    return np.array([middles[number] for number in group])


def cells_of(
    touches: Touches, known: NDArray[np.bool_], fewest: int
) -> Iterator[tuple[InputPath, float, Rows]]:
    """Give path, feed in mm/min and touches of every cell that has enough known ones."""
    feeds = feed_groups(touches.feed_mm_min)
    for path in InputPath:
        for feed in np.unique(feeds):
            rows = np.flatnonzero(known & (touches.path == path) & (feeds == feed))
            if len(rows) >= fewest:
                yield path, float(feed), rows
