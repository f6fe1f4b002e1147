"""A table as ISO 230-2 has it: positions × runs × senses, deviations in µm.

The first column holds the positions in mm. Each further column is a run; its head says the sense:
an arrow, ``+`` or ``-``, ``up``/``down``, ``forward``/``reverse`` or ``positive``/``negative``. A
head that says none is a run in the positive sense.
"""

import re
from pathlib import Path

import numpy as np

from skiplatch.campaign import Axis, Touches
from skiplatch.errors import InputError, quoted
from skiplatch.importing.model import Imported
from skiplatch.importing.spreadsheets import read_spreadsheet, say_digit, say_encoding
from skiplatch.units import UM_PER_MM

_NEGATIVE = re.compile(r"↓|←|-|−|\bdown\b|\brev|\bneg|\bback", re.IGNORECASE)
ARCSEC_PER_MILLIDEGREE = 3.6  # a degree counts as a millimetre


def read_iso230(path: Path, axis: str, *, in_mm: bool, feed: float | None) -> Imported:
    """Read the table.

    Args:
        path: The table.
        axis: The axis it is of.
        in_mm: Whether deviations are in mm rather than µm.
        feed: In mm/min.

    Raises:
        InputError: It cannot be read or is no such table.
    """
    rows, encoding = read_spreadsheet(path)
    if len(rows) < 2 or len(rows[0][1]) < 2:
        expected = "expected positions in the first column and a run in each further one"
        raise InputError(path, None, None, expected)
    heads = [head.strip() for head in rows[0][1][1:]]
    signs = np.array([-1.0 if _NEGATIVE.search(head) else 1.0 for head in heads])
    positions, deviations = _numbers(path, rows[1:], len(heads))
    unit = UM_PER_MM if in_mm else 1.0
    order = np.array(
        [(p, run) for run in range(len(heads)) for p in _course(run, signs, positions)]
    )
    point, run = order[:, 0], order[:, 1]
    known = ~np.isnan(deviations[point, run])
    point, run = point[known], run[known]
    turns = axis in "ABC"
    cells = (cell for _, row in rows[1:] for cell in row[1:])
    place, beyond = positions[point], deviations[point, run] * unit * signs[run]
    found = Imported(preset="plc-4ms")
    say_encoding(found, encoding)
    say_digit(found, cells, unit / ARCSEC_PER_MILLIDEGREE if turns else unit)
    columns: dict[str, np.typing.NDArray[np.generic]] = {
        "touch": np.arange(len(point)),
        "axis": np.full(len(point), Axis[axis]),
        "sign": signs[run],
        "position_deg" if turns else "position_mm": place,
        "deviation_arcsec" if turns else "deviation_um": beyond,
        "feed_mm_min": np.full(len(point), np.nan if feed is None else feed),
    }
    found.columns = Touches.from_columns(**columns)
    found.known.append(
        f"{len(positions)} positions, {int((signs > 0).sum())} runs in the positive sense, "
        f"{int((signs < 0).sum())} in the negative"
    )
    found.assumed += [
        "runs one after the other, each along its sense, with no homing or zeroing in between",
        "deviations are actual minus target, so in the negative sense they count the other way",
        f"deviations are in {'mm' if in_mm else 'µm'}; else give --unit",
    ]
    if (signs > 0).all():
        found.assumed.append("no head of a column says the negative sense (-, ↓, down, reverse)")
    if feed is None:
        found.assumed.append("the feed is not known; positions were measured at rest: give --feed")
    return found


def _course(run: int, signs: np.typing.NDArray[np.float64], positions: np.ndarray) -> list[int]:
    order = [int(point) for point in np.argsort(positions, kind="stable")]
    return order if signs[run] > 0 else order[::-1]


def _numbers(
    path: Path, rows: list[tuple[int, list[str]]], runs: int
) -> tuple[np.ndarray, np.ndarray]:
    positions, deviations = [], []
    for line, row in rows:
        cells = [cell.strip() for cell in row]
        try:
            positions.append(float(cells[0]))
            values = [float(cell) if cell else np.nan for cell in cells[1:]]
        except ValueError:
            wrong = next((cell for cell in cells if not _is_number(cell)), cells[0])
            raise InputError(path, line, None, f"expected a number, got {quoted(wrong)}") from None
        if len(values) != runs:
            message = f"expected {runs + 1} cells, got {len(cells)}"
            raise InputError(path, line, None, message)
        deviations.append(values)
    return np.array(positions), np.array(deviations)


def _is_number(cell: str) -> bool:
    try:
        float(cell or "nan")
    except ValueError:
        return False
    return True
