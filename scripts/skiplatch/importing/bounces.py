"""Edges of a probe: which ones begin a touch, and which are bounces of a contact or a release."""

from collections.abc import Iterable

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.importing.analyser import Capture


def probe_edges(
    capture: Capture, probe: str, holdoff_s: float, *, falling: bool
) -> tuple[FloatArray, BoolArray]:
    """Give the edges of the probe, and which of them are bounces of a release.

    Those come and go within the hold-off after the release of a contact that lasted longer.
    """
    times, levels = capture.changes[probe]
    lasts = np.append(np.diff(times), np.inf) > holdoff_s
    begins = levels == (0.0 if falling else 1.0)
    begins[0] = False  # the state at first
    brief = np.zeros(len(times), dtype=bool)
    brief[2:] = lasts[:-2] & ~lasts[1:-1] & ~lasts[2:]
    return times[begins], brief[begins]


def touch_edges(
    edges: FloatArray, brief: BoolArray, latches: Iterable[FloatArray], holdoff_s: float
) -> FloatArray:
    """Keep the edges that begin a touch.

    An edge near one before is no bounce if both have a latch of their own by one and the same
    output: another output may well latch in between, as a PLC task after a bounce.

    Args:
        edges: Of the probe, in order; shape (n,).
        brief: Which of them seem to be bounces of a release; shape (n,).
        latches: Times of the latches of each output, in order.
        holdoff_s: How near is near.
    """
    kept = np.zeros(len(edges), dtype=bool)
    for times in latches:
        some = ~brief | _has_within(edges, times, holdoff_s)
        kept[some] |= _begins_touch(edges[some], brief[some], times, holdoff_s)
    return edges[kept]


def _has_within(edges: FloatArray, latches: FloatArray, holdoff_s: float) -> BoolArray:
    """Tell the edges that a latch follows within the hold-off."""
    latch = np.append(latches, np.inf)[np.searchsorted(latches, edges, side="left")]
    return np.asarray(latch - edges <= holdoff_s)


def rested_edges(edges: FloatArray, holdoff_s: float) -> FloatArray:
    """Keep the edges that no other one came shortly before."""
    return edges[np.diff(edges, prepend=-np.inf) > holdoff_s]


def _begins_touch(
    edges: FloatArray, brief: BoolArray, latches: FloatArray, holdoff_s: float
) -> BoolArray:
    """Tell the edges after a pause, and those between a latch of the edge before and their own.

    What seems to be a bounce of a release has no pause before it.
    """
    if not len(edges):
        return np.zeros(0, dtype=bool)
    rested = (np.diff(edges, prepend=-np.inf) > holdoff_s) & ~brief
    before = np.searchsorted(latches, edges, side="left")
    pauses = np.flatnonzero(rested)
    at_next_pause = np.append(before[pauses], len(latches))[np.cumsum(rested)]
    has_own = before < at_next_pause
    begins: BoolArray = rested | ((np.diff(before, prepend=-1) > 0) & has_own)
    return begins
