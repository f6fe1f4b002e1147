"""Tables as spreadsheets write them: many know no UTF-8 unless they are asked for it."""

import re
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from skiplatch.campaign import KEYS
from skiplatch.campaign.column_kinds import NumberColumn, tidy
from skiplatch.campaign.constraints import INSTANT_US
from skiplatch.campaign.csv_text import MAX_BYTES, Row, cells_of, first_lines, read_rows
from skiplatch.errors import InputError, quoted
from skiplatch.files import failures_named, refuse_special_or_large
from skiplatch.importing.aligned_columns import aligned_cells, aligned_rows, without_asides
from skiplatch.importing.decimal_marks import Marks
from skiplatch.importing.encodings import (
    IS_WINDOWS,
    WINDOWS,
    encoding_of,
    refuse_no_text,
    unmarked_encoding,
)
from skiplatch.importing.markdown_tables import is_markdown, markdown_rows
from skiplatch.importing.model import Imported
from skiplatch.importing.named_lines import NAMED
from skiplatch.importing.words_of_lines import is_of_words, word_table

MOST_BEFORE_TABLE = 60  # lines of a title, an instrument, an operator
_PLAIN = re.compile(r"[+-]?[0-9]+[.,]?([0-9]*)$")
_WORD = re.compile(r"\s*[^\W\d_]")
WORKED_OUT = re.compile(
    r"(?<![^\W\d_])(?:mean|average|mittel|median|std|stand(?:ard)?[ _]?(?:dev|abw)|sigma|range"
    r"|spann|reversal|umkehr|backlash|hyster|repeatab|wiederhol|accura|genau|(?:min|max)(?:imum)?"
    r"(?![^\W\d_]))|σ|x\u0304",
    re.IGNORECASE,
)
"""Heads of columns and of rows that a spreadsheet works out of the others."""

ANY_NUMBER = NumberColumn(constraint=INSTANT_US, decimals=9, meaning="any number")
"""Of a table in its own unit; what it may be in that of a campaign is looked at when it is written.
"""

IsHead = Callable[[list[str], list[str]], bool]
"""Tells the head of a table by its cells and those of the line after it."""


@dataclass(frozen=True, slots=True)
class Spreadsheet:
    """A table and how it was read.

    Attributes:
        rows: Line number and cells, the head first.
        encoding: That it is in.
        title: Lines before its head.
        marks: Of decimals and of thousands.
        below: Lines below it that have not its shape, where these are known apart.
    """

    rows: list[Row]
    encoding: str
    title: list[str]
    marks: Marks
    below: Sequence[str] = ()

    def say(self, found: Imported) -> None:
        """Say what the table does not name itself, and what of it was passed over."""
        if self.encoding == WINDOWS:
            found.assumed.append(IS_WINDOWS)
        if self.marks.thousands:
            first = self.marks.thousands[0]
            whole = first.replace(".", "").replace(",", "")
            found.assumed.append(f"thousands are parted: {quoted(first)} was read as {whole}")
        if self.title:
            found.unread.append(f"lines before the head of the table: {len(self.title)}")
        if self.below:
            found.unread.append(_said_below(self.below))


def read_spreadsheet(path: Path, is_head: IsHead) -> Spreadsheet:
    """Read a table from its head on; where no line is one, from the first line on.

    Raises:
        InputError: It cannot be read or is no table.
    """
    encoding = _encoding(path)
    try:
        lines = first_lines(path, MOST_BEFORE_TABLE, encoding)
        if is_markdown(lines):
            return _of_markdown(path, encoding)
        if (before := _lines_before_head(lines, is_head)) is not None:
            return _of_cells(path, encoding, before)
        if (before := _before_aligned_head(lines, is_head)) is not None:
            return _aligned(path, encoding, before)
        return _of_words(path, encoding) if is_of_words(lines) else _of_cells(path, encoding, 0)
    except UnicodeError as error:
        raise InputError(path, None, None, f"neither UTF-8 nor {encoding} text") from error


