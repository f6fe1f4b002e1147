"""A table of runs, whatever its layout was: positions × runs, and where each cell stood."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError

COLUMNS_BY_HEAD: Mapping[str, re.Pattern[str]] = {
    name: re.compile(rf"(?<![^\W\d_])(?:{words})", re.IGNORECASE)
    for name, words in {
        "deviation": "dev|err|abw|fehler",
        "actual": r"actual|meas|ist(?![^\W\d_])|mess",
        "sense": r"sense|sign|dir(?:ection)?(?![^\W\d_])|richtung|sinn",
        "run": r"run|cycle|lauf|zyklus|repe|wiederhol|series|serie|no\.?$|nr\.?$",
        "position": r"pos|target|soll|nominal|ziel",
    }.items()
}
"""Of a list, by the words that begin in their heads; the first that holds counts."""


@dataclass(frozen=True, slots=True, eq=False)
class RunTable:
    """Positions × runs.

    Attributes:
        heads: Of the positions, and of each run.
        rows: The cells below them.
        lines: Where each of these stands in the file.
        in_order: Touches were made in the order of the lines.
    """

    heads: list[str]
    rows: list[list[str]]
    lines: list[list[int]]
    in_order: bool = False

    def without(self, dropped: set[int]) -> "RunTable":
        """Leave columns out."""
        kept = [i for i in range(len(self.heads)) if i not in dropped]
        heads, *rows = ([cells[i] for i in kept] for cells in (self.heads, *self.rows))
        return RunTable(heads, rows, [[own[i] for i in kept] for own in self.lines], self.in_order)


def rectangular(path: Path, rows: list[Row]) -> list[Row]:
    """Give rows that all have as many cells as the first.

    Raises:
        InputError: One has another number.
    """
    width = len(rows[0][1])
    for line, row in rows:
        if len(row) != width:
            raise InputError(path, line, None, f"expected {width} cells, got {len(row)}")
    return rows
