"""How all pictures look, in a light and a dark scheme, and how they are written.

A picture is drawn in the colours of the light scheme. The SVG brings a style sheet of its own
that replaces each of them where the reader prefers a dark scheme; what does not know style sheets
shows the light one. Letters are written as outlines, so that no font is needed.
"""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.typing import RcKeyType

from skiplatch.figures.colours import DARK, GRID, INK, MUTED, PAPER
from skiplatch.files import atomic_write_text, failures_named
from skiplatch.undo import make_folders

STYLE: dict[RcKeyType, Any] = {
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "savefig.facecolor": PAPER,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.12,
    "figure.constrained_layout.w_pad": 0.12,
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlecolor": MUTED,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "axes.titlepad": 10,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "lines.solid_capstyle": "round",
    "svg.fonttype": "path",
    "svg.hashsalt": "skiplatch",  # the same picture is the same file
}


@dataclass(frozen=True, slots=True)
class Words:
    """What a picture says.

    Attributes:
        title: Its one message, which stands above it.
        description: What is to be seen, for those who cannot.
    """

    title: str
    description: str


@contextmanager
def picture(path: Path, words: Words, *, height_in: float = 4.6) -> Iterator[Figure]:
    """Give a figure to draw into, and write it as SVG when the block ends well.

    Raises:
        InputError: The file cannot be written.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, height_in))
        figure.suptitle(words.title, x=0.018, ha="left", fontsize=13, fontweight="bold")
        yield figure
        text = as_file(svg_of(figure), words)
    with failures_named(path.parent, "write"):
        make_folders(path.parent)
    atomic_write_text(path, text)


def label(
    axes: Axes,
    text: str,
    at: tuple[float, float],
    color: str,
    *,
    offset: tuple[float, float] = (6.0, 0.0),
    ha: str = "left",
    va: str = "center",
) -> None:
    """Write beside a point; `offset` in points. The ground behind the letters is cleared."""
    axes.annotate(
        text,
        at,
        xytext=offset,
        textcoords="offset points",
        color=color,
        ha=ha,
        va=va,
        fontsize=9.5,
        bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 1.5},
    )


def span(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], *, gap: float = 0.0
) -> None:
    """Draw an arrow with two heads that keeps a gap, in points, to both ends."""
    style = {"arrowstyle": "<->", "color": INK, "shrinkA": gap, "shrinkB": gap}
    axes.annotate("", start, end, arrowprops=style)


def svg_of(figure: Figure) -> str:
    """Draw a figure, in the light scheme; the common style has to be in force."""
    buffer = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    figure.savefig(buffer, format="svg", metadata=nothing)
    return buffer.getvalue()


def as_file(svg: str, words: Words) -> str:
    """Make a file of a drawn figure: with its words, and the dark scheme."""
    head = (
        f'<title id="title">{escape(words.title)}</title>\n'
        f'<desc id="description">{escape(words.description)}</desc>\n'
        f"<style>{_dark_style()}</style>"
    )
    opening = r'\1 role="img" aria-labelledby="title description">\n' + head.replace("\\", r"\\")
    return re.sub(r"(<svg [^>]*)>", opening, svg, count=1)


def _dark_style() -> str:
    rules = [
        f'[style*="{part}: {light}"] {{ {part}: {dark} !important }}'
        for light, dark in DARK.items()
        for part in ("fill", "stroke")
    ]
    return "\n@media (prefers-color-scheme: dark) {\n" + "\n".join(rules) + "\n}\n"
