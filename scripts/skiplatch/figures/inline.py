"""Pictures inside a page of HTML: they take their colours from the page's own style.

Of several pictures in one page each needs names of its own for the parts it refers to.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.typing import RcKeyType

from skiplatch.figures import colours, theme

WIDTH_IN = 3.7
STYLE: dict[RcKeyType, str | float] = {
    "font.size": 8.5,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "figure.constrained_layout.h_pad": 0.04,
    "figure.constrained_layout.w_pad": 0.04,
}


@dataclass(frozen=True, slots=True)
class Drawing:
    """A picture for a page.

    Attributes:
        caption: What stands below it.
        description: What is to be seen, for those who cannot.
        svg: The picture itself, which carries the description.
        file: The same as a file of its own.
    """

    caption: str
    description: str
    svg: str
    file: str


@contextmanager
def panel(height_in: float, width_in: float = WIDTH_IN) -> Iterator[Figure]:
    """Give a small figure in the common style to draw into."""
    with mpl.rc_context({**theme.STYLE, **STYLE}):
        yield Figure(figsize=(width_in, height_in))


def drawing(figure: Figure, name: str, caption: str, description: str) -> Drawing:
    """Make a page's picture of a figure; `name` is unique in the page."""
    with mpl.rc_context({**theme.STYLE, **STYLE}):
        svg = theme.svg_of(figure)
    file = theme.as_file(svg, theme.Words(caption, description))
    return Drawing(caption, description, _inline(svg, name, description), file)


def _inline(svg: str, name: str, description: str) -> str:
    """Cut the picture out of its file, and give it names and colours of the page."""
    body = svg[svg.index("<svg") :]
    viewbox = re.search(r'viewBox="[^"]*"', body)
    opening = (
        f'<svg role="img" aria-label="{escape(description)}" {viewbox[0] if viewbox else ""}'
        ' xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'
    )
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(r"<svg [^>]*>", lambda _: opening, body, count=1)
    body = re.sub(r'( id="|href="#|url\(#)', rf"\g<1>{name}-", body)
    for variable, colour in colours.VARIABLES.items():
        body = body.replace(colour, f"var(--{variable})")
    return body
