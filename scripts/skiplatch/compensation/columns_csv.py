"""Reading a small CSV table of which every column is required, for radii, speeds and feeds."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign.column_kinds import CellError, Column, NumberColumn, SerialColumn, Values
from skiplatch.campaign.constraints import LENGTH_UM, POSITIVE, Range
from skiplatch.campaign.csv_text import Row, read_rows
from skiplatch.errors import CampaignWarning, InputError, hint, quoted

MAX_ROWS = 100_000

AZIMUTH = Range("a number from 0 to 360", low=0.0, high=360.0)
ELEVATION = Range("a number from 0 to 90", low=0.0, high=90.0)

ALPHA = NumberColumn(unit="deg", constraint=AZIMUTH, decimals=6, meaning="azimuth of the direction")
BETA = NumberColumn(
    unit="deg",
    constraint=ELEVATION,
    decimals=6,
    meaning="angle of the direction to the plane normal to the probe axis",
)
FEED = NumberColumn(unit="mm/min", constraint=POSITIVE, decimals=4, meaning="measuring feed")
RADIUS = NumberColumn(unit="µm", constraint=LENGTH_UM, decimals=6, meaning="trigger radius")
RUN = SerialColumn(meaning="number of the run")


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """What was read of n rows.

    Attributes:
        path: The file, as the user named it.
        lines: Line number of each row; shape (n,).
        values: By column; each of shape (n,).
    """

    path: Path
    lines: NDArray[np.int64]
    values: Mapping[str, Values]

    def fault(self, row: int, column: str | None, message: str) -> InputError:
        """Give the error that complains of one row, counted from 0."""
        return InputError(self.path, int(self.lines[row]), column, message)


def read_columns(path: Path, columns: Mapping[str, Column]) -> Rows:
    """Read a table; spaces around cells are ignored, and so are blank lines.

    Unknown columns are ignored with a `CampaignWarning`.

    Raises:
        InputError: The file cannot be read, lacks a column, or holds a wrong cell.
    """
    rows = read_rows(path)
    header_line, header = next(rows, (1, []))
    header = [name.strip() for name in header]
    _check_header(path, header_line, header, columns)
    body = _body(path, rows, len(header))
    if not body:
        raise InputError(path, header_line, None, "expected rows after the header, got none")
    lines = np.array([line for line, _ in body], dtype=np.int64)
    cells = {name: [row[header.index(name)].strip() for _, row in body] for name in columns}
    values: dict[str, Values] = {}
    faults: list[InputError] = []
    for name, column in columns.items():
        try:
            values[name] = column.parse(cells[name], required=True)
        except CellError as error:
            faults.append(InputError(path, int(lines[error.index]), name, error.message))
    if faults:
        raise min(faults, key=lambda fault: fault.line or 0)
    return Rows(path, lines, values)


def _check_header(path: Path, line: int, header: list[str], columns: Mapping[str, Column]) -> None:
    if not header:
        raise InputError(path, line, None, "expected a header row, got an empty file")
    for name in header:
        if header.count(name) > 1:
            raise InputError(path, line, None, f"column {quoted(name)} stands twice")
    missing = [quoted(name) for name in columns if name not in header]
    if missing:
        raise InputError(path, line, None, f"missing column {', '.join(missing)}")
    for name in header:
        if name not in columns:
            message = f"unknown column {quoted(name)} is ignored{hint(name, columns)}"
            warnings.warn(CampaignWarning(path, line, None, message), stacklevel=4)


def _body(path: Path, rows: Iterator[Row], width: int) -> list[Row]:
    found: list[Row] = []
    for line, row in rows:
        if len(row) != width:
            raise InputError(path, line, None, f"expected {width} cells, got {len(row)}")
        found.append((line, row))
        if len(found) > MAX_ROWS:
            message = f"more than {MAX_ROWS} rows, which is the most that is read"
            raise InputError(path, line, None, message)
    return found
