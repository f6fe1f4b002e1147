"""Any table: which of its columns is which of a campaign's, in which unit."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import COLUMNS, Axis, Kind, Touches
from skiplatch.campaign.column_kinds import CellError, LabelColumn, NumberColumn, Values
from skiplatch.campaign.columns import TIME, is_thermometer, place_of
from skiplatch.campaign.csv_text import Row
from skiplatch.campaign.time_stamps import TIME_NAME, seconds
from skiplatch.errors import InputError, hint, quoted
from skiplatch.importing.dates import iso_of
from skiplatch.importing.model import Imported, Touch
from skiplatch.importing.spreadsheets import (
    ANY_NUMBER,
    read_spreadsheet,
    say_digit,
    tells,
    without_lines_below,
)
from skiplatch.importing.units_in_heads import BRACKETS, UNITS, split_unit

_MAPPING = re.compile(r"^(?P<column>[\w.-]+)=(?P<head>.*)$")
COORDINATE = "coordinate_mm"
"""Not of a campaign: where the axis was latched, from which deviations are made."""

_LENGTHS_UM = {"deviation_um": 1.0, COORDINATE: 1e3}
"""Columns that tell the resolution, and their unit in µm."""
ALSO = (
    *("touch", "path", "alpha_deg", "beta_deg", "rotary_deg", "temp_c"),
    *("edge_us", "latch_us", "report_us", "status"),
)
"""Columns that go along with coordinates as they are."""
_OUTCOMES = {COORDINATE, "edge_us", *(name for name in COLUMNS if COLUMNS[name].is_outcome)}
"""Columns that tell what came of a touch."""
_SENSES = {"+": "1", "-": "-1", "\u2212": "-1"}
_ZEROS = {"K": -273.15, "F": -32.0 * 5.0 / 9.0, "°F": -32.0 * 5.0 / 9.0}


@dataclass(frozen=True, slots=True)
class Mapped:
    """A column of a campaign that a column of a table stands for.

    Attributes:
        column: Of the campaign.
        head: As it was given.
        name: The head without its unit.
        unit: Of the table's column; empty where it is that of the campaign.
    """

    column: str
    head: str
    name: str
    unit: str


def parse_mapping(text: str) -> Mapped:
    """Read ``deviation_um=Error [mm]``.

    Raises:
        ValueError: It is none; says why.
    """
    match = _MAPPING.match(text)
    if not match:
        raise ValueError(f'expected COLUMN=HEAD or COLUMN="HEAD [unit]", got {quoted(text)}')
    column, head = match["column"], match["head"].strip()
    known = (*COLUMNS, COORDINATE, TIME_NAME)
    if column not in known and not is_thermometer(column):
        raise ValueError(f"{quoted(column)} is no column of a campaign{hint(column, known)}")
    name, unit = split_unit(head, _unit_of(column))
    ending, units = BRACKETS.match(head), UNITS.get(_unit_of(column))
    if units and ending and ending["unit"] and not unit:
        named = quoted(ending["unit"])
        raise ValueError(f"{column}: unit {named} is none of {', '.join(units)}")
    return Mapped(column, head, name, unit)


def read_table(
    path: Path,
    mapped: Sequence[Mapped],
    *,
    kind: Kind,
    axis: str,
    sign: int | None,
    feed: float | None,
) -> Imported:
    """Read a table of touches.

    Args:
        path: The table.
        mapped: Which of its columns are which.
        kind: Of the campaign.
        axis: Where no column says it.
        sign: Likewise.
        feed: Likewise, in mm/min.

    Raises:
        InputError: It cannot be read, lacks a column, or holds a wrong cell.
    """
    _refuse_twice(path, mapped)
    sheet = read_spreadsheet(path, lambda row, _: all(_named(row, m) for m in mapped))
    rows = sheet.rows
    if not rows:
        raise InputError(path, None, None, "expected a header row, got an empty file")
    (header_line, header), body = rows[0], rows[1:]
    heads = [head.strip() for head in header]
    mapped = [_in_table(path, header_line, heads, m) for m in mapped]
    sheet.marks.refuse_doubtful(path, {heads.index(m.head) for m in mapped})
    found = Imported(kind=kind, preset="bench" if kind is Kind.BENCH else "plc-4ms")
    sheet.say(found)
    body = _touched(without_lines_below(body, found), heads, mapped, found)
    columns = {m.column: _cells(path, heads, body, m) for m in mapped}
    found.lines = [line for line, _ in body]
    if not body:
        raise InputError(path, header_line, None, "expected touches after the header, got none")
    if TIME_NAME in columns:
        columns["time_s"] = seconds(path, np.array(found.lines), columns.pop(TIME_NAME))
    for m in mapped:
        if m.column in _LENGTHS_UM:
            position, units = heads.index(m.head), UNITS[_unit_of(m.column)]
            cells = (row[position] for _, row in body if position < len(row))
            say_digit(found, cells, _LENGTHS_UM[m.column] * units.get(m.unit, 1.0))
    found.known += [f"{m.column} from {quoted(m.head)}{_in(m)}" for m in mapped]
    bare = [m.column for m in mapped if not m.unit and UNITS.get(_unit_of(m.column))]
    if bare:
        found.assumed.append(f"in the units of a campaign, as none is named: {', '.join(bare)}")
    ignored = [head for head in heads if head not in {m.head for m in mapped} and head]
    if ignored:
        found.unread.append(f"columns that no --map names: {', '.join(ignored[:20])}")
    if COORDINATE in columns:
        _from_coordinates(found, columns, found.lines, axis, sign, feed)
    else:
        _as_they_are(found, columns, len(body), axis, sign, feed)
    return found


def _refuse_twice(path: Path, mapped: Sequence[Mapped]) -> None:
    """Refuse two columns of the table for one of a campaign; there, a date is a time too."""
    head_of: dict[str, str] = {}
    for m in mapped:
        column = "time_s" if m.column == TIME_NAME else m.column
        if column in head_of:
            message = f"expected one head, got {quoted(head_of[column])} and {quoted(m.head)}"
            raise InputError(path, None, column, message)
        head_of[column] = m.head


def _unit_of(column: str) -> str:
    if column == COORDINATE:
        return "mm"
    return "°C" if is_thermometer(column) else COLUMNS[column].unit if column in COLUMNS else ""


def _in(mapped: Mapped) -> str:
    return f" in {mapped.unit}" if mapped.unit else ""


def _touched(
    body: list[Row], heads: list[str], mapped: Sequence[Mapped], found: Imported
) -> list[Row]:
    """Leave out rows that tell of no touch: they are empty where a column stands for something.

    One without a coordinate would count as missed, so there an outcome has to be told.
    """
    telling = [m for m in mapped if m.column in _OUTCOMES]
    if COORDINATE not in (m.column for m in mapped):
        telling = list(mapped)
    places = {heads.index(m.head) for m in telling}
    kept = [row for row in body if any(tells(c) for i, c in enumerate(row[1]) if i in places)]
    if len(kept) == len(body):
        return body
    lines = {line for line, _ in kept}
    left_out = [line for line, _ in body if line not in lines]
    said = f"{len(left_out)}, the first in line {left_out[0]}"
    found.unread.append(f"rows that tell of no touch: {said}")
    empty = [line for line, row in body if not any(cell.strip() for cell in row)]
    below = sum(line > min(empty) for line in lines) if empty else 0
    if below:
        found.assumed.append(f"rows below an empty one are touches like those above: {below}")
    return kept


def _named(heads: list[str], m: Mapped) -> list[Mapped]:
    """Give the columns with a head as given, else with that head without the unit of either."""
    if m.head in heads:
        return [m] * heads.count(m.head)
    named = []
    for head in heads:
        name, unit = split_unit(head, _unit_of(m.column))
        is_bare = m.name == head and not BRACKETS.match(head)  # then what ends it may be no unit
        if is_bare or (m.name in (head, name) and (not m.unit or unit in ("", m.unit))):
            named.append(Mapped(m.column, head, name, m.unit or unit))
    return named


def _in_table(path: Path, line: int, heads: list[str], m: Mapped) -> Mapped:
    """Give a column as the table has it, or say which ones there are."""
    named = _named(heads, m)
    if len(named) == 1:
        return named[0]
    if named:
        those = {one.head for one in named}
        numbers = [str(i) for i, head in enumerate(heads, 1) if head in those]
        message = f"{quoted(m.head)} may be any of columns {', '.join(numbers)}: rename all but one"
        raise InputError(path, line, None, message)
    there = ", ".join(head[:40] for head in heads[:20])
    message = f"no column {quoted(m.name)}{hint(m.name, heads)}; there are: {there}"
    raise InputError(path, line, None, message)


def _cells(path: Path, heads: list[str], body: list[Row], m: Mapped) -> Values:
    position = heads.index(m.head)
    cells = [row[position] if position < len(row) else "" for _, row in body]
    if m.column == "sign":
        cells = [_SENSES.get(cell.strip(), cell) for cell in cells]
    if m.column == TIME_NAME:
        cells = [iso_of(cell.strip()) for cell in cells]
    about = TIME if m.column == TIME_NAME else COLUMNS.get(m.column)
    if about is None or isinstance(about, NumberColumn):
        about = ANY_NUMBER
    try:
        values = about.parse(cells)
    except CellError as error:
        raise InputError(path, body[error.index][0], m.head, error.message) from error
    if isinstance(about, LabelColumn) or about is not ANY_NUMBER:
        return values
    factor = UNITS.get(_unit_of(m.column), {}).get(m.unit, 1.0)
    scaled: FloatArray = values * factor + _ZEROS.get(m.unit, 0.0)
    return scaled


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
    axis: str,
    sign: int | None,
    feed: float | None,
) -> None:
    columns = dict(columns)
    if "touch" not in columns:
        columns["touch"] = np.arange(rows, dtype=float)
        found.assumed.append("touches are numbered in the order of the rows")
    if found.kind is Kind.MACHINE:
        columns.setdefault("axis", np.full(rows, Axis[axis]))
        if sign is not None:
            columns.setdefault("sign", np.full(rows, float(sign)))
    if feed is not None:
        columns.setdefault("feed_mm_min", np.full(rows, feed))
    warmth = {place_of(name): columns.pop(name) for name in list(columns) if is_thermometer(name)}
    session = columns.pop("session", None)
    found.columns = Touches.from_columns(**columns, session=session, thermometers=warmth)
