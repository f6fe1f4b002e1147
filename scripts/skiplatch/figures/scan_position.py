"""Error against the position of the edge in the scan: the document's first figure."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath
from skiplatch.figures import colours, theme
from skiplatch.latch.probing import one_touch
from skiplatch.latch.reference_figures.example import (
    FIRST_WAIT_US,
    SECOND_WAIT_US,
    wait_from_zero_us,
)
from skiplatch.latch.reference_figures.model import FAST_MM_MIN, IDEAL
from skiplatch.units import US_PER_S

SCANS = 3
TOUCHES_PER_SCAN = 40
SCAN_US = IDEAL.plc.scan_us
MARKED_US = np.array([SCAN_US - FIRST_WAIT_US, 2.0 * SCAN_US - SECOND_WAIT_US])
ARROW_MS = 13.2
WORDS = theme.Words(
    title="Where in the scan an edge comes decides what a polled probe measures",
    description="Position error in µm over the time of the edge in ms, 4 ms PLC scan, 3000 mm/min. "
    "In each scan the error of the simulated touches falls in a straight line from 200 µm for an "
    "edge just after a scan to 0 for one just before the next: a sawtooth. Two edges are marked: "
    "one 3.25 ms before its scan with an error of 162.5 µm, one 0.75 ms before with 37.5 µm; they "
    "differ by 125 µm. A skip input without delay stays at 0.",
)


def draw_scan_position(path: Path, *, seed: int) -> None:
    """Simulate touches all over the scan, and draw their errors."""
    times_us = (np.arange(SCANS * TOUCHES_PER_SCAN) + 0.5) / TOUCHES_PER_SCAN * SCAN_US
    polled_um = _deviation_um(InputPath.PLC, times_us, seed)
    latched_um = _deviation_um(InputPath.SKIP, times_us, seed)
    marked_um = _deviation_um(InputPath.PLC, MARKED_US, seed)
    with theme.picture(path, WORDS) as figure:
        axes = figure.subplots()
        _set_up(axes)
        axes.plot(times_us / 1e3, polled_um, "o", ms=3.6, mew=0, color=colours.PLC)
        axes.plot(times_us / 1e3, latched_um, "o", ms=3.6, mew=0, color=colours.SKIP)
        _mark(axes, marked_um)
        theme.label(axes, "skip input, no delay", (times_us[-1] / 1e3, 0.0), colours.SKIP)
        last_scan = (times_us[-TOUCHES_PER_SCAN] / 1e3, polled_um[-TOUCHES_PER_SCAN])
        theme.label(axes, "PLC task", last_scan, colours.PLC, offset=(12.0, 4.0))


def _deviation_um(path: InputPath, times_us: FloatArray, seed: int) -> FloatArray:
    """Play touches whose edges come so long after a scan, shape (n,)."""
    reference = one_touch(IDEAL, InputPath.PLC, FAST_MM_MIN)
    starts_us = times_us + wait_from_zero_us(reference, seed)
    probing = one_touch(IDEAL, path, FAST_MM_MIN)
    outcomes = probing.play(probing.at(starts_us / US_PER_S), seed=seed)
    return np.asarray(outcomes.deviation_um[0])


def _set_up(axes: Axes) -> None:
    scans_ms = SCAN_US / 1e3 * np.arange(SCANS + 1)
    axes.set_title("Simulated touches at 3000 mm/min, one dot each; upright lines are scans")
    axes.set_xlabel("time of the edge, ms")
    axes.set_ylabel("position error, µm")
    axes.set_xlim(0.0, scans_ms[-1] + 3.4)
    axes.set_ylim(-8.0, 212.0)
    axes.set_xticks(scans_ms)
    axes.grid(axis="x", visible=False)
    for scan_ms in scans_ms:
        axes.axvline(scan_ms, color=colours.MUTED, lw=0.9, ls=(0, (2, 3)))


def _mark(axes: Axes, marked_um: FloatArray) -> None:
    """Mark the two edges of the worked example, and by how much they differ."""
    times_ms = MARKED_US / 1e3
    axes.plot(times_ms, marked_um, "o", ms=9, zorder=3, mew=2, mfc=colours.PAPER, mec=colours.INK)
    for time_ms, error_um in zip(times_ms, marked_um, strict=True):
        axes.plot([time_ms, ARROW_MS], [error_um] * 2, color=colours.INK, lw=0.8, ls=(0, (4, 3)))
    first, second = zip(times_ms, marked_um, strict=True)
    first_text, second_text = (
        f"seen {wait_us / 1e3:g} ms later:\n{error_um:.1f} µm"
        for wait_us, error_um in zip((FIRST_WAIT_US, SECOND_WAIT_US), marked_um, strict=True)
    )
    theme.label(axes, first_text, first, colours.INK, offset=(10.0, 7.0), va="bottom")
    theme.label(axes, second_text, second, colours.INK, offset=(-10.0, -6.0), ha="right")
    theme.span(axes, (ARROW_MS, first[1]), (ARROW_MS, second[1]))
    middle = (ARROW_MS, float(marked_um.mean()))
    theme.label(axes, f"{np.ptp(marked_um):.0f} µm\napart", middle, colours.INK)
