"""Tables of plain text, and numbers as they stand in them."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # loads scipy
    from skiplatch.statistics import Interval

GAP = "  "
FINEST = 6  # decimals
NOTHING = "—"
LEAST_COMPACT = 1e-6
EXACT_DIGITS = 5  # of a number without an interval


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Lay out rows under a header: the first column to the left, the others to the right."""
    lines = [header, *rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(header))]
    return "\n".join(_line(line, widths) for line in lines)


def number(value: float, digits: int = 4) -> str:
    """Give a number with so many significant digits, never as a power of ten."""
    if value == 0.0:
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
    decimals = min(max(1 - math.floor(math.log10(width)), 0), FINEST)
    value, low, high = (
        _fixed(bound, decimals) for bound in (figure.value, figure.low, figure.high)
    )
    return value, f"{low} … {high}"


def _fixed(value: float, decimals: int) -> str:
    """Give a number with so many decimals, and 0 without a sign."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    first, *others = (
        cell.ljust(width) if i == 0 else cell.rjust(width)
        for i, (cell, width) in enumerate(zip(cells, widths, strict=True))
    )
    return GAP.join([first, *others]).rstrip()
