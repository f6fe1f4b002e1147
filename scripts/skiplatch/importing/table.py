"""Any table: which of its columns is which of a campaign's, in which unit."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import COLUMNS, Axis, Kind, Status, Touches
from skiplatch.campaign.column_kinds import CellError, LabelColumn, NumberColumn, Values
from skiplatch.campaign.columns import is_thermometer, place_of
from skiplatch.campaign.csv_text import Row
from skiplatch.campaign.time_stamps import TIME_NAME, seconds
from skiplatch.errors import InputError, quoted
from skiplatch.importing.date_columns import column_of, stamps, with_dates
from skiplatch.importing.faces import are_faces, put_deviations
from skiplatch.importing.mapped import (
    COORDINATE,
    DATE,
    Mapped,
    axis_named,
    in_table,
    named_in,
    refuse_turned,
    refuse_twice,
    unit_of,
)
from skiplatch.importing.model import Imported, Touch
from skiplatch.importing.rings import axes_round, centred
from skiplatch.importing.spreadsheets import (
    ANY_NUMBER,
    read_spreadsheet,
    say_digit,
    without_lines_below,
)
from skiplatch.importing.status_words import as_status
from skiplatch.importing.table_rows import (
    begins_numbers,
    refuse_no_head,
    refuse_surplus,
    say_empty,
    say_short,
    touched,
    with_numbers,
)
from skiplatch.importing.units_in_heads import UNITS

_LENGTHS_UM = {"deviation_um": 1.0, COORDINATE: 1e3}
"""Columns that tell the resolution, and their unit in µm."""
ALSO = (
    *("touch", "path", "alpha_deg", "beta_deg", "rotary_deg", "temp_c"),
    *("edge_us", "latch_us", "report_us", "status"),
)
"""Columns that go along with coordinates as they are."""
USUAL_AXIS = "Z"
AXIS_ASSUMED = f"{USUAL_AXIS} probed, as no column says which axis did"
_SENSES = {"+": "1", "-": "-1", "\u2212": "-1"}
_MOVED = re.compile(rf"[XYZABC]?\s*([{re.escape(''.join(_SENSES))}])\s*[XYZABC]?", re.IGNORECASE)
"""A sense, as a cell tells it with or without the axis: ``+``, ``Y+``, ``-Z``."""
_AXIS_WITH_SENSE = re.compile(r"^([XYZABC])\s*[+\-\u2212]$", re.IGNORECASE)
"""An axis whose cell tells the sense as well; ``--map sign=`` takes that."""
_F_WORD = re.compile(r"\s*F\s*(?=[\d.])", re.IGNORECASE)
_ZEROS = {"K": -273.15, "F": -32.0 * 5.0 / 9.0, "°F": -32.0 * 5.0 / 9.0}


def read_table(
    path: Path,
    mapped: Sequence[Mapped],
    *,
    kind: Kind,
    axis: str | None,
    sign: int | None,
    feed: float | None,
) -> Imported:
    """Read a table of touches.

    Args:
        path: The table.
        mapped: Which of its columns are which.
        kind: Of the campaign.
        axis: Where no column says it; None: as the head of the coordinates names it, else X and Y
            by azimuths, else Z.
        sign: Likewise.
        feed: Likewise, in mm/min.

    Raises:
        InputError: It cannot be read, lacks a column, or holds a wrong cell.
    """
    refuse_twice(path, mapped)
    found = Imported(kind=kind, preset="bench" if kind is Kind.BENCH else "plc-4ms")
    sheet = read_spreadsheet(path, lambda row, _: _is_head(row, mapped))
    rows = with_numbers(sheet.rows, mapped, found)
    if not rows:
        raise InputError(path, None, None, "expected a header row, got an empty file")
    (header_line, header), body = rows[0], rows[1:]
    heads = [head.strip() for head in header]
    refuse_no_head(path, rows, sheet.title)
    mapped = [in_table(path, header_line, heads, m) for m in mapped]
    sheet.marks.refuse_doubtful(path, {heads.index(m.head) for m in mapped})
    sheet.say(found)
    body = without_lines_below(body, found)
    say_short(heads, body, mapped, found)
    body = touched(body, heads, mapped, found)
    refuse_surplus(path, heads, body)
    say_empty(heads, body, mapped, found)
    mapped = with_dates(heads, body, mapped)
    columns = {
        m.column: _cells(path, heads, body, m, found)
        for m in mapped
        if m.column not in (TIME_NAME, DATE)
    }
    _leave_out_ends(found, columns)
    axis = axis or _axis_by_head(found, columns, mapped)
    probed = axis or USUAL_AXIS
    axes = np.unique(columns["axis"]) if "axis" in columns else [Axis[probed]]
    refuse_turned(path, header_line, mapped, axes)
    found.lines = [line for line, _ in body]
    if not body:
        raise InputError(path, header_line, None, "expected touches after the header, got none")
    if TIME_NAME in (m.column for m in mapped):
        times = np.array(stamps(path, heads, body, mapped, found))
        columns["time_s"] = seconds(path, np.array(found.lines), times)
    for m in mapped:
        if m.column in _LENGTHS_UM:
            position, units = heads.index(m.head), UNITS[unit_of(m.column)]
            cells = (row[position] for _, row in body if position < len(row))
            say_digit(found, cells, _LENGTHS_UM[m.column] * units.get(m.unit, 1.0))
    found.known += [f"{m.column} from {quoted(m.head)}{_in(m)}" for m in mapped]
    bare = [m.column for m in mapped if not m.unit and UNITS.get(unit_of(m.column))]
    if bare:
        found.assumed.append(f"in the units of a campaign, as none is named: {', '.join(bare)}")
    ignored = [head for head in heads if head not in {m.head for m in mapped} and head]
    if ignored:
        found.unread.append(f"columns that no --map names: {', '.join(ignored[:20])}")
    is_machine = kind is Kind.MACHINE
    by_faces = is_machine and COORDINATE in columns and are_faces(found, columns, Axis[probed])
    if COORDINATE not in columns or by_faces:
        _as_they_are(found, columns, len(body), axis, sign, feed)
        return found
    if axis is None and "axis" not in columns:
        found.assume(AXIS_ASSUMED, "--axis")
    _from_coordinates(found, columns, found.lines, probed, sign, feed)
    return found


def _is_head(row: list[str], mapped: Sequence[Mapped]) -> bool:
    """Tell the head by its names, or the first row of numbers where the columns go by theirs."""
    return begins_numbers(row, mapped) or all(named_in(row, m) for m in mapped)


def _in(mapped: Mapped) -> str:
    return f" in {mapped.unit}" if mapped.unit else ""


def _leave_out_ends(found: Imported, columns: Mapping[str, FloatArray]) -> None:
    """Leave out coordinates of missed touches: there the move ended, and nothing was latched."""
    if COORDINATE not in columns or "status" not in columns:
        return
    ends = (columns["status"] == Status.MISSED) & ~np.isnan(columns[COORDINATE])
    columns[COORDINATE][ends] = np.nan
    if ends.any():
        found.assumed.append(
            f"coordinates of missed touches are where the move ended: {ends.sum()}"
        )


def _cells(path: Path, heads: list[str], body: list[Row], m: Mapped, found: Imported) -> Values:
    cells = column_of(heads, body, m.head)
    if m.column == "sign":
        moved = map(_MOVED.fullmatch, cells)
        cells = [_SENSES[m[1]] if m else cell for m, cell in zip(moved, cells, strict=True)]
    if m.column == "status":
        cells = as_status(cells, found)
    if m.column == "feed_mm_min":
        cells = [_F_WORD.sub("", cell, count=1) for cell in cells]
    if m.column == "axis":
        cells = _without_senses(cells, m, found)
    about = COLUMNS.get(m.column)
    if about is None or isinstance(about, NumberColumn):
        about = ANY_NUMBER
    try:
        values = about.parse(cells)
    except CellError as error:
        raise InputError(path, body[error.index][0], m.head, error.message) from error
    if isinstance(about, LabelColumn) or about is not ANY_NUMBER:
        return values
    factor = UNITS.get(unit_of(m.column), {}).get(m.unit, 1.0)
    scaled: FloatArray = values * factor + _ZEROS.get(m.unit, 0.0)
    return scaled


def _without_senses(cells: list[str], m: Mapped, found: Imported) -> list[str]:
    """Take the senses off ``X+`` and ``Z-``."""
    bare = [_AXIS_WITH_SENSE.sub(r"\1", cell.strip()) for cell in cells]
    if bare != [cell.strip() for cell in cells]:
        found.known.append(f"axes from {quoted(m.head)}, whose senses --map sign={m.head} takes")
    return bare


def _axis_by_head(
    found: Imported, columns: Mapping[str, FloatArray], mapped: Sequence[Mapped]
) -> str | None:
    """Give the axis that the head of the coordinates names, where no column tells it."""
    axis = None if "axis" in columns else axis_named(mapped)
    if axis:
        found.assume(f"{axis} probed, as the head of {COORDINATE} names it", "--axis")
    return axis


def _from_coordinates(
    found: Imported,
    columns: Mapping[str, FloatArray],
    lines: Sequence[int],
    axis: str,
    sign: int | None,
    feed: float | None,
) -> None:
    """Hold coordinates against the middle of their surface."""
    coordinates = columns[COORDINATE]
    for row, coordinate in enumerate(coordinates.tolist()):

        def value(name: str, row: int = row) -> float | None:
            cell = columns[name][row] if name in columns else np.nan
            return None if np.isnan(cell) else float(cell)

        own_axis = Axis(int(columns["axis"][row])).name if "axis" in columns else axis
        own_sign = value("sign")
        place = [value("position_mm"), value("alpha_deg"), value("beta_deg")]
        found.touches.append(
            Touch(
                axis=own_axis,
                coordinate=None if np.isnan(coordinate) else coordinate,
                sign=int(own_sign) if own_sign else sign,
                place=tuple(v for v in place if v is not None),
                feed=value("feed_mm_min") or feed,
                approach=value("approach_mm"),
                time_s=value("time_s"),
                session=str(columns["session"][row]) if "session" in columns else "",
                temperatures={
                    place_of(name): float(columns[name][row])
                    for name in columns
                    if is_thermometer(name) and not np.isnan(columns[name][row])
                },
                line=lines[row],
                also={name: float(columns[name][row]) for name in ALSO if name in columns},
            )
        )


def _as_they_are(
    found: Imported,
    columns: dict[str, FloatArray],
    rows: int,
    axis: str | None,
    sign: int | None,
    feed: float | None,
) -> None:
    columns = dict(columns)
    if "touch" not in columns:
        columns["touch"] = np.arange(rows, dtype=float)
        found.assumed.append("touches are numbered in the order of the rows")
    if found.kind is Kind.MACHINE:
        without = centred(found, columns, rows)
        if without is not None:
            columns["deviation_um"] = without
        _add_axis(found, columns, rows, axis, sign)
        if COORDINATE in columns:
            put_deviations(found, columns)
    if feed is not None:
        columns.setdefault("feed_mm_min", np.full(rows, feed))
    warmth = {place_of(name): columns.pop(name) for name in list(columns) if is_thermometer(name)}
    session = columns.pop("session", None)
    found.columns = Touches.from_columns(**columns, session=session, thermometers=warmth)


def _add_axis(
    found: Imported, columns: dict[str, FloatArray], rows: int, axis: str | None, sign: int | None
) -> None:
    """Add the axis and the sense that are given, or that azimuths tell, or the usual axis."""
    is_told = axis is not None or sign is not None or {"axis", "sign"} & columns.keys()
    if not is_told and (moved := axes_round(columns)):
        columns["axis"], columns["sign"] = moved
        found.assumed.append("X or Y moved, whichever goes more along the azimuth, alpha_deg")
        return
    if axis is None and "axis" not in columns:
        found.assume(AXIS_ASSUMED, "--axis")
    columns.setdefault("axis", np.full(rows, Axis[axis or USUAL_AXIS]))
    if sign is not None:
        columns.setdefault("sign", np.full(rows, float(sign)))
