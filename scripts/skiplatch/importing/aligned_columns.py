"""Tables whose columns are aligned by spaces, two or more of them between any two.

In lines of numbers alone one space will do: there is no head that could hold one.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError
from skiplatch.numbers import NUMBER

_GAP = re.compile(r"\s{2,}")
_NUMBER = re.compile(rf"{NUMBER}|[-+]?[0-9]*,[0-9]+")
"""With a decimal comma too."""
_THOUSANDS = re.compile(r"[-+]?[0-9]{1,3}(?: [0-9]{3})+(?:[.,][0-9]*)?")
"""One number in groups of three digits, which a space parts."""
_ASIDE = re.compile(r"#.*|[-=_ ]*")
"""A comment, a rule, an empty line."""


def without_asides(lines: Sequence[str]) -> list[str]:
    """Give the lines, those that tell nothing empty."""
    return ["" if _ASIDE.fullmatch(line.strip()) else line for line in lines]


def aligned_cells(line: str) -> list[str]:
    """Part a line where it has a gap, one of numbers at any space if it has none."""
    cells = _GAP.split(line.strip())
    if len(cells) > 1 or _THOUSANDS.fullmatch(cells[0]):
        return cells
    words = cells[0].split()
    return words if all(map(_NUMBER.fullmatch, words)) else cells


def aligned_rows(path: Path, lines: Sequence[str], before: int) -> tuple[list[Row], list[str]]:
    """Give the rows, the head first, and the lines below the last one with as many cells.

    Raises:
        InputError: A row between has another number of cells: one of them is empty, or a gap of it
            is too narrow.
    """
    numbered = enumerate(without_asides(lines[before:]), start=before + 1)
    rows = [(number, aligned_cells(line)) for number, line in numbered if line]
    width = len(rows[0][1])
    end = max(i for i, (_, row) in enumerate(rows, start=1) if len(row) == width)
    for line, row in rows[:end]:
        if len(row) != width:
            message = f"expected {width} cells, two spaces or more apart, got {len(row)}"
            raise InputError(path, line, None, message)
    return rows[:end], [" ".join(row) for _, row in rows[end:]]
