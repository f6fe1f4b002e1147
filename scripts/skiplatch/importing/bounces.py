"""Edges of a probe: which ones begin a touch, and which are bounces of a contact or a release."""

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


def has_within(edges: FloatArray, latches: FloatArray, holdoff_s: float) -> BoolArray:
    """Tell the edges that a latch follows within the hold-off."""
    latch = np.append(latches, np.inf)[np.searchsorted(latches, edges, side="left")]
    return np.asarray(latch - edges <= holdoff_s)


def rested_edges(edges: FloatArray, holdoff_s: float) -> FloatArray:
    """Keep the edges that no other one came shortly before."""
    return edges[np.diff(edges, prepend=-np.inf) > holdoff_s]


def begins_touch(edges: FloatArray, latches: FloatArray, holdoff_s: float) -> BoolArray:
    """Tell the edges after a pause, and those between a latch of the edge before and their own."""
    if not len(edges):
        return np.zeros(0, dtype=bool)
    rested = np.diff(edges, prepend=-np.inf) > holdoff_s
    before = np.searchsorted(latches, edges, side="left")
    pauses = np.flatnonzero(rested)
    at_next_pause = np.append(before[pauses], len(latches))[np.cumsum(rested)]
    has_own = before < at_next_pause
    begins: BoolArray = rested | ((np.diff(before, prepend=-1) > 0) & has_own)
    return begins
