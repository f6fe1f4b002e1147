"""Histograms of the latch error, one panel a path."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from skiplatch.campaign import InputPath
from skiplatch.figures import colours, theme
from skiplatch.latch.distribution import Summary
from skiplatch.latch.errors import LatchErrors
from skiplatch.latch.text import TITLES
from skiplatch.tables import compact, whole

COLORS = {
    InputPath.SKIP: (colours.SKIP, colours.SKIP_LIGHT),
    InputPath.PLC: (colours.PLC, colours.PLC_LIGHT),
}
PANEL_IN = 2.3
HEAD_IN = 0.7
ROOM = 1.6  # above the histogram, for what is written there
SPREAD_AT = 0.92  # of the height
BIAS_AT = 0.8


def draw_latch_errors(
    path: Path, errors: Mapping[InputPath, LatchErrors], feed_mm_min: float
) -> None:
    """Draw how late each path latches, and say what that is in position at that feed."""
    words = _words(errors, feed_mm_min)
    with theme.picture(path, words, height_in=HEAD_IN + PANEL_IN * len(errors)) as figure:
        panels = figure.subplots(len(errors), squeeze=False)[:, 0]
        for axes, (input_path, found) in zip(panels, errors.items(), strict=True):
            _draw_panel(axes, input_path, found.latency_us)
            touches = whole(found.latency_us.count)
            axes.set_title(
                f"{TITLES[input_path]}, {touches} simulated touches at {feed_mm_min:g} mm/min"
            )
            _mark_bias(axes, found)
            _mark_spread(axes, found)
        panels[-1].set_xlabel("time stamp of the latch minus edge, µs")


def _draw_panel(axes: Axes, path: InputPath, latency_us: Summary) -> None:
    color, light = COLORS[path]
    edges, counts = np.array(latency_us.histogram.edges), np.array(latency_us.histogram.counts)
    density = 100.0 * counts / counts.sum() / np.diff(edges)
    axes.stairs(density, edges, fill=True, color=light)
    axes.stairs(density, edges, color=color, lw=1.2)
    axes.set_ylabel("share, % per µs")
    axes.set_ylim(0.0, ROOM * density.max())
    axes.grid(axis="x", visible=False)


def _mark_bias(axes: Axes, found: LatchErrors) -> None:
    bias_us = found.latency_us.mean.value
    axes.axvline(bias_us, ymax=BIAS_AT, color=colours.INK, lw=1.2)
    at = (bias_us, BIAS_AT * axes.get_ylim()[1])
    text = f"bias {_both(bias_us, found.position_um.mean.value)}"
    theme.label(axes, text, at, colours.INK, offset=(6.0, -7.0))


def _mark_spread(axes: Axes, found: LatchErrors) -> None:
    low_us, high_us = found.latency_us.minimum.value, found.latency_us.maximum.value
    height = SPREAD_AT * axes.get_ylim()[1]
    theme.span(axes, (low_us, height), (high_us, height))
    text = f"spread {_both(found.latency_us.range.value, found.position_um.range.value)}"
    at = ((low_us + high_us) / 2.0, height)
    theme.label(axes, text, at, colours.INK, offset=(0.0, 0.0), ha="center")


def _both(us: float, um: float) -> str:
    return f"{compact(us)} µs or {compact(um)} µm"


def _words(errors: Mapping[InputPath, LatchErrors], feed_mm_min: float) -> theme.Words:
    spreads = [
        f"{TITLES[path]} {compact(found.latency_us.range.value, 2)} µs"
        for path, found in errors.items()
    ]
    panels = [
        f"{TITLES[path]}: bias {_both(found.latency_us.mean.value, found.position_um.mean.value)}, "
        f"spread {_both(found.latency_us.range.value, found.position_um.range.value)}."
        for path, found in errors.items()
    ]
    return theme.Words(
        title=f"Spread of the latch: {', '.join(spreads)}",
        description="Histograms of the time from the edge to the time stamp of the latch in µs, "
        f"and what it is in position in µm at {feed_mm_min:g} mm/min. {' '.join(panels)}",
    )
