"""Tables of plain text, and numbers as they stand in them."""

import io
import math
import shutil
import sys
import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:  # loads scipy
    from skiplatch.statistics import Interval

GAP = 2
"""Spaces between columns."""
MOST_WRAPPED = 1000
"""Rows; wrapping takes 0.1 ms a cell, and nobody reads so many on a terminal."""
FINEST = 6  # decimals
NOTHING = "—"
LEAST_COMPACT = 1e-6
LEAST = 1e-9  # what arithmetic leaves of nothing is below
EXACT_DIGITS = 5  # of a number without an interval


def counted(number: float, noun: str) -> str:
    """Give a number of things in words: 1 rig, 2 rigs, 3 touches, 0.5 days."""
    plural = "es" if noun.endswith("ch") else "s"
    return f"{number:.15g} {noun}{'' if number == 1 else plural}"


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Lay out rows under a header: the first column to the left, the others to the right.

    On a terminal, cells wrap so that the table fits; where words would have to be broken, each
    row becomes a list of names and values. Elsewhere a table is as wide as it takes.
    """
    lines, room = [header, *rows], _room()
    text = _plain(lines, str.rjust)
    if len(rows) > MOST_WRAPPED or _width(text) <= room:
        return text
    if _fits_by_words(lines, room):
        return _wrapped(lines, "right", room)
    stripped = [[cell.strip() for cell in row] for row in rows]
    return "\n\n".join(listing(list(zip(header, row, strict=True))) for row in stripped)


def listing(rows: Sequence[Sequence[str]]) -> str:
    """Lay out rows of words without a header, all columns to the left; wraps as a table does."""
    text, room = _plain(rows, str.ljust), _room()
    return text if _width(text) <= room else _wrapped(rows, "left", room)


def prose(text: str) -> str:
    """Break lines between words so that they fit a terminal; elsewhere the text stays as it is.

    What goes on is indented by two spaces more than an indented line.
    """
    room = _room()
    return "\n".join(_broken(line, room) for line in text.split("\n"))


def _broken(line: str, room: int) -> str:
    if len(line) <= room:
        return line
    indent = len(line) - len(line.lstrip())
    further = " " * (indent + GAP if indent else 0)
    return textwrap.fill(
        line,
        room,
        subsequent_indent=further,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _room() -> int:
    """Give how many characters a line may have; a file or a pipe gets the same text everywhere."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize


def _longest_words(lines: Sequence[Sequence[str]]) -> list[int]:
    """Give the least width of each column; names, in the first one, are not parted."""
    names, *columns = zip(*lines, strict=True)
    words = [[word for cell in column for word in cell.split()] for column in columns]
    return [max(map(len, names)), *(max(map(len, some), default=0) for some in words)]


def _fits_by_words(lines: Sequence[Sequence[str]], room: int) -> bool:
    longest = _longest_words(lines)
    return sum(longest) + GAP * (len(longest) - 1) <= room


def _width(text: str) -> int:
    return max(map(len, text.splitlines()), default=0)


def _plain(lines: Sequence[Sequence[str]], side: Callable[[str, int], str]) -> str:
    """Put columns beside one another, the first to the left, the others to that side."""
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    sides = [str.ljust, *[side] * (len(widths) - 1)]
    parts = (
        (put(cell, width) for put, cell, width in zip(sides, line, widths, strict=True))
        for line in lines
    )
    return "\n".join((" " * GAP).join(cells).rstrip() for cells in parts)


def _wrapped(lines: Sequence[Sequence[str]], side: Literal["left", "right"], room: int) -> str:
    """Do the same in lines no longer than `room`."""
    from rich.console import Console  # noqa: PLC0415 - takes time to load
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    grid = Table.grid(padding=(0, GAP, 0, 0), pad_edge=True)
    fits = _fits_by_words(lines, room)
    for i, longest in enumerate(_longest_words(lines)):
        grid.add_column(
            justify=side if i else "left",
            no_wrap=fits and i == 0,
            overflow="fold",
            min_width=longest if fits else None,
        )
    for line in lines:
        grid.add_row(*map(Text, line))
    console = Console(file=io.StringIO(), width=room + GAP, color_system=None)
    with console.capture() as captured:
        console.print(grid)
    return "\n".join(line.rstrip() for line in captured.get().splitlines())


def number(value: float, digits: int = 4) -> str:
    """Give a number with so many significant digits, never as a power of ten: below `LEAST` 0."""
    if abs(value) < LEAST:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{round(value, decimals):,.{max(decimals, 0)}f}".replace(",", " ")


def compact(value: float, digits: int = 4) -> str:
    """Give a number with at most so many significant digits and no zeros at its end.

    Never as a power of ten: what is nearer to 0 than `LEAST_COMPACT` is 0.
    """
    if abs(value) < LEAST_COMPACT:
        return "0"
    decimals = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
    text = f"{float(f'{value:.{digits}g}'):.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def whole(value: int) -> str:
    """Give a whole number, its digits in groups of three."""
    return f"{value:,}".replace(",", " ")


def with_interval(figure: "Interval") -> tuple[str, str]:
    """Give the number, and its interval, with two digits of the interval's width."""
    width = figure.high - figure.low
    if width <= 0.0:
        return number(figure.value, EXACT_DIGITS), NOTHING
    value, low, high = (beside(bound, width) for bound in (figure.value, figure.low, figure.high))
    return value, f"{low} … {high}"


def beside(value: float, width: float) -> str:
    """Give a number with the decimals that two digits of a width above 0 take; no sign for 0."""
    decimals = min(max(1 - math.floor(math.log10(width)), 0), FINEST)
    return f"{round(value, decimals) + 0.0:.{decimals}f}"
