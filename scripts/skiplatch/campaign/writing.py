"""Writing touches.csv."""

import os
from collections.abc import Collection

from skiplatch.campaign.columns import COLUMNS
from skiplatch.campaign.touches import Touches
from skiplatch.files import atomic_write_text

CHUNK_ROWS = 2_000


def write_touches(path: str | os.PathLike[str], touches: Touches) -> None:
    """Write recorded touches, all columns, rounded to the decimals of the format.

    Raises:
        InputError: The file cannot be written.
        ValueError: There are no touches, or some value is none that the format admits.
    """
    atomic_write_text(path, format_touches(touches))


def format_touches(touches: Touches, names: Collection[str] = tuple(COLUMNS)) -> str:
    """Give the text of touches.csv, or of the named columns of it."""
    _refuse_inadmissible(touches)
    parts = [",".join(names) + "\n"]
    for start in range(0, len(touches), CHUNK_ROWS):
        columns = touches.select(slice(start, start + CHUNK_ROWS)).columns()
        cells = [COLUMNS[name].format(columns[name]) for name in names]
        parts += [",".join(row) + "\n" for row in zip(*cells, strict=True)]
    return "".join(parts)


def _refuse_inadmissible(touches: Touches) -> None:
    if not len(touches):
        raise ValueError("a campaign has at least one touch")
    for name, values in touches.columns().items():
        if not COLUMNS[name].admits(values).all():
            raise ValueError(f"{name}: expected {COLUMNS[name].expected} throughout")
