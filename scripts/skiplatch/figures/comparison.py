"""Recorded and simulated distributions of a campaign, a picture for each observable."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes

from skiplatch.arrays import spaced
from skiplatch.campaign import InputPath
from skiplatch.comparison.model import Cell, CellGap, Comparison, feed_words
from skiplatch.comparison.observables import ALL_OBSERVABLES, Observable
from skiplatch.figures import colours, theme
from skiplatch.figures.ecdf import draw_ecdf, label_shares
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.figures.latch_errors import COLORS
from skiplatch.latch.text import TITLES
from skiplatch.tables import number

MOST_FEEDS = 5
ROW_IN = 1.9
HEAD_IN = 1.1
FEWEST_TICKS = 2
PANEL_IN = 2.1


def draw_comparison(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw every observable that was recorded; gives the pictures written."""
    paths = []
    for observable in ALL_OBSERVABLES:
        if pairs := comparison.of(observable):
            paths.append(folder / f"compare_{observable.name}.svg")
            _draw(paths[-1], observable, pairs, comparison.alpha)
    return paths


def shown_feeds(pairs: Sequence[tuple[Cell, CellGap]]) -> list[float]:
    """All feeds, or some of them from the slowest to the fastest where there are many."""
    feeds = sorted({cell.feed_mm_min for cell, _ in pairs})
    return [feeds[i] for i in spaced(len(feeds), MOST_FEEDS)]


def _draw(
    path: Path, observable: Observable, pairs: Sequence[tuple[Cell, CellGap]], alpha: float
) -> None:
    feeds = shown_feeds(pairs)
    rows = sorted({cell.path for cell, _ in pairs})
    words = _words(observable, [gap for _, gap in pairs], alpha)
    with theme.picture(path, words, height_in=HEAD_IN + ROW_IN * len(rows)) as figure:
        panels = figure.subplots(len(rows), len(feeds), squeeze=False)
        for axes in panels.flat:
            axes.set_visible(False)
        for cell, gap in pairs:
            if cell.feed_mm_min in feeds:
                axes = panels[rows.index(cell.path), feeds.index(cell.feed_mm_min)]
                _draw_cell(axes, cell, differs=gap.p_value <= alpha)
        for path_code, axes in zip(rows, panels[:, 0], strict=True):
            axes.set_ylabel(f"{TITLES[path_code]}\nshare up to there")
        figure.supxlabel(
            f"{observable.title}, {observable.unit}: recorded in colour, simulated dashed",
            fontsize=10,
        )


def _draw_cell(axes: Axes, cell: Cell, *, differs: bool) -> None:
    _draw_curves(axes, cell)
    axes.set_visible(True)
    feed = feed_words(cell.feed_mm_min, is_known=cell.is_feed_known, unit=cell.observable.feed_unit)
    axes.set_title(f"{feed}{', differs' if differs else ''}", fontsize=9)
    axes.locator_params(nbins=FEWEST_TICKS, axis="x")
    axes.tick_params(labelsize=8)
    axes.grid(visible=False)


def cell_panel(name: str, cell: Cell, gap: CellGap) -> Drawing:
    """Draw a cell for a page; `name` is unique in the page."""
    with panel(PANEL_IN) as figure:
        axes = figure.subplots()
        _draw_curves(axes, cell)
        axes.locator_params(nbins=4, axis="x")
        axes.set_xlabel(f"{cell.observable.title}, {cell.observable.unit}")
        axes.set_ylabel("share up to there")
    caption = f"{TITLES[gap.path]}, {gap.feed_words}"
    return drawing(figure, name, caption, f"{cell.observable.title}. {_sentence(gap)}")


def _draw_curves(axes: Axes, cell: Cell) -> None:
    color, _ = COLORS[InputPath(cell.path)]
    draw_ecdf(axes, cell.recorded + cell.expected, color=color, lw=2.4)
    simulated = (cell.reference + cell.expected).ravel()
    draw_ecdf(axes, simulated, color=colours.MUTED, lw=1.4, ls=(0, (3, 2)))
    label_shares(axes)


def _words(observable: Observable, gaps: Sequence[CellGap], alpha: float) -> theme.Words:
    differing = [gap for gap in gaps if gap.p_value <= alpha]
    if differing:
        paths = " and ".join(sorted({gap.path.name.lower() for gap in differing}))
        title = f"{observable.title.capitalize()} differs from the simulation: {paths} path"
    else:
        title = f"{observable.title.capitalize()} agrees with the simulation"
    return theme.Words(title, " ".join(_sentence(gap) for gap in gaps))


def _sentence(gap: CellGap) -> str:
    unit = gap.observable.unit
    return (
        f"{TITLES[gap.path]}, {gap.feed_words}: recorded mean "
        f"{number(gap.recorded_mean)} {unit}, simulated {number(gap.simulated_mean)} {unit}, "
        f"distance {number(gap.distance)} {unit}, noise floor {number(gap.noise_floor)} {unit}."
    )