def _of_cells(path: Path, encoding: str, before: int) -> Spreadsheet:
    title, marks = first_lines(path, before, encoding), Marks()
    rows = list(read_rows(path, encoding, after=before, in_points=marks.with_points))
    return Spreadsheet(rows, encoding, title, marks)


def _of_markdown(path: Path, encoding: str) -> Spreadsheet:
    lines, marks = first_lines(path, sys.maxsize, encoding), Marks()
    before, rows = markdown_rows(path, lines)
    return Spreadsheet(marks.with_points(rows), encoding, lines[:before], marks)


def _aligned(path: Path, encoding: str, before: int) -> Spreadsheet:
    lines, marks = first_lines(path, sys.maxsize, encoding), Marks()
    rows, below = aligned_rows(path, lines, before)
    return Spreadsheet(marks.with_points(rows), encoding, lines[:before], marks, below)


def _of_words(path: Path, encoding: str) -> Spreadsheet:
    """Read a table of words; commas in its numbers are decimal ones or of thousands."""
    table, marks = word_table(path, first_lines(path, sys.maxsize, encoding)), Marks()
    has_commas = any("," in cell for _, row in table.rows for cell in row)
    rows = marks.with_points(table.rows) if has_commas else table.rows
    return Spreadsheet(rows, encoding, table.before, marks, table.below)


def _lines_before_head(
    lines: list[str], is_head: IsHead, parted: Callable[[str, str], list[str]] = cells_of
) -> int | None:
    """Give how many lines are above the head; None where no line is one."""
    filled = [(number, line) for number, line in enumerate(lines) if line.strip()]
    for (number, line), (_, below) in pairwise([*filled, (0, "")]):
        row, next_row = ([cell.strip() for cell in parted(text, line)] for text in (line, below))
        if is_head(row, next_row):
            return number
    return None


def _before_aligned_head(lines: list[str], is_head: IsHead) -> int | None:
    """Give the same of a table whose columns are aligned by spaces, a head and a row alike."""

    def is_aligned(row: list[str], below: list[str]) -> bool:
        return len(row) == len(below) > 1 and is_head(row, below)

    telling = without_asides(lines)
    return _lines_before_head(telling, is_aligned, lambda text, _: aligned_cells(text))


def tells(cell: str) -> bool:
    """Tell whether something stands in a cell, and no "n/a"."""
    return bool(tidy(cell))


def begins_with_a_word(row: list[str]) -> bool:
    """Tell whether the first cell of a row that is not empty begins with a letter."""
    return _is_word(_first_cell(row))


def without_lines_below(body: list[Row], found: Imported) -> list[Row]:
    """Leave out lines below a table that have not its shape, such as means, and say which.

    They begin with a word where the rows above them have none, or with that for a mean.
    """
    end = _end(body, begins_with_a_word)
    above = {i for _, row in body[:end] for i, cell in enumerate(row) if _is_word(cell)}
    first = [row.index(cell) for _, row in body[end:] if (cell := _first_cell(row))]
    if end == 0 or above.intersection(first):
        end = _end(body, lambda row: bool(WORKED_OUT.match(_first_cell(row).strip())))
    if 0 < end < len(body):
        found.unread.append(
            _said_below([cell.strip() for _, row in body[end:] if (cell := _first_cell(row))])
        )
        return body[:end]
    return body


def _said_below(below: Sequence[str]) -> str:
    named = ", ".join(quoted(text) for text in below[:NAMED])
    return f"lines below the table: {len(below)}, {named}"


def _end(body: list[Row], is_below: Callable[[list[str]], bool]) -> int:
    """Give how many rows there are without those below, and without empty ones before these."""
    end = rows = len(body)
    while rows and (is_below(body[rows - 1][1]) or not _first_cell(body[rows - 1][1])):
        rows -= 1
        end = rows if is_below(body[rows][1]) else end
    return end


def _first_cell(row: list[str]) -> str:
    return next((cell for cell in row if cell.strip()), "")


def _is_word(cell: str) -> bool:
    return bool(_WORD.match(cell)) and tells(cell)


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
    refuse_no_text(path, data)
    return unmarked_encoding(data)
