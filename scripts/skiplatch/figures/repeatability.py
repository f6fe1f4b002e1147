"""Deviations of repeated touches, one after the other."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from skiplatch.figures import theme
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.repeatability import Repeatability

BAND = "band: ±σ; crosses: outliers"
WIDE_IN, HIGH_IN = 4.6, 2.4


def draw_repeatability(path: Path, found: Repeatability, sentence: str) -> None:
    """Draw what is left without middles and feeds, outliers marked."""
    words = theme.Words(
        title=f"{len(found.touches)} touches, σ = {found.sigma.value:.3g} {found.unit}",
        description=f"{_described(found)} {sentence}",
    )
    with theme.picture(path, words, height_in=3.6) as figure:
        axes = figure.subplots()
        _draw(axes, found)
        axes.set_title(BAND)


def repeatability_panel(name: str, found: Repeatability, sentence: str) -> Drawing:
    """Draw the same for a page; `name` is unique in the page."""
    with panel(HIGH_IN, WIDE_IN) as figure:
        _draw(figure.subplots(), found)
    return drawing(
        figure, name, f"Each touch in its turn; {BAND}", f"{_described(found)} {sentence}"
    )


def _described(found: Repeatability) -> str:
    return f"How far each touch is off its surface's middle in {found.unit}, by its number."


def _draw(axes: Axes, found: Repeatability) -> None:
    number = np.arange(len(found.touches))
    marked = np.isin(found.touches, found.outliers)
    axes.axhspan(-found.sigma.value, found.sigma.value, color=theme.SKIP_LIGHT, linewidth=0)
    axes.plot(number[~marked], found.off[~marked], "o", color=theme.SKIP, markersize=3.5)
    axes.plot(number[marked], found.off[marked], "x", color=theme.RED, markersize=7)
    axes.set_xlabel("touch")
    axes.set_ylabel(f"off the middle, {found.unit}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
