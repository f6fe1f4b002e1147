"""Reading a CSV file as rows of cells, with line numbers and within limits."""

import csv
import re
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import TextIO

from skiplatch.errors import InputError
from skiplatch.files import failures_named, refuse_special_or_large

MAX_BYTES = 2 * 2**30
MAX_LINE_CHARACTERS = 65_536

_UNDECODABLE = re.compile("[\udc80-\udcff]")

Row = tuple[int, list[str]]


def read_rows(path: Path) -> Iterator[Row]:
    """Yield the line number and the cells of each row that is not blank.

    A byte order mark and any of the usual line ends are accepted. The line of a row that
    quoted line ends spread over several is its last one.

    Raises:
        InputError: The file cannot be read, is too large, or is no UTF-8 or CSV text.
    """
    with failures_named(path, "read"):
        refuse_special_or_large(path, MAX_BYTES)
        with path.open(encoding="utf-8-sig", newline="") as file:
            yield from _rows(path, file)


def _rows(path: Path, file: TextIO) -> Iterator[Row]:
    reader = csv.reader(_lines(path, file), strict=True)
    try:
        for row in reader:
            if row:
                yield reader.line_num, row
    except csv.Error as error:
        raise InputError(path, reader.line_num, None, f"not valid CSV: {error}") from error
    except UnicodeDecodeError as error:
        raise InputError(path, _undecodable_line(path), None, "not UTF-8 text") from error


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
