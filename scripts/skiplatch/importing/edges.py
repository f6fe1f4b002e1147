"""Edges and latches of a bench in a capture: which channel is the probe, which the latch."""

from pathlib import Path

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Kind, Touches
from skiplatch.errors import InputError, hint, quoted
from skiplatch.importing.captures import Capture
from skiplatch.importing.model import Imported

US_PER_S = 1e6
LONGEST_WAIT_S = 1.0  # from an edge to its latch


def read_edges(
    path: Path,
    capture: Capture,
    probe: str | None,
    latch: str | None,
    report: str | None,
    *,
    falling: bool,
    holdoff_s: float,
) -> Imported:
    """Find the touches in a capture.

    Args:
        path: The file, for messages.
        capture: What is in it.
        probe: Channel of the injected edge; the first where none is named.
        latch: Channel that changes at the latch; the second.
        report: Channel that changes at the report, if any.
        falling: Whether the falling edges count rather than the rising ones.
        holdoff_s: Edges of the probe within this time of one before are bounces, unless they
            have a latch of their own.

    Raises:
        InputError: A channel is not in it, or has no edge.
    """
    probe, latch = _channels(path, capture, probe, latch)
    edges = capture.edges(_named(path, capture, probe), falling=falling)
    latches = capture.edges(_named(path, capture, latch), falling=falling)
    first = _begins_touch(edges, latches, holdoff_s)
    bounces, edges = int((~first).sum()), edges[first]
    if not len(edges):
        sense = "falling" if falling else "rising"
        raise InputError(path, None, None, f"no {sense} edge on channel {quoted(probe)}")
    zero = edges[0]
    latched = _following(edges, latches)
    columns = {
        "touch": np.arange(len(edges)),
        "edge_us": (edges - zero) * US_PER_S,
        "latch_us": (latched - zero) * US_PER_S,
        "status": np.where(np.isnan(latched), 1, 0),
    }
    if report:
        seen = _following(edges, capture.edges(_named(path, capture, report), falling=falling))
        columns["report_us"] = np.where(np.isnan(latched), np.nan, (seen - zero) * US_PER_S)
    found = Imported(kind=Kind.BENCH, preset="bench", columns=Touches.from_columns(**columns))
    _say(found, capture, (probe, latch, report), bounces, latched)
    return found


def _say(
    found: Imported,
    capture: Capture,
    names: tuple[str, str, str | None],
    bounces: int,
    latched: FloatArray,
) -> None:
    probe, latch, report = names
    reports = f", report {report}" if report else ""
    found.known.append(f"channels: probe {probe}, latch {latch}{reports}")
    found.known.append("edges and latches by one clock: no drift between two can be told")
    missed = int(np.isnan(latched).sum())
    if missed:
        found.known.append(f"{missed} edges without a latch within {LONGEST_WAIT_S:g} s")
    if bounces:
        found.assumed.append(f"{bounces} edges so near to one before are its bounces (--holdoff)")
    if capture.step_s:
        step_us = capture.step_s * US_PER_S
        found.figure("skip", "tick_us", step_us, "distance of two samples of the capture")
        noise_us = step_us / np.sqrt(12.0)
        found.figure("bench", "reference_jitter_us", noise_us, "a sample's width over √12")
    found.assumed.append("the latch output changes at the latch itself, not some time later")


def _channels(
    path: Path, capture: Capture, probe: str | None, latch: str | None
) -> tuple[str, str]:
    """Take the channels that are named, else those whose names say so, else the first two."""
    active = [name for name, (times, _) in capture.changes.items() if len(times) > 1]
    probe = (
        probe or _like(active, ("probe", "edge", "trig", "touch", "in")) or next(iter(active), "")
    )
    others = [name for name in active if name != probe]
    latch = latch or _like(others, ("latch", "skip", "out", "ack")) or next(iter(others), "")
    if not probe or not latch:
        names = ", ".join(capture.changes)
        raise InputError(path, None, None, f"expected two channels that change; there are: {names}")
    return probe, latch


def _like(names: list[str], words: tuple[str, ...]) -> str | None:
    return next((name for word in words for name in names if word in name.lower()), None)


def _named(path: Path, capture: Capture, name: str) -> str:
    """Give the channel of a name, or of its number."""
    names = list(capture.changes)
    for known in names:
        if name in (known, known.removeprefix("Channel ")) or name.lower() == known.lower():
            return known
    message = f"no channel {quoted(name)}{hint(name, names)}; there are: {', '.join(names)}"
    raise InputError(path, None, None, message)


def _begins_touch(edges: FloatArray, latches: FloatArray, holdoff_s: float) -> BoolArray:
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


def _following(edges: FloatArray, latches: FloatArray) -> FloatArray:
    """Give the first latch after each edge and before the next; NaN where there is none."""
    index = np.searchsorted(latches, edges, side="left")
    padded = np.append(latches, np.inf)
    latch = padded[index]
    following = np.append(edges[1:], np.inf)
    late = (latch >= following) | (latch - edges > LONGEST_WAIT_S)
    return np.where(late, np.nan, latch)
