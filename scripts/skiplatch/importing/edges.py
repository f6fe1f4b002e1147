"""Edges and latches of a bench in a capture: which channel is the probe, which the latch."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Kind, Status, Touches
from skiplatch.errors import InputError, quoted
from skiplatch.importing.analyser import Capture
from skiplatch.importing.bounces import probe_edges, rested_edges, touch_edges
from skiplatch.importing.edge_channels import Channels, Named, channels_of
from skiplatch.importing.model import Imported
from skiplatch.stand_ins import PLAYED
from skiplatch.units import US_PER_S

LONGEST_WAIT_S = 1.0  # from an edge to its latch
SOONER = 0.2
"""Of the wait after the edges that count, within which latches come after the others instead."""
CHANGES_SIDES = (
    1.5  # as many touches answered by both polarities as by one; 2 where each alternates
)


def read_edges(
    path: Path, capture: Capture, wanted: Channels, *, falling: bool, holdoff_s: float
) -> Imported:
    """Find the touches in a capture.

    Args:
        path: The file, for messages.
        capture: What is in it.
        wanted: Its channels.
        falling: Whether the falling edges of the probe count rather than the rising ones. Latches
            and reports have a polarity of their own: that which follows the edges first.
        holdoff_s: Edges of the probe within this time of one before, or of the release before,
            are bounces, unless they have a latch of their own.

    Raises:
        InputError: A channel is not in it, or has no edge.
    """
    names = channels_of(path, capture, wanted)
    _refuse_coarse(path, capture)
    all_edges, brief = probe_edges(capture, names.probe, holdoff_s, falling=falling)
    rested = rested_edges(all_edges[~brief], holdoff_s)
    answers = {p: _answers(capture, name, rested) for p, name in names.latches.items()}
    latches = {p: times for p, (times, _) in answers.items()}
    edges = touch_edges(all_edges, brief, latches.values(), holdoff_s)
    bounces = len(all_edges) - len(edges)
    if not len(edges):
        sense = "falling" if falling else "rising"
        raise InputError(path, None, None, f"no {sense} edge on channel {quoted(names.probe)}")
    reports = _answers(capture, names.report, rested)[0] if names.report else None
    columns = _together([_columns(p, edges, latches[p], reports) for p in latches])
    found = Imported(kind=Kind.BENCH, preset="bench", columns=Touches.from_columns(**columns))
    missed = int((columns["status"] == Status.MISSED).sum())
    _say(found, capture, names, bounces, missed)
    for p, name in names.latches.items():
        found.known += _after_bounces(name, all_edges, edges, _following(edges, latches[p]))
    sense = "falling" if falling else "rising"
    found.assumed += [
        f"{names.latches[p]} tells the latch by its {own} edges, which come first after the "
        f"{sense} ones of {names.probe}"
        for p, (_, own) in answers.items()
        if own != sense
    ]
    surplus = sum(map(len, latches.values())) - len(edges) * len(latches) + missed
    if surplus > 0:
        found.unread.append(f"latches besides the first after each edge: {surplus}")
    others, brief = probe_edges(capture, names.probe, holdoff_s, falling=not falling)
    others = rested_edges(others[~brief], holdoff_s)
    for p, name in names.latches.items():
        own_us = _after_us(edges, latches[p])
        soon_us = _after_us(others, _answers(capture, name, others)[0])
        if soon_us < SOONER * own_us:
            idles = _idles(names.probe, own_us, soon_us, falling=falling)
            found.assume(idles, "--falling", by="else leave out" if falling else "else give")
    return found


def _refuse_coarse(path: Path, capture: Capture) -> None:
    """Refuse samples that are farther apart than any clock that can be simulated ticks."""
    step_us, most_us = (capture.step_s or 0.0) * US_PER_S, PLAYED["skip", "tick_us"][1]
    if step_us > most_us:
        expected = f"expected samples at most {most_us:g} µs apart, got {step_us:g} µs"
        raise InputError(path, None, None, expected)


def _idles(probe: str, own_us: float, soon_us: float, *, falling: bool) -> str:
    """Say that latches come sooner after the edges of the probe that do not count."""
    sense, idle = ("falling", "low") if falling else ("rising", "high")
    own = f"{own_us:.4g} µs" if np.isfinite(own_us) else "never"
    return (
        f"the {sense} edges of {probe} are contacts, though latches come {own} after them and "
        f"{soon_us:.4g} µs after the others, as if it idled {idle}"
    )


def _after_us(edges: FloatArray, latches: FloatArray) -> float:
    """Give how long after edges latches come, in the middle; never where none does."""
    waits = _following(edges, latches) - edges
    return float(np.nanmedian(waits)) * US_PER_S if np.isfinite(waits).any() else np.inf


def _answers(capture: Capture, name: str, edges: FloatArray) -> tuple[FloatArray, str]:
    """Give the edges of an output that follow those of the probe first, and their polarity.

    An output that only changes sides at each touch answers by both.
    """
    rising, falling = (capture.edges(name, falling=is_low) for is_low in (False, True))
    both = np.sort(np.concatenate([rising, falling]))
    times = {"rising": rising, "falling": falling, "rising and falling": both}
    waits = {sense: _following(edges, t) - edges for sense, t in times.items()}
    share = {
        sense: float(np.mean(~np.isnan(wait))) if len(wait) else 0.0
        for sense, wait in waits.items()
    }
    single = max(share["rising"], share["falling"])
    if share["rising and falling"] > CHANGES_SIDES * single:
        return both, "rising and falling"
    middle = {
        sense: float(np.nanmedian(waits[sense])) if share[sense] >= single / 2 > 0.0 else np.inf
        for sense in ("rising", "falling")
    }
    sense = min(middle, key=lambda name: middle[name])
    return times[sense], sense


def _columns(
    input_path: InputPath, edges: FloatArray, latches: FloatArray, reports: FloatArray | None
) -> dict[str, NDArray[Any]]:
    """Give the touches of one path: of each edge its latch, if there is one."""
    latched, zero = _following(edges, latches), edges[0]
    missed = np.isnan(latched)
    columns: dict[str, NDArray[Any]] = {
        "edge_us": (edges - zero) * US_PER_S,
        "path": np.full(len(edges), input_path),
        "latch_us": (latched - zero) * US_PER_S,
        "status": np.where(missed, Status.MISSED, Status.OK),
    }
    if reports is not None:
        seen_us = (_following(edges, reports) - zero) * US_PER_S
        columns["report_us"] = np.where(missed, np.nan, seen_us)
    return columns


def _together(parts: list[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Put the touches of the paths one behind the other, in order of their edges."""
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    order = np.argsort(columns["edge_us"], kind="stable")
    ordered = {name: values[order] for name, values in columns.items()}
    return {"touch": np.arange(len(order)), **ordered}


