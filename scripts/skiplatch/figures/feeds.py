"""Uncertainty against feed, for inputs from a slow scan to a fast skip input."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from skiplatch.campaign import InputPath, Nominal, PlcNominal
from skiplatch.figures import colours, theme
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import latch_errors
from skiplatch.latch.probing import one_touch
from skiplatch.latch.reference_figures.model import IDEAL, direct_input, range_um
from skiplatch.units import S_PER_MIN

FEEDS_MM_MIN = np.array([10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 10_000.0])
DOCUMENT = ((3000.0, 200.0), (30.0, 2.0), (3000.0, 10.0), (3000.0, 0.2))
"""The four ranges that the document prints: feed in mm/min, range in µm."""
WORDS = theme.Words(
    title="Uncertainty grows with the feed; a fast skip input makes it a thousandth",
    description="Range of the measured position in µm over the feed in mm/min, both logarithmic. "
    "Simulated points of four inputs lie on four parallel lines of slope one, the reaction time "
    "times the feed: a PLC scan of 4 ms, one of 1 ms, a skip input of 0.2 ms and one of 4 µs. At "
    "3000 mm/min they are at 200, 50, 10 and 0.2 µm. The document's four figures, marked by "
    "rings, lie on the lines.",
)


@dataclass(frozen=True, slots=True)
class Input:
    """An input that reacts at any time within the width."""

    name: str
    path: InputPath
    rig: Nominal
    width_us: float
    color: str


def _scan(period_us: float) -> Nominal:
    return replace(IDEAL, plc=PlcNominal(period_us))


INPUTS = (
    Input("PLC scan, 4 ms", InputPath.PLC, _scan(4000.0), 4000.0, colours.PLC),
    Input("PLC scan, 1 ms", InputPath.PLC, _scan(1000.0), 1000.0, colours.THIRD),
    Input("skip input, 0.2 ms", InputPath.SKIP, direct_input(200.0), 200.0, colours.FOURTH),
    Input("skip input, 4 µs", InputPath.SKIP, direct_input(4.0), 4.0, colours.SKIP),
)


def draw_feeds(path: Path, effort: Effort) -> None:
    """Simulate the range at several feeds for each input, and draw it with v·T."""
    parts = iter(effort.split(len(INPUTS) * len(FEEDS_MM_MIN)))
    with theme.picture(path, WORDS) as figure:
        axes = figure.subplots()
        _set_up(axes)
        for entry in INPUTS:
            ranges_um = [_range_um(entry, feed, next(parts)) for feed in FEEDS_MM_MIN]
            axes.plot(FEEDS_MM_MIN, ranges_um, "o", ms=4.5, mew=0, color=entry.color)
            formula_um = FEEDS_MM_MIN / S_PER_MIN * entry.width_us / 1e3
            axes.plot(FEEDS_MM_MIN, formula_um, lw=1.4, color=entry.color)
            end = (float(FEEDS_MM_MIN[-1]), float(formula_um[-1]))
            theme.label(axes, entry.name, end, entry.color, offset=(9.0, 0.0))
        for feed, printed_um in DOCUMENT:
            axes.plot(feed, printed_um, "o", ms=11, mew=1.6, mfc="none", mec=colours.INK)
            text = f"{printed_um:g} µm"
            theme.label(axes, text, (feed, printed_um), colours.INK, offset=(-8.0, 7.0), ha="right")


def _range_um(entry: Input, feed_mm_min: float, part: Effort) -> float:
    return range_um(latch_errors(one_touch(entry.rig, entry.path, feed_mm_min), part)).value


def _set_up(axes: Axes) -> None:
    axes.set_title(
        "Dots are simulated, lines are reaction time × feed; the document prints the rings"
    )
    axes.set_xlabel("measuring feed, mm/min")
    axes.set_ylabel("range of the measured position, µm")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(8.0, 50_000.0)
    axes.set_ylim(3e-4, 2e3)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
