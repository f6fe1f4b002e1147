"""A table as ISO 230-2 has it: positions × runs × senses, deviations in µm.

The first column holds the positions in mm. Each further column is a run; its head says the sense:
an arrow, ``+`` or ``-``, ``up``/``down``, ``forward``/``reverse``, ``positive``/``negative``, or
``vorwärts``/``rückwärts``. A head that says none is a run in the positive sense. Means, spreads and
other results that stand beside or below the runs are left out.
"""

from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Touches
from skiplatch.campaign.column_kinds import CellError
from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError
from skiplatch.importing.iso230_heads import is_negative, no_runs, says_mm, says_sense
from skiplatch.importing.model import Figure, Imported
from skiplatch.importing.spreadsheets import (
    ANY_NUMBER,
    begins_with_a_word,
    read_spreadsheet,
    say_digit,
    tells,
)
from skiplatch.numbers import number
from skiplatch.units import ARCSEC_PER_MILLIDEGREE, UM_PER_MM

DECIMALS = 3  # of a deviation in a campaign
LEAST_SIGMA_UM = 1e-3  # a campaign tells no less


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
    sheet = read_spreadsheet(path, _is_head)
    found = Imported(preset="plc-4ms")
    sheet.say(found)
    sheet.marks.refuse_doubtful(path, range(len(sheet.rows[0][1]) if sheet.rows else 0))
    rows = _without_what_is_worked_out(sheet.rows, found)
    if len(rows) < 2 or len(rows[0][1]) < 2:
        expected = "expected positions in the first column and a run in each further one"
        raise InputError(path, None, None, expected)
    heads = [head.strip() for head in rows[0][1][1:]]
    in_mm = _in_mm(path, rows[0], found, in_mm=in_mm)
    signs = np.array([-1.0 if is_negative(head) else 1.0 for head in heads])
    positions, deviations = _numbers(path, rows)
    unit = UM_PER_MM if in_mm else 1.0
    order = np.array(
        [(p, run) for run in range(len(heads)) for p in _course(run, signs, positions)]
    )
    point, run = order[:, 0], order[:, 1]
    known = ~np.isnan(deviations[point, run])
    point, run = point[known], run[known]
    turns = axis in "ABC"
    zero = _zero(positions[point], deviations[point, run], signs[run])
    zero = round(zero * unit, DECIMALS) / unit  # so that the table's own steps stay what they are
    cells = (cell for _, row in rows[1:] for cell in row[1:])
    place, beyond = positions[point], (deviations[point, run] - zero) * unit * signs[run]
    say_digit(found, cells, unit / ARCSEC_PER_MILLIDEGREE if turns else unit)
    _say_repeatability(found, np.column_stack([place, signs[run]]), beyond, turns=turns)
    columns: dict[str, np.typing.NDArray[np.generic]] = {
        "touch": np.arange(len(point)),
        "axis": np.full(len(point), Axis[axis]),
        "sign": signs[run],
        "position_deg" if turns else "position_mm": place,
        "deviation_arcsec" if turns else "deviation_um": beyond,
        "feed_mm_min": np.full(len(point), np.nan if feed is None else feed),
    }
    found.columns = Touches.from_columns(**columns)
    found.lines = [rows[1 + i][0] for i in point.tolist()]
    found.known.append(
        f"{len(positions)} positions, {int((signs > 0).sum())} runs in the positive sense, "
        f"{int((signs < 0).sum())} in the negative"
    )
    found.assumed += [
        "runs one after the other, each along its sense, with no homing or zeroing in between",
        "deviations are actual minus target, so in the negative sense they count the other way",
    ]
    if zero:
        found.assumed.append(
            f"the zero of the instrument tells nothing: {zero:.4g} {'mm' if in_mm else 'µm'}, at "
            "which the runs in the positive sense meet position 0, was taken off every deviation"
        )
    if (signs > 0).all():
        found.assumed.append("no head of a column says the negative sense (-, ↓, down, reverse)")
    if feed is None:
        found.assumed.append("the feed is not known; positions were measured at rest: give --feed")
    return found


def _is_head(cells: list[str], below: list[str]) -> bool:
    """Tell the head of the table: numbers follow, and it holds other words than these."""
    return (
        len(cells) > 1
        and len(below) == len(cells)
        and bool(below[0])
        and any(below[1:])
        and all(_is_number(cell.replace(",", ".")) for cell in below)
        and not all(_is_number(cell.replace(",", ".")) for cell in cells[:1])
    )


