"""A table as ISO 230-2 has it: positions × runs × senses, deviations in µm.

The first column holds the positions in mm. Each further column is a run; its head says the sense:
an arrow, ``+`` or ``-``, ``up``/``down``, ``forward``/``reverse``, ``positive``/``negative``, or
``vorwärts``/``rückwärts``. Letters do too where runs stand in pairs: ``1F``/``1R``, ``P1``/``N1``;
other pairs are refused. Else a head that says none is a run in the positive sense. Means, spreads
and other results that stand beside or below the runs are left out. Runs may also be rows, and
touches lines of a list with columns of position, sense and deviation.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.campaign import Axis, DatumFreedom, Touches
from skiplatch.campaign.column_kinds import CellError
from skiplatch.errors import InputError, quoted
from skiplatch.importing.iso230_heads import (
    RUN_UNITS,
    is_negative,
    no_runs,
    unit_in_title,
    unit_said,
)
from skiplatch.importing.iso230_layout import is_head, laid_out
from skiplatch.importing.iso230_pairs import with_senses
from skiplatch.importing.iso230_run_table import RunTable
from skiplatch.importing.model import Figure, Imported
from skiplatch.importing.spreadsheets import ANY_NUMBER, read_spreadsheet, say_digit
from skiplatch.units import ARCSEC_PER_MILLIDEGREE

DECIMALS = 3  # of a deviation in a campaign
_TIME = re.compile(r"\W*(?:time\b|(?:seconds?|[mµun]?s)\W*$)", re.IGNORECASE)
CLOSE = 0.01  # of the span of the targets, within which what was measured is a position
LEAST_SIGMA_UM = 1e-3  # a campaign tells no less
NEGLIGIBLE = 1e-9  # of what is left of equal numbers
UNLIKELY_SIGMA = 0.02  # in µm or arcsec, below which axes do not repeat, and numbers are in mm


def read_iso230(path: Path, axis: str, *, unit: str | None, feed: float | None) -> Imported:
    """Read the table.

    Args:
        path: The table.
        axis: The axis it is of.
        unit: Of the deviations where the table names none: µm, mm; of a rotary axis arcsec, deg.
        feed: In mm/min.

    Raises:
        InputError: It cannot be read or is no such table.
    """
    sheet = read_spreadsheet(path, is_head)
    found = Imported(preset="plc-4ms")
    sheet.say(found)
    sheet.marks.refuse_doubtful(path, range(len(sheet.rows[0][1]) if sheet.rows else 0))
    _refuse_times(path, sheet.rows)
    laid = laid_out(path, sheet.rows, found)
    table = with_senses(path, sheet.rows[0][0], laid) if laid.heads else laid
    table = _without_what_is_worked_out(table, found)
    if not table.rows or len(table.heads) < 2:
        expected = "expected positions in the first column and a run in each further one"
        raise InputError(path, None, None, expected)
    turns = axis in "ABC"
    title = unit_in_title(sheet.title, turns=turns)
    said = unit_said(path, sheet.rows[0][0], table.heads, turns=turns) or title
    signs = np.array([-1.0 if is_negative(head) else 1.0 for head in table.heads[1:]])
    positions, deviations = _numbers(path, table)
    lines = np.array(table.lines)[:, 1:]
    if _are_positions(positions, deviations):
        found.known.append("positions in place of deviations: the targets were taken off")
        deviations, said = deviations - positions[:, None], "deg" if turns else "mm"
    scale = _scale(path, sheet.rows[0][0], said, unit, found, turns=turns)
    deviations = deviations * scale
    point, run = _order(positions, signs)
    known = ~np.isnan(deviations[point, run])
    point, run = point[known], run[known]
    if table.in_order:
        as_made = np.argsort(lines[point, run])
        point, run = point[as_made], run[as_made]
    zero = _zero(positions[point], deviations[point, run], signs[run])
    zero = round(zero, DECIMALS)  # so that the table's own steps stay what they are
    cells = (cell for row in table.rows for cell in row[1:])
    place, beyond = positions[point], (deviations[point, run] - zero) * signs[run]
    say_digit(found, cells, scale / ARCSEC_PER_MILLIDEGREE if turns else scale)
    sigma, freedom = _repeatability(np.column_stack([place, signs[run]]), beyond)
    if said is None and unit is None:
        _refuse_doubtful_unit(path, sheet.rows[0][0], sigma, turns=turns)
    _say_repeatability(found, sigma, freedom, turns=turns)
    columns: dict[str, np.typing.NDArray[np.generic]] = {
        "touch": np.arange(len(point)),
        "axis": np.full(len(point), Axis[axis]),
        "sign": signs[run],
        "position_deg" if turns else "position_mm": place,
        "deviation_arcsec" if turns else "deviation_um": beyond,
        "feed_mm_min": np.full(len(point), np.nan if feed is None else feed),
    }
    found.columns, found.free = Touches.from_columns(**columns), DatumFreedom.ZERO
    found.lines = lines[point, run].tolist()
    found.known.append(
        f"{len(positions)} positions, {int((signs > 0).sum())} runs in the positive sense, "
        f"{int((signs < 0).sum())} in the negative"
    )
    course = "" if table.in_order else "runs one after the other, each along its sense, with "
    found.assumed += [
        f"{course}no homing or zeroing in between",
        "deviations are actual minus target, so in the negative sense they count the other way",
    ]
    if zero:
        found.assumed.append(
            f"the zero of the instrument tells nothing: {zero:.4g} {'arcsec' if turns else 'µm'}, "
            "at which the runs in the positive sense meet position 0, was taken off every deviation"
        )
    if (signs > 0).all():
        found.assumed.append("no head of a column says the negative sense (-, ↓, down, reverse)")
    found.assumed.append(
        "the positions were read at rest: no touch, no feed and no delay is in them"
    )
    return found


def _refuse_times(path: Path, rows: Sequence[tuple[int, list[str]]]) -> None:
    """Refuse times where positions stand, as of an oscilloscope: they grow evenly as well."""
    if rows and (heads := rows[0][1]) and _TIME.match(heads[0]):
        message = f"expected positions in the first column, got {quoted(heads[0])}"
        raise InputError(path, rows[0][0], None, message)


def _without_what_is_worked_out(table: RunTable, found: Imported) -> RunTable:
    """Leave out columns of means and spreads."""
    if dropped := no_runs(table.heads):
        names = ", ".join(table.heads[i] for i in sorted(dropped))
        found.unread.append(f"columns that are no runs: {names}")
        return table.without(dropped)
    return table


def _are_positions(positions: FloatArray, deviations: FloatArray) -> bool:
    """Tell whether what was measured is where the axis was, and not how far off its target.

    Args:
        positions: Targets; shape (n,).
        deviations: Shape (n, runs).
    """
    span = float(np.ptp(positions))
    if span == 0.0 or np.isnan(deviations).all():
        return False
    off = np.nanmedian(np.abs(deviations - positions[:, None]))
    return bool(off < CLOSE * span < float(np.nanmax(np.abs(deviations))))


def _scale(
    path: Path, line: int, said: str | None, given: str | None, found: Imported, *, turns: bool
) -> float:
    """Give how many µm, or arcsec, the unit of the deviations is."""
    usual = "arcsec" if turns else "µm"
    units = RUN_UNITS[usual]
    given = "µm" if given == "um" else given
    if given and given not in units:
        raise InputError(path, None, None, f"--unit {given}: expected one of {', '.join(units)}")
    if said is None:
        found.assume(f"deviations are in {given or usual}", "--unit")
        return units[given or usual]
    if given and said != given:
        message = f"the heads of the runs say {said}, and --unit says {given}"
        raise InputError(path, line, None, message)
    found.known.append(f"deviations in {said}, as the table says")
    return units[said]


def _repeatability(surfaces: FloatArray, beyond: FloatArray) -> tuple[float, int]:
    """Give how runs repeat at each place and sense, and by how many degrees of freedom.

    Args:
        surfaces: Place and sense of each touch; shape (n, 2).
        beyond: Deviations; shape (n,).
    """
    _, which, count = np.unique(surfaces, axis=0, return_inverse=True, return_counts=True)
    which = which.ravel()
    freedom = len(beyond) - len(count)
    left = beyond - (np.bincount(which, beyond) / count)[which]
    return float(np.sqrt(np.sum(left**2) / max(freedom, 1))), freedom


def _refuse_doubtful_unit(path: Path, line: int, sigma: float, *, turns: bool) -> None:
    """Refuse numbers that nobody named the unit of, and that repeat better than an axis does.

    Raises:
        InputError: They do; a table in mm that is taken for one in µm.
    """
    if NEGLIGIBLE < sigma < UNLIKELY_SIGMA:
        usual, coarse, option = ("arcsec", "deg", "arcsec") if turns else ("µm", "mm", "um")
        message = (
            f"no unit of the deviations is named, and in {usual} they would repeat to "
            f"{sigma:.2g} {usual}, closer than an axis does; give --unit {coarse}, or --unit "
            f"{option} if they do"
        )
        raise InputError(path, line, None, message)


def _say_repeatability(found: Imported, sigma: float, freedom: int, *, turns: bool) -> None:
    """Note how runs repeat, which any belief could only guess.

    A guess that is too wide takes a small scale error and a reversal error for scatter.
    """
    sigma_um = sigma / ARCSEC_PER_MILLIDEGREE if turns else sigma
    if freedom and sigma_um > LEAST_SIGMA_UM:
        u = max(sigma_um / float(np.sqrt(2.0 * freedom)), LEAST_SIGMA_UM)
        source = f"scatter of the runs about their middles, {freedom} degrees of freedom"
        found.figures["probe", "repeatability_um"] = Figure(
            round(sigma_um, DECIMALS), source, round(u, DECIMALS)
        )


def _zero(place: FloatArray, deviation: FloatArray, sign: FloatArray) -> float:
    """Give the deviation of the positive sense at position 0, by a common slope of both senses.

    Where the instrument reads 0 is arbitrary, which the campaign's datum says: a diagnosis fits the
    zero anew. Deviations are told from about it for whoever reads them without one.

    Args:
        place: Positions in mm; shape (n,).
        deviation: Actual minus target; shape (n,).
        sign: Sense; shape (n,).
    """
    if not (sign > 0).any() or not (sign < 0).any():
        return 0.0
    design = np.column_stack([sign > 0, sign < 0, place]).astype(float)
    return float(np.linalg.lstsq(design, deviation, rcond=None)[0][0])


def _order(positions: FloatArray, signs: FloatArray) -> tuple[IndexArray, IndexArray]:
    """Number positions and runs in the order of touches, one run after the other; shape (m,)."""
    up = np.argsort(positions, kind="stable")
    courses = [up if sign > 0 else up[::-1] for sign in signs]
    return np.concatenate(courses), np.repeat(np.arange(len(signs)), len(positions))


def _numbers(path: Path, table: RunTable) -> tuple[FloatArray, FloatArray]:
    """Give positions, shape (n,), and deviations, shape (n, runs), NaN where there is none."""
    columns = []
    for i, name in enumerate(table.heads):
        try:
            columns.append(ANY_NUMBER.parse([row[i] for row in table.rows], required=i == 0))
        except CellError as error:
            raise InputError(path, table.lines[error.index][i], name, error.message) from error
    return columns[0], np.column_stack(columns[1:])
