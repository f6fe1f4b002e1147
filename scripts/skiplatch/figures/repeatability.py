"""Deviations of repeated touches, one after the other."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from skiplatch.figures import colours, theme
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.repeatability import Repeatability
from skiplatch.repeatability_words import OfPath

BAND = "band: ±σ; crosses: outliers"
WIDE_IN, HIGH_IN = 4.6, 2.4
PICTURE_IN = 3.6


def draw_repeatability(file: Path, shown: Sequence[OfPath]) -> None:
    """Draw what is left without middles and feeds, outliers marked; a panel each input path."""
    described = " ".join(f"{_described(one.found)} {one.sentence}" for one in shown)
    words = theme.Words(title="; ".join(map(_title, shown)), description=described)
    with theme.picture(file, words, height_in=PICTURE_IN * len(shown)) as figure:
        panels = figure.subplots(len(shown), squeeze=False).flat
        for axes, one in zip(panels, shown, strict=True):
            _draw(axes, one.found)
            axes.set_title(f"{one.title}; {BAND}" if one.title else BAND)


def _title(one: OfPath) -> str:
    found = one.found
    title = f"{len(found.touches)} touches, σ = {found.sigma.value:.3g} {found.unit}"
    return f"{one.title}: {title}" if one.title else title


def repeatability_panel(name: str, one: OfPath) -> Drawing:
    """Draw the same for a page; `name` is unique in the page."""
    with panel(HIGH_IN, WIDE_IN) as figure:
        _draw(figure.subplots(), one.found)
    caption = f"Each touch in its turn; {BAND}"
    return drawing(figure, name, caption, f"{_described(one.found)} {one.sentence}")


def _described(found: Repeatability) -> str:
    return f"How far each touch is off its surface's middle in {found.unit}, by its number."


def _draw(axes: Axes, found: Repeatability) -> None:
    number = np.arange(len(found.touches))
    marked = np.isin(found.touches, found.outliers)
    axes.axhspan(-found.sigma.value, found.sigma.value, color=colours.SKIP_LIGHT, linewidth=0)
    axes.plot(number[~marked], found.off[~marked], "o", color=colours.SKIP, markersize=3.5)
    axes.plot(number[marked], found.off[marked], "x", color=colours.RED, markersize=7)
    axes.set_xlabel("touch")
    axes.set_ylabel(f"off the middle, {found.unit}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
