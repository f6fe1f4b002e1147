"""Recorded centres of a sphere: ``POINTS.csv``."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign.csv_text import Row, read_rows
from skiplatch.errors import InputError, hint, quoted
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.numbers import number

POSITION_COLUMNS = ("x_mm", "y_mm", "z_mm")
APPROACH, RADIUS = TOLD_COLUMNS = ("approach", "radius_mm")
"""Columns that a file may have besides."""
LARGEST = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Where a sphere was found.

    Attributes:
        angles_deg: Shape (n, axes), in the order of the machine's axes.
        positions_mm: Shape (n, 3), what the linear axes read at the sphere's centre.
        approach: 1 or -1 for the sense in which the axis came, 0 as it came; shape (n,), or None.
        radius_mm: The sphere's radius as measured, shape (n,), or None.
    """

    angles_deg: NDArray[np.float64]
    positions_mm: NDArray[np.float64]
    approach: NDArray[np.int64] | None = None
    radius_mm: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        return len(self.positions_mm)


def angle_column(letter: str) -> str:
    """Name the column with the angles of an axis."""
    return f"{letter.lower()}_deg"


def columns_of(machine: Machine) -> tuple[str, ...]:
    """Name the columns that the points of a machine have."""
    return (*(angle_column(letter) for letter in machine.letters), *POSITION_COLUMNS)


def read_positions(path: Path) -> NDArray[np.float64]:
    """Read points in space, shape (n, 3) in mm; columns may stand in any order, with others.

    Raises:
        InputError: The file cannot be read, a column is missing, or a value is no finite number.
    """
    return read_columns(path, POSITION_COLUMNS)[1]


def read_columns(path: Path, wanted: Sequence[str]) -> tuple[list[int], NDArray[np.float64]]:
    """Read columns of numbers; they may stand in any order, with others.

    Returns:
        The line of each row, and the numbers, shape (n, wanted).

    Raises:
        InputError: The file cannot be read, a column is missing, or a value is no finite number.
    """
    rows = read_rows(path)
    line, names = _header(path, rows)
    places = _places_of(path, line, names, wanted)
    lines, values = [], []
    for row_line, cells in rows:
        lines.append(row_line)
        values.append(_values(path, row_line, cells, len(names), wanted, places))
    return lines, np.array(values).reshape(-1, len(wanted))


def read_points(path: Path, machine: Machine) -> Points:
    """Read the centres; columns may stand in any order, and foreign ones are not looked at.

    Raises:
        InputError: The file cannot be read, a column is missing or of an axis that the machine
            does not have, or a value is no finite number.
    """
    rows = read_rows(path)
    line, names = _header(path, rows)
    places = _places(path, line, names, machine)
    told = [name for name in TOLD_COLUMNS if name in names]
    wanted = (*columns_of(machine), *told)
    places += [names.index(name) for name in told]
    values = np.array(
        [_values(path, row_line, cells, len(names), wanted, places) for row_line, cells in rows]
    ).reshape(-1, len(wanted))
    count = len(machine.axes)
    more = dict(zip(told, values[:, count + 3 :].T, strict=True))
    approach = more.get(APPROACH)
    return Points(
        values[:, :count],
        values[:, count : count + 3],
        None if approach is None else approach.astype(np.int64),
        more.get(RADIUS),
    )


def _header(path: Path, rows: Iterator[Row]) -> tuple[int, list[str]]:
    line, header = next(rows, (None, []))
    if line is None:
        raise InputError(path, None, None, "empty; expected a header and a row for each position")
    return line, [name.strip() for name in header]


def _places(path: Path, line: int, names: Sequence[str], machine: Machine) -> list[int]:
    for letter in LETTERS:
        name = angle_column(letter)
        if name in names and letter not in machine.letters:
            raise InputError(path, line, name, f"the machine has no axis {letter}")
    return _places_of(path, line, names, columns_of(machine))


def _places_of(path: Path, line: int, names: Sequence[str], wanted: Sequence[str]) -> list[int]:
    for name in wanted:
        if name not in names:
            raise InputError(path, line, name, f"column missing{_near(name, names)}")
        if names.count(name) > 1:
            raise InputError(path, line, name, "the column stands here twice")
    return [names.index(name) for name in wanted]


def _near(name: str, names: Sequence[str]) -> str:
    return f"; is it {quoted(names[0])}?" if len(names) == 1 else hint(name, names)


def _values(
    path: Path,
    line: int,
    cells: Sequence[str],
    count: int,
    wanted: Sequence[str],
    places: Sequence[int],
) -> list[float]:
    if len(cells) != count:
        raise InputError(path, line, None, f"expected {count} cells, got {len(cells)}")
    return [_value(path, line, name, cells[i]) for name, i in zip(wanted, places, strict=True)]


def _value(path: Path, line: int, name: str, cell: str) -> float:
    try:
        value = number(cell)
    except ValueError:
        value = math.nan
    if name == APPROACH and value not in (-1.0, 0.0, 1.0):
        raise InputError(path, line, name, f"expected 1, -1 or 0, got {quoted(cell)}")
    if not abs(value) <= LARGEST:
        unit = name.rpartition("_")[2]
        message = f"expected a number in {unit}, at most {LARGEST:g}, got {quoted(cell)}"
        raise InputError(path, line, name, message)
    return value