def _without_what_is_worked_out(rows: list[Row], found: Imported) -> list[Row]:
    """Leave out columns of means and spreads, and the lines of words below the table."""
    head = rows[0][1] if rows else []
    if dropped := no_runs(head):
        names = ", ".join(head[i].strip() for i in sorted(dropped))
        found.unread.append(f"columns that are no runs: {names}")
        rows = [(n, [cell for i, cell in enumerate(r) if i not in dropped]) for n, r in rows]
    rows = [(n, row) for n, row in rows if any(cell.strip() for cell in row)]
    last = len(rows)
    while last > 2 and begins_with_a_word(rows[last - 1][1]):
        last -= 1
    if last < len(rows):
        found.unread.append(f"lines below the table: {len(rows) - last}")
    return rows[:last]


def _in_mm(path: Path, head: Row, found: Imported, *, in_mm: bool) -> bool:
    """Tell whether deviations are in mm, by the heads of the runs, else by what is given."""
    said = says_mm(path, *head)
    if said is None:
        found.assumed.append(f"deviations are in {'mm' if in_mm else 'µm'}; else give --unit")
        return in_mm
    if in_mm and not said:
        raise InputError(path, head[0], None, "the heads of the runs say µm, and --unit says mm")
    found.known.append(f"deviations in {'mm' if said else 'µm'}, as the heads of the runs say")
    return said


def _say_repeatability(
    found: Imported, surfaces: FloatArray, beyond: FloatArray, *, turns: bool
) -> None:
    """Note how runs repeat at each place and sense, which any belief could only guess.

    A guess that is too wide takes a small scale error and a reversal error for scatter.

    Args:
        found: Is told.
        surfaces: Place and sense of each touch; shape (n, 2).
        beyond: Deviations, of rotary axes in arcsec; shape (n,).
        turns: Whether the axis is a rotary one.
    """
    _, which, count = np.unique(surfaces, axis=0, return_inverse=True, return_counts=True)
    which = which.ravel()
    freedom = len(beyond) - len(count)
    if freedom == 0:
        return
    left = beyond - (np.bincount(which, beyond) / count)[which]
    sigma = float(np.sqrt(np.sum(left**2) / freedom)) / (ARCSEC_PER_MILLIDEGREE if turns else 1.0)
    if sigma > LEAST_SIGMA_UM:
        u = max(sigma / float(np.sqrt(2.0 * freedom)), LEAST_SIGMA_UM)
        source = f"scatter of the runs about their middles, {freedom} degrees of freedom"
        found.figures["probe", "repeatability_um"] = Figure(
            round(sigma, DECIMALS), source, round(u, DECIMALS)
        )


def _zero(place: FloatArray, deviation: FloatArray, sign: FloatArray) -> float:
    """Give the deviation of the positive sense at position 0, by a common slope of both senses.

    Where the instrument reads 0 is arbitrary, and a campaign knows no such freedom: a shift of
    the coordinate would look like a reversal error, and a reversal error like a pretravel.

    Args:
        place: Positions in mm; shape (n,).
        deviation: Actual minus target; shape (n,).
        sign: Sense; shape (n,).
    """
    if not (sign > 0).any() or not (sign < 0).any():
        return 0.0
    design = np.column_stack([sign > 0, sign < 0, place]).astype(float)
    return float(np.linalg.lstsq(design, deviation, rcond=None)[0][0])


def _course(run: int, signs: np.typing.NDArray[np.float64], positions: np.ndarray) -> list[int]:
    order = [int(point) for point in np.argsort(positions, kind="stable")]
    return order if signs[run] > 0 else order[::-1]


def _numbers(path: Path, rows: list[Row]) -> tuple[FloatArray, FloatArray]:
    """Give positions, shape (n,), and deviations, shape (n, runs), NaN where there is none."""
    (_, head), *body = rows
    for line, row in body:
        if len(row) != len(head):
            raise InputError(path, line, None, f"expected {len(head)} cells, got {len(row)}")
    columns = []
    for i, name in enumerate(head):
        try:
            columns.append(ANY_NUMBER.parse([row[i] for _, row in body], required=i == 0))
        except CellError as error:
            if i == 0 and sum(says_sense(row[0]) for _, row in body) > 1:
                message = "expected positions in the first column, got runs in rows: transpose it"
                raise InputError(path, body[error.index][0], None, message) from error
            raise InputError(path, body[error.index][0], name.strip(), error.message) from error
    return columns[0], np.column_stack(columns[1:])


def _is_number(cell: str) -> bool:
    try:
        number(cell)
    except ValueError:
        return not tells(cell)
    return True
