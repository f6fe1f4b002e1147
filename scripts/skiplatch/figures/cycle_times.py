"""Cycle time against uncertainty, for one touch and for two: beyond the document's third figure."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from skiplatch.figures import colours, theme
from skiplatch.latch.effort import Effort
from skiplatch.latch.reference_figures.model import FAST_MM_MIN, SLOW_MM_MIN
from skiplatch.planner.document import DOCUMENT_LIMITS
from skiplatch.planner.model import Strategy, cycle_s, range_um
from skiplatch.planner.search import with_back_off
from skiplatch.planner.trial import try_out
from skiplatch.tables import number

FEEDS_MM_MIN = (10.0, SLOW_MM_MIN, 100.0, 300.0, 1000.0, FAST_MM_MIN)
LINE_FEEDS_MM_MIN = np.geomspace(FEEDS_MM_MIN[0], FEEDS_MM_MIN[-1], 100)
DOCUMENT = ((200.0, 0.254), (2.0, 0.444))
"""Its range in µm and its time in s, for one touch and for two."""
WORDS = theme.Words(
    title="For 2 µm one touch takes twenty seconds, two touches take half a second",
    description="Cycle time in s over the range of the measured position in µm, both logarithmic, "
    "4 ms PLC scan. One touch: from 60 s at 0.7 µm down to 0.26 s at 200 µm, in inverse "
    "proportion. Two touches, the first at 3000 mm/min: from 1 s at 0.7 µm to 0.3 s from 10 µm "
    "on. At 2 µm they take 20 s and 0.53 s; near 150 µm they are equal. The document's two "
    "cycles, 0.254 s for 200 µm and 0.444 s for 2 µm, are marked: the first lies on the line, the "
    "second below it, as it does not wait for scans and backs off less.",
)

Kind = Callable[[float], Strategy]


def draw_cycle_times(path: Path, effort: Effort) -> None:
    """Simulate both strategies at several measuring feeds, and draw them with the model."""
    with theme.picture(path, WORDS) as figure:
        axes = figure.subplots()
        _set_up(axes)
        _mark_document(axes)
        for kind, color in ((_one_touch, colours.PLC), (_two_touches, colours.SKIP)):
            _draw_model(axes, kind, color)
            _draw_simulated(axes, kind, color, effort)
        theme.label(axes, "one touch", _point(_one_touch(300.0)), colours.PLC, offset=(10.0, 6.0))
        at = _point(_two_touches(300.0))
        theme.label(axes, "two touches", at, colours.SKIP, offset=(0.0, -16.0), ha="center")
        _mark_gain(axes)


def _one_touch(feed_mm_min: float) -> Strategy:
    return Strategy(measuring_feed_mm_min=feed_mm_min)


def _two_touches(feed_mm_min: float) -> Strategy:
    return with_back_off(DOCUMENT_LIMITS, FAST_MM_MIN, feed_mm_min)


def _point(strategy: Strategy) -> tuple[float, float]:
    """Give range in µm and time in s after the model."""
    return range_um(DOCUMENT_LIMITS, strategy.measuring_feed_mm_min), cycle_s(
        DOCUMENT_LIMITS, strategy
    )


def _draw_model(axes: Axes, kind: Kind, color: str) -> None:
    points = [_point(kind(float(feed))) for feed in LINE_FEEDS_MM_MIN]
    axes.plot(*zip(*points, strict=True), lw=1.4, color=color)


def _draw_simulated(axes: Axes, kind: Kind, color: str, effort: Effort) -> None:
    for feed in FEEDS_MM_MIN:
        trial = try_out(DOCUMENT_LIMITS, kind(feed), effort)
        axes.plot(trial.range_um, trial.cycle_s.value, "o", ms=4.5, mew=0, color=color)


def _mark_document(axes: Axes) -> None:
    for range_and_time in DOCUMENT:
        axes.plot(*range_and_time, "D", ms=8, mew=1.5, mfc="none", mec=colours.INK, zorder=3)
        text = f"document:\n{range_and_time[1]:g} s"
        theme.label(axes, text, range_and_time, colours.INK, offset=(-8.0, -18.0), ha="right")


def _mark_gain(axes: Axes) -> None:
    """Say how much faster two touches are at the document's slow feed."""
    one, two = _point(_one_touch(SLOW_MM_MIN)), _point(_two_touches(SLOW_MM_MIN))
    theme.span(axes, one, two, gap=5.0)
    text = f"{number(one[1], 2)} s or {number(two[1], 2)} s"
    middle = (one[0], float(np.sqrt(one[1] * two[1])))
    theme.label(axes, text, middle, colours.INK, offset=(7.0, 0.0))


def _set_up(axes: Axes) -> None:
    axes.set_title(
        "4 ms PLC scan, stand-off 5 mm, fast feed 3000 mm/min; lines are the model, dots simulated"
    )
    axes.set_xlabel("range of the measured position, µm")
    axes.set_ylabel("cycle time, s")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(0.09, 90.0)
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100, 200], minor=False)
    axes.set_yticks([0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50], minor=False)
    axes.minorticks_off()
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
