"""Reading touches.csv and conditions.csv."""

import os
import warnings
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign.column_kinds import CellError, Values
from skiplatch.campaign.columns import COLUMNS, CONDITIONS, MEASURED_OUTCOMES, REQUIRED
from skiplatch.campaign.csv_text import Row, read_rows
from skiplatch.campaign.touches import Touches
from skiplatch.errors import CampaignWarning, InputError, hint, quoted

MAX_ROWS = 10_000_000
MAX_COLUMNS = 200
CHUNK_ROWS = 2_000  # what the caches hold: larger chunks take twice the time

LineArray = NDArray[np.int64]


def read_touches(path: str | os.PathLike[str]) -> Touches:
    """Read recorded touches.

    Columns that are absent, but for the required ones, count as empty throughout. Blank lines
    are skipped. Unknown columns are ignored with a `CampaignWarning`.

    Raises:
        InputError: The file cannot be read, or is no table of touches.
    """
    return _read(Path(path), tuple(COLUMNS))


def read_conditions(path: str | os.PathLike[str]) -> Touches:
    """Read touches that are to be played: as `read_touches`, but without outcomes.

    A recorded touches.csv will do: its outcomes are not even looked at, and are empty in what is
    returned.
    """
    return _read(Path(path), CONDITIONS)


def _read(path: Path, wanted: Collection[str]) -> Touches:
    rows = read_rows(path)
    header_line, header = next(rows, (1, []))
    positions = _positions(path, header_line, header, wanted)
    chunks = [_parse(path, chunk, len(header), positions) for chunk in _chunks(path, rows)]
    if not chunks:
        raise InputError(path, header_line, None, "expected touches after the header, got none")
    lines = np.concatenate([lines for lines, _ in chunks])
    columns = {name: np.concatenate([part[name] for _, part in chunks]) for name in positions}
    touches = Touches.from_columns(**columns)
    _check_serials(path, lines, touches)
    _check_missed(path, lines, touches)
    return touches


def _positions(path: Path, line: int, header: list[str], wanted: Collection[str]) -> dict[str, int]:
    """Give where in a row each wanted column stands, and warn of unknown ones."""
    if not header:
        raise InputError(path, line, None, "expected a header row, got an empty file")
    if len(header) > MAX_COLUMNS:
        raise InputError(path, line, None, f"more than {MAX_COLUMNS} columns")
    for name, times in Counter(header).items():
        if name and times > 1:
            raise InputError(path, line, None, f"column {quoted(name)} stands {times} times")
    missing = [quoted(name) for name in REQUIRED if name not in header]
    if missing:
        raise InputError(path, line, None, f"missing column {', '.join(missing)}")
    for name in header:
        if name not in COLUMNS:
            message = f"unknown column {quoted(name)} is ignored{hint(name, COLUMNS)}"
            warnings.warn(CampaignWarning(path, line, None, message), stacklevel=4)
    return {name: header.index(name) for name in wanted if name in header}


def _chunks(path: Path, rows: Iterator[Row]) -> Iterator[list[Row]]:
    total = 0
    while chunk := list(islice(rows, CHUNK_ROWS)):
        total += len(chunk)
        if total > MAX_ROWS:
            message = f"more than {MAX_ROWS} touches, which is the most that is read"
            raise InputError(path, None, None, message)
        yield chunk


def _parse(
    path: Path, chunk: list[Row], width: int, positions: Mapping[str, int]
) -> tuple[LineArray, dict[str, Values]]:
    """Give the line of each row and the values of each column, or complain of the first row."""
    for line, row in chunk:
        if len(row) != width:
            raise InputError(path, line, None, f"expected {width} cells, got {len(row)}")
    lines = [line for line, _ in chunk]
    cells = list(zip(*(row for _, row in chunk), strict=True))
    values: dict[str, Values] = {}
    errors: list[InputError] = []
    for name, position in positions.items():
        try:
            values[name] = COLUMNS[name].parse(cells[position])
        except CellError as error:
            errors.append(InputError(path, lines[error.index], name, error.message))
    if errors:
        raise min(errors, key=lambda error: error.line or 0)
    return np.array(lines), values


def _check_serials(path: Path, lines: LineArray, touches: Touches) -> None:
    order = np.argsort(touches.touch, kind="stable")
    repeats = np.flatnonzero(np.diff(touches.touch[order]) == 0)
    if repeats.size:
        pair = min(repeats, key=lambda i: order[i + 1])
        first, second = order[pair], order[pair + 1]
        message = f"serial number {touches.touch[second]} stands already in line {lines[first]}"
        raise InputError(path, int(lines[second]), "touch", message)


def _check_missed(path: Path, lines: LineArray, touches: Touches) -> None:
    wrong = np.flatnonzero(touches.missed & touches.measured)
    if wrong.size:
        row = wrong[0]
        name = next(n for n in MEASURED_OUTCOMES if not np.isnan(getattr(touches, n)[row]))
        (cell,) = COLUMNS[name].format(getattr(touches, name)[row : row + 1])
        message = f"expected an empty cell in a missed touch, got {quoted(cell)}"
        raise InputError(path, int(lines[row]), name, message)
