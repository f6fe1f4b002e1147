"""Which column of a table is which of a campaign's."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from skiplatch.campaign import COLUMNS, Axis
from skiplatch.campaign.columns import is_thermometer
from skiplatch.campaign.time_stamps import TIME_NAME
from skiplatch.errors import InputError, hint, quoted
from skiplatch.importing.units_in_heads import (
    BRACKETS,
    OF_A_WAY,
    TURNED,
    UNITS,
    bracketed,
    no_unit,
    split_unit,
)

_MAPPING = re.compile(r"^(?P<column>[\w.-]+)=(?P<head>.*)$")
_NUMBER = re.compile(r"[-+]?[\d.,]+(?:[eE][-+]?\d+)?", re.ASCII)
COORDINATE = "coordinate_mm"
"""Not of a campaign: where the axis was latched, from which deviations are made."""

_OF_THE_AXIS = (COORDINATE, "approach_mm", "feed_mm_min")
"""Columns that are in degrees where the axis turns."""

DATE = "date"
"""Likewise: the day of a time of day in `time`."""


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
    known = (*COLUMNS, COORDINATE, TIME_NAME, DATE)
    if column not in known and not is_thermometer(column):
        raise ValueError(f"{quoted(column)} is no column of a campaign{hint(column, known)}")
    name, unit = split_unit(head, unit_of(column))
    if wrong := no_unit(head, unit_of(column)):
        raise ValueError(_unknown(column, head, wrong))
    return Mapped(column, head, name, unit)


def _unknown(column: str, head: str, wrong: str) -> str:
    """Say that what stands in brackets is no unit, and how to name one if it is not meant to be."""
    units = UNITS[unit_of(column)]
    return (
        f"{column}: unit {quoted(wrong)} is none of {', '.join(units)}; "
        f"if it is no unit, name one behind it: {quoted(f'{head} [{next(iter(units))}]')}"
    )


def refuse_twice(path: Path, mapped: Sequence[Mapped]) -> None:
    """Refuse two columns of the table for one of a campaign, and dates without times of day."""
    head_of: dict[str, str] = {}
    for m in mapped:
        column = "time_s" if m.column == TIME_NAME else m.column
        if column in head_of:
            message = f"expected one head, got {quoted(head_of[column])} and {quoted(m.head)}"
            raise InputError(path, None, column, message)
        head_of[column] = m.head
    if DATE in head_of and TIME_NAME not in (m.column for m in mapped):
        message = f"expected --map {TIME_NAME}= beside it, the column of the times of day"
        raise InputError(path, None, DATE, message)


def refuse_turned(path: Path, line: int, mapped: Sequence[Mapped], axes: Iterable[float]) -> None:
    """Refuse an angle where an axis that probed is none that turns."""
    linear = [Axis(int(axis)).name for axis in axes if axis < Axis.A]
    for m in mapped:
        if linear and m.unit in TURNED and m.column in _OF_THE_AXIS:
            message = f"unit {quoted(m.unit)}: axis {linear[0]} does not turn; --axis names it"
            raise InputError(path, line, m.head, message)


def unit_of(column: str) -> str:
    """Give the unit that a column has in a campaign; empty where it has none."""
    if column in (COORDINATE, "approach_mm"):
        return OF_A_WAY
    return "°C" if is_thermometer(column) else COLUMNS[column].unit if column in COLUMNS else ""


def axis_named(mapped: Sequence[Mapped]) -> str | None:
    """Give the axis whose name the coordinates have for a head, as in ``X`` or ``X [mm]``."""
    names = (m.name.strip().upper() for m in mapped if m.column == COORDINATE)
    return next((name for name in names if name in Axis.__members__), None)


def named_in(heads: list[str], m: Mapped) -> list[Mapped]:
    """Give the columns with a head as given, else with that head without the unit of either."""
    if m.head in heads:
        return [m] * heads.count(m.head)
    named = []
    for head in heads:
        name, unit = split_unit(head, unit_of(m.column))
        is_bare = m.name == head and not BRACKETS.match(head)  # then what ends it may be no unit
        if is_bare or (m.name in (head, name) and (not m.unit or unit in ("", m.unit))):
            named.append(Mapped(m.column, head, name, m.unit or unit))
    return named


def in_table(path: Path, line: int, heads: list[str], m: Mapped) -> Mapped:
    """Give a column as the table has it, or say which ones there are."""
    named = named_in(heads, m)
    if len(named) == 1:
        return named[0]
    if named:
        those = {one.head for one in named}
        numbers = [str(i) for i, head in enumerate(heads, 1) if head in those]
        message = f"{quoted(m.head)} may be any of columns {', '.join(numbers)}: rename all but one"
        raise InputError(path, line, None, message)
    for head in heads:
        if (wrong := no_unit(head, unit_of(m.column))) and bracketed(head)[0] == m.name:
            raise InputError(path, line, None, _unknown(m.column, head, wrong))
    if all(_NUMBER.fullmatch(head.strip()) for head in heads):
        if m.name.isdecimal():
            expected = f"expected a column by its number, 1 to {len(heads)}, got {m.name}"
            raise InputError(path, line, None, expected)
        expected = "expected a line of heads above the numbers, such as X [mm],Z [mm]"
        raise InputError(path, line, None, f"{expected}; got {', '.join(heads[:20])}")
    there = ", ".join(head[:40] for head in heads[:20])
    message = f"no column {quoted(m.name)}{hint(m.name, heads)}; there are: {there}"
    raise InputError(path, line, None, message)
