"""Height maps of bCNC, which look like rows of touches but begin with three lines of a head.

These are ``xmin xmax columns``, ``ymin ymax rows`` and ``zmin zmax feed``; the points follow.
"""

import re
from collections.abc import Sequence

from skiplatch.numbers import number

ADVICE = (
    "a height map of bCNC, with one touch of each place: touch one several times; without its "
    "first three lines import csv --map coordinate_mm=3 --axis Z reads it as it is"
)
_HEAD = 3  # lines
_WIDTH = 3  # numbers in each
_COUNT = re.compile(r"[1-9][0-9]{0,5}")


def is_height_map(rows: Sequence[Sequence[str]]) -> bool:
    """Tell a map by its head and the first point, which lies where the head says.

    Args:
        rows: The words of lines that are not blank, from the first line on.
    """
    rows = rows[: _HEAD + 1]
    if len(rows) <= _HEAD or any(len(row) != _WIDTH for row in rows):
        return False
    if not all(_COUNT.fullmatch(row[-1].strip()) for row in rows[:2]):
        return False
    try:
        (x, x_end, _), (y, y_end, _), _, point = ([number(w) for w in row] for row in rows)
    except ValueError:
        return False
    return x < x_end and y < y_end and point[:2] == [x, y]


def words_of(text: str) -> list[list[str]]:
    """Give the words of as many lines as `is_height_map` looks at."""
    begins = (line for line in text.splitlines() if line.strip())
    return [line.split() for line, _ in zip(begins, range(_HEAD + 1), strict=False)]