def _say(found: Imported, capture: Capture, names: Named, bounces: int, missed: int) -> None:
    reports = f", report {names.report}" if names.report else ""
    latches = ", ".join(
        f"latch {name}" if p is InputPath.SKIP else f"latch of the PLC task {name}"
        for p, name in names.latches.items()
    )
    found.known.append(f"channels: probe {names.probe}, {latches}{reports}")
    found.known.append("edges and latches by one clock: no drift between two can be told")
    if found.columns is not None and missed == len(found.columns):
        unit = ", by times whose unit was assumed" if capture.assumed else ""
        found.known.append(f"none of {missed} edges has a latch within {LONGEST_WAIT_S:g} s{unit}")
    elif missed:
        found.known.append(f"edges without a latch within {LONGEST_WAIT_S:g} s: {missed}")
    if bounces:
        found.assume(
            f"{bounces} edges so near to one before are its bounces, of which a campaign holds no "
            "more than the edge before them, so which of them was latched cannot be told from it",
            "--holdoff-us",
        )
    if capture.step_s:
        step_us = capture.step_s * US_PER_S
        found.figure("skip", "tick_us", step_us, "distance of two samples of the capture")
        noise_us = step_us / np.sqrt(12.0)
        found.figure("bench", "reference_jitter_us", noise_us, "a sample's width over √12")
    found.assumed += capture.assumed
    found.assumed.append("the latch output changes at the latch itself, not some time later")
    if InputPath.PLC not in names.latches:
        found.assume("the latches are those of the skip input, none of a PLC task", "--plc-latch")


def _after_bounces(
    name: str, all_edges: FloatArray, edges: FloatArray, latched: FloatArray
) -> list[str]:
    """Say how long after the last edge before it a latch comes, where that is no first edge.

    Args:
        name: Of the channel of the latches.
        all_edges: With the bounces; shape (m,).
        edges: That begin a touch; shape (n,).
        latched: The latch of each of these, NaN where it was missed; shape (n,).
    """
    known = np.isfinite(latched)
    last = all_edges[np.searchsorted(all_edges, latched[known], side="right") - 1]
    waits_us = (latched[known] - last)[last > edges[known]] * US_PER_S
    if not len(waits_us):
        return []
    low, middle, high = np.percentile(waits_us, [0, 50, 100])
    said = f"{len(waits_us)} latches of {name} come after a bounce, {middle:.4g} µs"
    return [f"{said} ({low:.4g} … {high:.4g}) after the last edge before them"]


def _following(edges: FloatArray, latches: FloatArray) -> FloatArray:
    """Give the first latch after each edge and before the next; NaN where there is none."""
    index = np.searchsorted(latches, edges, side="left")
    padded = np.append(latches, np.inf)
    latch = padded[index]
    following = np.append(edges[1:], np.inf)
    late = (latch >= following) | (latch - edges > LONGEST_WAIT_S)
    return np.where(late, np.nan, latch)
