"""Any table: which of its columns is which of a campaign's, in which unit."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import COLUMNS, Axis, Kind, Touches
from skiplatch.campaign.column_kinds import CellError, LabelColumn, NumberColumn
from skiplatch.campaign.columns import TIME, is_thermometer, place_of
from skiplatch.campaign.time_stamps import TIME_NAME, seconds
from skiplatch.errors import InputError, hint, quoted
from skiplatch.importing.model import Imported, Touch
from skiplatch.importing.spreadsheets import read_spreadsheet, say_digit

_MAPPING = re.compile(r"^(?P<column>[\w.-]+)=(?P<head>.*)$")
_UNIT = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*)\]|\((?P<aside>[^)]*)\))$")
COORDINATE = "coordinate_mm"
"""Not of a campaign: where the axis was latched, from which deviations are made."""

UNITS: Mapping[str, Mapping[str, float]] = {
    "mm": {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "m": 1e3, "in": 25.4, "inch": 25.4, "mil": 0.0254},
    "µm": {"µm": 1.0, "um": 1.0, "mm": 1e3, "m": 1e6, "nm": 1e-3, "in": 25400.0, "mil": 25.4},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "µs": {"µs": 1.0, "us": 1.0, "ms": 1e3, "s": 1e6, "ns": 1e-3},
    "mm/min": {"mm/min": 1.0, "mm/s": 60.0, "m/min": 1e3, "m/s": 6e4, "in/min": 25.4, "ipm": 25.4},
    "deg": {"deg": 1.0, "°": 1.0, "rad": 180.0 / np.pi, "arcsec": 1.0 / 3600.0},
    "arcsec": {"arcsec": 1.0, '"': 1.0, "deg": 3600.0, "rad": 180.0 * 3600.0 / np.pi},
    "°C": {"°C": 1.0, "C": 1.0, "degC": 1.0, "K": 1.0, "F": 5.0 / 9.0, "°F": 5.0 / 9.0},
}
_DOTTED_DATE = re.compile(r"^(\d{2})\.(\d{2})\.(\d{4})[ T]+(?=\d)")
"""07.10.2025 08:15:00: with points the day comes first."""
_LENGTHS_UM = {"deviation_um": 1.0, COORDINATE: 1e3}
"""Columns that tell the resolution, and their unit in µm."""
ALSO = (
    *("touch", "path", "alpha_deg", "beta_deg", "rotary_deg", "temp_c"),
    *("edge_us", "latch_us", "report_us", "status"),
)
"""Columns that go along with coordinates as they are."""
_SENSES = {"+": "1", "-": "-1", "\u2212": "-1"}
_GREEK_MU = "\u03bc"  # looks like the µ of UNITS
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
    name, unit = _split(column, head)
    ending, units = _UNIT.match(head), UNITS.get(_unit_of(column))
    if units and ending and ending["unit"] and not unit:
        named = quoted(ending["unit"])
        raise ValueError(f"{column}: unit {named} is none of {', '.join(units)}")
    return Mapped(column, head, name, unit)


def _split(column: str, head: str) -> tuple[str, str]:
    """Take the unit off a head, ``Error [mm]`` or ``Feed (in/min)``, where it is one."""
    ending = _UNIT.match(head)
    if ending is None:
        return head, ""
    unit = (ending["unit"] or ending["aside"] or "").strip().replace(_GREEK_MU, "µ")
    return (ending["name"], unit) if unit in UNITS.get(_unit_of(column), {}) else (head, "")


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
    sheet = read_spreadsheet(path, lambda row, _: all(_found(row, m) for m in mapped))
    rows = sheet.rows
    if not rows:
        raise InputError(path, None, None, "expected a header row, got an empty file")
    (header_line, header), body = rows[0], rows[1:]
    heads = [head.strip() for head in header]
    mapped = [_in_table(path, header_line, heads, m) for m in mapped]
    columns = {m.column: _cells(path, heads, body, m) for m in mapped}
    lines = np.array([line for line, _ in body])
    if not body:
        raise InputError(path, header_line, None, "expected touches after the header, got none")
    if TIME_NAME in columns:
        columns["time_s"] = seconds(path, lines, columns.pop(TIME_NAME))
    found = Imported(kind=kind, preset="bench" if kind is Kind.BENCH else "plc-4ms")
    sheet.say(found)
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
        _from_coordinates(found, columns, axis, sign, feed)
    else:
        _as_they_are(found, columns, len(body), axis, sign, feed)
    return found


def _unit_of(column: str) -> str:
    if column == COORDINATE:
        return "mm"
    return "°C" if is_thermometer(column) else COLUMNS[column].unit if column in COLUMNS else ""


def _in(mapped: Mapped) -> str:
    return f" in {mapped.unit}" if mapped.unit else ""


def _found(heads: list[str], m: Mapped) -> Mapped | None:
    """Find a column by its head as given, else by the head without the unit of either."""
    if m.head in heads:
        return m
    for head in heads:
        name, unit = _split(m.column, head)
        if m.name in (head, name) and (not m.unit or unit in ("", m.unit)):
            return Mapped(m.column, head, name, m.unit or unit)
    return None


def _in_table(path: Path, line: int, heads: list[str], m: Mapped) -> Mapped:
    """Give a column as the table has it, or say which ones there are."""
    if found := _found(heads, m):
        return found
    there = ", ".join(head[:40] for head in heads[:20])
    message = f"no column {quoted(m.name)}{hint(m.name, heads)}; there are: {there}"
    raise InputError(path, line, None, message)


def _cells(
    path: Path, heads: list[str], body: list[tuple[int, list[str]]], m: Mapped
) -> FloatArray:
    position = heads.index(m.head)
    cells = [row[position] if position < len(row) else "" for _, row in body]
    if m.column == "sign":
        cells = [_SENSES.get(cell.strip(), cell) for cell in cells]
    if m.column == TIME_NAME:
        cells = [_DOTTED_DATE.sub(r"\3-\2-\1T", cell.strip()) for cell in cells]
    about = TIME if m.column == TIME_NAME else COLUMNS.get(m.column)
    if about is None or isinstance(about, NumberColumn):
        about = _LOOSE
    try:
        values = about.parse(cells)
    except CellError as error:
        raise InputError(path, body[error.index][0], m.head, error.message) from error
    if isinstance(about, LabelColumn) or about is not _LOOSE:
        return values
    factor = UNITS.get(_unit_of(m.column), {}).get(m.unit, 1.0)
    scaled: FloatArray = values * factor + _ZEROS.get(m.unit, 0.0)
    return scaled


_LOOSE = NumberColumn(
    constraint=COLUMNS["latch_us"].constraint,  # type: ignore[attr-defined]
    decimals=9,
    meaning="any number",
)


def _from_coordinates(
    found: Imported,
    columns: Mapping[str, FloatArray],
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
