"""Deviations of repeated touches, one after the other."""

from pathlib import Path

import numpy as np

from skiplatch.figures import theme
from skiplatch.repeatability import Repeatability


def draw_repeatability(path: Path, found: Repeatability, sentence: str) -> None:
    """Draw what is left without middles and feeds, outliers marked."""
    words = theme.Words(
        title=f"{len(found.touches)} touches, σ = {found.sigma.value:.3g} µm",
        description=f"Deviation in µm of each touch from its surface's middle, by its number. "
        f"{sentence}",
    )
    number = np.arange(len(found.touches))
    marked = np.isin(found.touches, found.outliers)
    with theme.picture(path, words, height_in=3.6) as figure:
        axes = figure.subplots()
        axes.axhspan(-found.sigma.value, found.sigma.value, color=theme.SKIP_LIGHT, linewidth=0)
        axes.plot(number[~marked], found.off_um[~marked], "o", color=theme.SKIP, markersize=3.5)
        axes.plot(number[marked], found.off_um[marked], "x", color=theme.RED, markersize=7)
        axes.set_xlabel("touch")
        axes.set_ylabel("deviation, µm")
        axes.set_title("band: ±σ; crosses: outliers")
