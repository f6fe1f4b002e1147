"""Tables as spreadsheets write them: many know no UTF-8 unless they are asked for it."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from skiplatch.campaign import KEYS
from skiplatch.campaign.csv_text import MAX_BYTES, UTF8, Row, cells_of, first_lines, read_rows
from skiplatch.errors import InputError
from skiplatch.files import failures_named, refuse_special_or_large
from skiplatch.importing.encodings import encoding_of
from skiplatch.importing.model import Imported

WINDOWS = "cp1252"
MOST_BEFORE_TABLE = 60  # lines of a title, an instrument, an operator
_PLAIN = re.compile(r"[+-]?\d+[.,]?(\d*)$")


IsHead = Callable[[list[str], list[str]], bool]
"""Tells the head of a table by its cells and those of the line after it."""


@dataclass(frozen=True, slots=True)
class Spreadsheet:
    """A table and how it was read.

    Attributes:
        rows: Line number and cells, the head first.
        encoding: That it is in.
        before: Lines before its head, such as a title.
    """

    rows: list[Row]
    encoding: str
    before: int

    def say(self, found: Imported) -> None:
        """Say what the table does not name itself, and what of it was passed over."""
        if self.encoding == WINDOWS:
            found.assumed.append(
                "no UTF-8: letters beyond ASCII were read as Windows-1252 has them"
            )
        if self.before:
            found.unread.append(f"lines before the head of the table: {self.before}")


def read_spreadsheet(path: Path, is_head: IsHead) -> Spreadsheet:
    """Read a table from its head on; where no line is one, from the first line on.

    Raises:
        InputError: It cannot be read or is no table.
    """
    encoding = _encoding(path)
    try:
        lines = first_lines(path, MOST_BEFORE_TABLE, encoding)
        before = _lines_before_head(lines, is_head)
        return Spreadsheet(list(read_rows(path, encoding, after=before)), encoding, before)
    except UnicodeError as error:
        raise InputError(path, None, None, f"neither UTF-8 nor {encoding} text") from error


def _lines_before_head(lines: list[str], is_head: IsHead) -> int:
    filled = [(number, line) for number, line in enumerate(lines) if line.strip()]
    for (number, line), (_, below) in pairwise([*filled, (0, "")]):
        row, next_row = (
            [cell.strip() for cell in cells_of(text, head=line)] for text in (line, below)
        )
        if is_head(row, next_row):
            return number
    return 0


def say_digit(found: Imported, cells: Iterable[str], unit_um: float) -> None:
    """Note the last digit of lengths as the resolution, where it is coarser than is believed.

    Args:
        found: Is told.
        cells: As they stand in the table; what is no number does not count.
        unit_um: Of the table, in µm.
    """
    decimals = [len(number[1]) for cell in cells if (number := _PLAIN.match(cell.strip()))]
    digit_um = unit_um * 10.0 ** -max(decimals, default=0)
    if decimals and digit_um > KEYS["axis", "resolution_um"].default:
        found.figure("axis", "resolution_um", digit_um, "the last digit of the table")


def _encoding(path: Path) -> str:
    with failures_named(path, "read"):
        refuse_special_or_large(path, MAX_BYTES)
        data = path.read_bytes()
    if encoding := encoding_of(data):
        return encoding
    try:
        data.decode(UTF8)
    except UnicodeDecodeError:
        return WINDOWS
    return UTF8
