"""Feed over time while one point is touched once, and twice: the document's third figure."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath
from skiplatch.figures import colours, theme
from skiplatch.latch.reference_figures.cycles import FITTED_BACK_OFF_MM
from skiplatch.latch.reference_figures.model import FAST_MM_MIN, SLOW_MM_MIN
from skiplatch.planner.document import DOCUMENT_LIMITS
from skiplatch.planner.model import Leg, Strategy, legs
from skiplatch.units import S_PER_MIN

LIMITS = replace(DOCUMENT_LIMITS, path=InputPath.SKIP)
"""Motions alone: no step waits for a scan."""
ONE = Strategy(measuring_feed_mm_min=FAST_MM_MIN)
TWO = Strategy(
    measuring_feed_mm_min=SLOW_MM_MIN,
    fast_feed_mm_min=FAST_MM_MIN,
    back_off_mm=FITTED_BACK_OFF_MM,
)
WORDS = theme.Words(
    title="The second touch of a point takes 0.19 s",
    description="Feed in mm/min over time in s while the probe goes to a point and back, above the "
    "line towards the surface, below it away. One touch: 3000 mm/min for 0.1 s until the surface, "
    "a short stop, and back, 0.254 s in all. Two touches: the same way to the surface, a back-off "
    "too short to reach the feed, the second touch at 30 mm/min, hardly above the line, for almost "
    "0.2 s, and back: 0.444 s in all. Dots mark where the surface is met.",
)


def draw_one_point(path: Path) -> None:
    """Draw the motion of both strategies of the document, one above the other."""
    with theme.picture(path, WORDS) as figure:
        above, below = figure.subplots(2, sharex=True, sharey=True)
        _draw(above, "one touch, 3000 mm/min", legs(LIMITS, ONE), colours.PLC)
        two = legs(LIMITS, TWO)
        _draw(below, "two touches, 3000 and 30 mm/min", two, colours.SKIP)
        below.set_xlabel("time, s")


def _draw(axes: Axes, name: str, motion: Sequence[Leg], color: str) -> None:
    time_s, feed_mm_min = _profile(motion)
    axes.axhline(0.0, color=colours.MUTED, lw=0.8)
    axes.plot(time_s, feed_mm_min, lw=1.6, color=color)
    axes.set_title(name, loc="left")
    axes.set_ylabel("feed, mm/min")
    axes.set_ylim(-3900.0, 3900.0)
    axes.set_yticks([-3000, 0, 3000])
    axes.set_xlim(0.0, 0.53)
    start_s = 0.0
    for leg in motion:
        if leg.contact_s is not None:
            axes.plot(start_s + leg.contact_s, leg.feed_mm_min, "o", ms=5, color=colours.INK)
        start_s += leg.time_s
    theme.label(axes, f"{time_s[-1]:.3f} s", (time_s[-1], 0.0), color, offset=(6.0, 12.0))


def _profile(motion: Sequence[Leg]) -> tuple[FloatArray, FloatArray]:
    """Give the corners of the trapezoids: times in s and signed feeds, each of shape (4·legs,)."""
    accel = LIMITS.accel_mm_s2 * S_PER_MIN
    corners: list[tuple[float, float]] = []
    start_s = 0.0
    for leg in motion:
        ramp_s = abs(leg.feed_mm_min) / accel
        end_s = start_s + leg.time_s
        corners += [(start_s, 0.0), (start_s + ramp_s, leg.feed_mm_min)]
        corners += [(end_s - ramp_s, leg.feed_mm_min), (end_s, 0.0)]
        start_s = end_s
    time_s, feed_mm_min = np.array(corners).T
    return time_s, feed_mm_min
