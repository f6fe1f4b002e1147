"""Reading a CSV file as rows of cells, with line numbers and within limits."""

import csv
import re
from collections.abc import Callable, Iterable, Iterator
from itertools import chain, count, islice
from pathlib import Path
from typing import TextIO

from skiplatch.errors import InputError, quoted
from skiplatch.files import failures_named, refuse_special_or_large

MAX_BYTES = 2 * 2**30
MAX_LINE_CHARACTERS = 65_536

DELIMITERS = (",", ";", "\t")
UTF8 = "utf-8-sig"

_SEPARATOR = re.compile(r"sep=([,;\t])\s*$", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"\s*[-+]?[0-9]*,[0-9]+([eE][-+]?[0-9]+)?\s*")
_BETWEEN_DIGITS = re.compile(r"(?<=[0-9]),(?=[0-9])")
_GROUPED = re.compile(r"\s*[-+]?[0-9]{1,3}(?:[.'\u2019\u00a0\u202f][0-9]{3})+,[0-9]+\s*")
"""1.000,5: with a decimal comma behind it, what stands before each three digits parts groups."""
_EITHER = re.compile(r"\s*[-+]?[1-9][0-9]{0,2}\.[0-9]{3}\s*")
"""1.200: beside decimal commas it may be 1200 as well as 1.2."""
_UNDECODABLE = re.compile("[\udc80-\udcff]")

Row = tuple[int, list[str]]


def _with_points(path: Path, rows: Iterable[Row]) -> Iterator[Row]:
    """Turn each decimal comma into a point, and 1.000,5 into 1000.5; refuse 1.200 beside them."""
    has_commas, doubt = False, None
    for line, row in rows:
        has_commas = has_commas or any(map(_DECIMAL_COMMA.fullmatch, row))
        doubt = doubt or _doubt(path, line, row)
        if has_commas and doubt:
            raise doubt
        yield line, [_with_point(cell) for cell in row]


def _doubt(path: Path, line: int, row: list[str]) -> InputError | None:
    """Give what is to be said of the first 1.200 in a row."""
    for column, cell in enumerate(row, start=1):
        if _EITHER.fullmatch(cell):
            whole, parts = (cell.strip().replace(".", mark) for mark in ("", ","))
            message = f"{quoted(cell)} may be {whole} or {parts}, as other numbers have commas"
            return InputError(path, line, f"column {column}", message)
    return None


def read_rows(
    path: Path,
    encoding: str = UTF8,
    *,
    after: int = 0,
    in_points: Callable[[Iterable[Row]], Iterable[Row]] | None = None,
) -> Iterator[Row]:
    """Yield the line number and the cells of each row that is not blank.

    A byte order mark and any of the usual line ends are accepted, and semicolons or tabs between
    the columns, then with decimal commas. Lines that begin with # are comments. The line of a row
    that quoted line ends spread over several is its last one. `after` lines are passed over first.
    `in_points` gives the numbers decimal points; without it, where no commas stand between columns.

    Raises:
        InputError: The file cannot be read, is too large, or is no CSV text in that encoding.
    """
    with failures_named(path, "read"):
        refuse_special_or_large(path, MAX_BYTES)
        with path.open(encoding=encoding, newline="") as file:
            yield from _rows(path, file, after, in_points)


def first_lines(path: Path, most: int, encoding: str = UTF8) -> list[str]:
    """Give up to so many lines from the beginning.

    Raises:
        InputError: The file cannot be read, is too large, or is no text in that encoding.
    """
    with failures_named(path, "read"):
        refuse_special_or_large(path, MAX_BYTES)
        try:
            with path.open(encoding=encoding, newline="") as file:
                return list(islice(_lines(path, file), most))
        except UnicodeDecodeError as error:
            raise InputError(path, _undecodable_line(path), None, "not UTF-8 text") from error


def cells_of(line: str, head: str) -> list[str]:
    """Give the cells of a line for itself, parted by what parts those of the head."""
    try:
        return next(csv.reader([line], delimiter=delimiter_of(head)), [])
    except csv.Error:
        return []


def _rows(
    path: Path,
    file: TextIO,
    after: int,
    in_points: Callable[[Iterable[Row]], Iterable[Row]] | None,
) -> Iterator[Row]:
    try:
        lines = _lines(path, file)
        for _ in islice(lines, after):
            pass
        lead = _lead(lines)
        delimiter = delimiter_of(lead[-1] if lead else "")
        rows = _parsed(path, chain(lead, lines), delimiter, after)
        if in_points:
            yield from _in_points(list(rows), delimiter, in_points)
        else:
            yield from rows if delimiter == "," else _with_points(path, rows)
    except UnicodeDecodeError as error:
        raise InputError(path, _undecodable_line(path), None, "not UTF-8 text") from error


def _in_points(
    rows: list[Row], delimiter: str, in_points: Callable[[Iterable[Row]], Iterable[Row]]
) -> Iterable[Row]:
    """Turn decimal marks into points; where no cell has a comma beside ones between, they are."""
    has_commas = delimiter != "," or any("," in cell for _, row in rows for cell in row)
    return in_points(rows) if has_commas else rows


def _parsed(path: Path, lines: Iterator[str], delimiter: str, after: int) -> Iterator[Row]:
    reader = csv.reader(lines, strict=True, delimiter=delimiter)
    try:
        for row in reader:
            if row and not _is_aside(row):
                yield after + reader.line_num, row
    except csv.Error as error:
        raise InputError(path, after + reader.line_num, None, f"not valid CSV: {error}") from error


def _lead(lines: Iterator[str]) -> list[str]:
    """Take the lines up to the first that is neither blank nor a comment."""
    lead = []
    for line in lines:
        lead.append(line)
        if line.strip() and not line.lstrip().startswith("#"):
            break
    return lead


def delimiter_of(line: str) -> str:
    """Give what stands between the columns; spreadsheets may say so in a line of its own."""
    if match := _SEPARATOR.match(line):
        return match[1]
    if any(mark in line for mark in DELIMITERS[1:]):
        line = _BETWEEN_DIGITS.sub("", line)  # of numbers in the head, as of positions
    return max(DELIMITERS, key=line.count)


def _is_aside(row: list[str]) -> bool:
    """Tell whether a row is a comment, or says what stands between the columns."""
    return row[0].lstrip().startswith("#") or row[0].lower() == "sep="


def _with_point(cell: str) -> str:
    if _GROUPED.fullmatch(cell):
        cell = re.sub(r"[^-+0-9,]", "", cell)
    return cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell


def _lines(path: Path, file: TextIO) -> Iterator[str]:
    for number in count(1):
        line = file.readline(MAX_LINE_CHARACTERS + 1)
        if len(line) > MAX_LINE_CHARACTERS:
            message = f"line of more than {MAX_LINE_CHARACTERS} characters"
            raise InputError(path, number, None, message)
        if not line:
            return
        yield line


def _undecodable_line(path: Path) -> int | None:
    with path.open(encoding="utf-8", errors="surrogateescape", newline="") as file:
        return next((n for n, line in enumerate(file, 1) if _UNDECODABLE.search(line)), None)
