"""Errors of a rotary axis against its angle, before and after the correction."""

import numpy as np
from matplotlib.axes import Axes

from skiplatch.figures import colours
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.kinematics.evaluation import AxisResult

HEIGHT_IN = 2.5
LEAST_SPAN_MM = 0.002
"""A chart shows no less, so that noise does not look like an error."""


def draw_axis(axis: AxisResult, name: str) -> dict[str, Drawing]:
    """Draw the errors in X, Y and Z: EXC, EYC and EZC of axis C, by these names.

    Args:
        axis: What was measured.
        name: Begins the names of the pictures; unique in the page.
    """
    titles = [f"E{coordinate}{axis.letter}" for coordinate in "XYZ"]
    return {title: _draw(axis, i, title, name) for i, title in enumerate(titles)}


def _draw(axis: AxisResult, i: int, title: str, name: str) -> Drawing:
    coordinate = "XYZ"[i]
    order = np.argsort(np.append(axis.angle_deg, 0.0))
    angle_deg = np.append(axis.angle_deg, 0.0)[order]
    before_mm = np.append(axis.before_mm[:, i], 0.0)[order]
    after_mm = np.append(axis.after_mm[:, i], 0.0)[order]
    with panel(HEIGHT_IN) as figure:
        axes = figure.subplots()
        axes.axhline(0.0, color=colours.MUTED, lw=0.8)
        axes.plot(angle_deg, before_mm, "o-", color=colours.RED, ms=4, lw=1.4)
        axes.plot(angle_deg, after_mm, "s-", color=colours.FOURTH, ms=3.5, lw=1.4)
        _set_up(axes, axis.letter, title, np.concatenate([before_mm, after_mm]))
        described = (
            f"{title}, the error of axis {axis.letter} in {coordinate}, in mm over its angle from "
            f"{angle_deg[0]:g}° to {angle_deg[-1]:g}°: before, in red, up to "
            f"{np.max(np.abs(before_mm)):.4f} mm; after, in green, up to "
            f"{np.max(np.abs(after_mm)):.4f} mm."
        )
        caption = f"{title}: error of axis {axis.letter} in {coordinate}, relative to 0°"
        return drawing(figure, f"{name}-{title.lower()}", caption, described)


def _set_up(
    axes: Axes, letter: str, title: str, shown_mm: np.ndarray[tuple[int], np.dtype[np.float64]]
) -> None:
    axes.set_title(title)
    axes.set_xlabel(f"{letter}, deg")
    axes.set_ylabel("error, mm")
    low, high = float(np.min(shown_mm)), float(np.max(shown_mm))
    room = max(0.08 * (high - low), (LEAST_SPAN_MM - (high - low)) / 2.0)
    axes.set_ylim(low - room, high + room)
    axes.ticklabel_format(axis="y", useOffset=False, style="plain")
