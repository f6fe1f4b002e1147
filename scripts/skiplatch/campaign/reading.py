"""Reading touches.csv and conditions.csv."""

import os
import warnings
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign.column_kinds import NOT_RECORDED, CellError, Column, Values
from skiplatch.campaign.columns import (
    COLUMNS,
    CONDITIONS,
    MEASURED_OUTCOMES,
    REQUIRED_IN_VERSION_1,
    THERMOMETER,
    TIME,
    is_thermometer,
    place_of,
)
from skiplatch.campaign.csv_text import DELIMITERS, Row, read_rows
from skiplatch.campaign.missing import warn_missing
from skiplatch.campaign.nominal import Nominal
from skiplatch.campaign.time_stamps import TIME_NAME, belongs_elsewhere, seconds
from skiplatch.campaign.touches import Touches
from skiplatch.campaign.unsaid_path import unsaid_path
from skiplatch.errors import CampaignWarning, InputError, hint, quoted

MAX_ROWS = 10_000_000
MAX_COLUMNS = 200
CHUNK_ROWS = 2_000  # what the caches hold: larger chunks take twice the time

LineArray = NDArray[np.int64]


def read_touches(
    path: str | os.PathLike[str],
    required: Collection[str] = REQUIRED_IN_VERSION_1,
    nominal: Nominal | None = None,
) -> Touches:
    """Read recorded touches.

    Columns that are absent, but for the required ones, count as empty throughout. Blank lines
    are skipped. Unknown columns are ignored with a `CampaignWarning`.

    Args:
        path: The file.
        required: Columns that have to be there, and no cell of them empty.
        nominal: What is believed of the rig, which tells the path where the touches do not.

    Raises:
        InputError: The file cannot be read, or is no table of touches.
    """
    return _read(Path(path), tuple(COLUMNS), required, nominal)


def read_conditions(
    path: str | os.PathLike[str], required: Collection[str] = REQUIRED_IN_VERSION_1
) -> Touches:
    """Read touches that are to be played: as `read_touches`, but without outcomes.

    A recorded touches.csv will do: its outcomes are not even looked at, and are empty in what is
    returned.

    Args:
        path: The file.
        required: As of `read_touches`.
    """
    return _read(Path(path), CONDITIONS, required)


def _read(
    path: Path,
    wanted: Collection[str],
    required: Collection[str],
    nominal: Nominal | None = None,
) -> Touches:
    rows = read_rows(path)
    header_line, header = next(rows, (1, []))
    header = [name.strip().lower() for name in header]
    positions = _positions(path, header_line, header, wanted, required)
    table = _Table(path, len(header), positions, frozenset(required))
    chunks = [table.parse(chunk) for chunk in _chunks(path, rows)]
    if not chunks:
        raise InputError(path, header_line, None, "expected touches after the header, got none")
    lines = np.concatenate([lines for lines, _ in chunks])
    columns = {name: np.concatenate([part[name] for _, part in chunks]) for name in positions}
    if TIME_NAME in columns:
        columns["time_s"] = seconds(path, lines, columns.pop(TIME_NAME))
    thermometers = {name: columns.pop(name) for name in positions if is_thermometer(name)}
    warmth = {place_of(name): values for name, values in thermometers.items()}
    session = columns.pop("session", None)
    columns["path"] = _paths(path, nominal, columns)
    touches = Touches.from_columns(**columns, session=session, thermometers=warmth)
    _check_serials(path, lines, touches)
    _check_missed(path, lines, touches)
    return touches


def _paths(path: Path, nominal: Nominal | None, columns: Mapping[str, Values]) -> Values:
    """Give the path of each touch, for those too that say none; warns of one that is told."""
    count = len(columns["touch"])
    paths, stamps = (columns.get(n, COLUMNS[n].absent(count)) for n in ("path", "latch_us"))
    unsaid = paths == NOT_RECORDED
    if nominal is None or not unsaid.any():
        return paths
    found, why = unsaid_path(nominal, np.asarray(stamps[unsaid], dtype=float))
    if why:
        warn_missing(path, "path", unsaid, f"taken as {found.name.lower()}, for {why}")
    return np.where(unsaid, np.int8(found), paths)


def _positions(
    path: Path,
    line: int,
    header: list[str],
    wanted: Collection[str],
    required: Collection[str],
) -> dict[str, int]:
    """Give where in a row each wanted column stands, and warn of unknown ones."""
    if not header:
        raise InputError(path, line, None, "expected a header row, got an empty file")
    if len(header) > MAX_COLUMNS:
        raise InputError(path, line, None, f"more than {MAX_COLUMNS} columns")
    for name, times in Counter(header).items():
        if name and times > 1:
            raise InputError(path, line, None, f"column {quoted(name)} stands {times} times")
    stands_for_time = TIME_NAME in header and "time_s" not in header
    missing = [
        quoted(name)
        for name in required
        if name not in header and not (name == "time_s" and stands_for_time)
    ]
    if missing:
        raise InputError(path, line, None, f"missing column {', '.join(missing)}")
    read = [name for name in header if name in wanted or is_thermometer(name)]
    if stands_for_time:
        read.append(TIME_NAME)
    for name in header:
        if name not in COLUMNS and name not in read:
            message = f"unknown column {quoted(name)} is ignored{hint(name, COLUMNS)}"
            warnings.warn(CampaignWarning(path, line, None, message), stacklevel=4)
    return {name: header.index(name) for name in read}


def _chunks(path: Path, rows: Iterator[Row]) -> Iterator[list[Row]]:
    total = 0
    while chunk := list(islice(rows, CHUNK_ROWS)):
        total += len(chunk)
        if total > MAX_ROWS:
            message = f"more than {MAX_ROWS} touches, which is the most that is read"
            raise InputError(path, None, None, message)
        yield chunk


@dataclass(frozen=True, slots=True)
class _Table:
    """How the rows of a file are read.

    Attributes:
        path: The file.
        width: Cells of a row.
        positions: Where in a row each column stands that is read.
        required: Columns of which no cell may be empty.
    """

    path: Path
    width: int
    positions: Mapping[str, int]
    required: frozenset[str]

    def parse(self, chunk: list[Row]) -> tuple[LineArray, dict[str, Values]]:
        """Give the line of each row and the values of each column, or complain of the first row."""
        for line, row in chunk:
            if len(row) != self.width:
                message = f"expected {self.width} cells, got {len(row)}{_other_delimiter(row)}"
                raise InputError(self.path, line, None, message)
        lines = [line for line, _ in chunk]
        cells = list(zip(*(row for _, row in chunk), strict=True))
        values: dict[str, Values] = {}
        errors: list[InputError] = []
        for name, position in self.positions.items():
            try:
                is_required = name in self.required
                values[name] = _column(name).parse(cells[position], required=is_required)
            except CellError as error:
                elsewhere = belongs_elsewhere(name, cells[position][error.index])
                line = lines[error.index]
                errors.append(InputError(self.path, line, name, error.message + elsewhere))
        if errors:
            raise min(errors, key=lambda error: error.line or 0)
        return np.array(lines), values


def _column(name: str) -> Column:
    if name == TIME_NAME:
        return TIME
    return THERMOMETER if is_thermometer(name) else COLUMNS[name]


def _other_delimiter(row: list[str]) -> str:
    """Say what a row has between its columns that the header has not."""
    found = [d for d in DELIMITERS[1:] if any(d in cell for cell in row)]
    return f"; this file uses {found[0].replace(chr(9), 'tabs')} between columns" if found else ""


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
