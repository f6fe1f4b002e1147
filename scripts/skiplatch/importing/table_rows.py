"""Which rows of a table tell of touches, and whether each has the cells of its head."""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.campaign import COLUMNS
from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted
from skiplatch.importing import height_maps
from skiplatch.importing.dialects import advice
from skiplatch.importing.mapped import COORDINATE, Mapped, named_in
from skiplatch.importing.model import Imported
from skiplatch.importing.named_lines import named
from skiplatch.importing.spreadsheets import tells
from skiplatch.numbers import NUMBER

_NUMBER = re.compile(rf"{NUMBER}|[-+]?[0-9]*,[0-9]+")
"""With a decimal comma too, as cells are looked at before these are points."""
_ROWS = 20  # from the head on, that are looked at

_OUTCOMES = {COORDINATE, "edge_us", *(name for name in COLUMNS if COLUMNS[name].is_outcome)}
"""Columns that tell what came of a touch."""


def touched(
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


def with_numbers(rows: list[Row], mapped: Sequence[Mapped], found: Imported) -> list[Row]:
    """Put the numbers of the columns, from 1, above measured ones that are mapped by these."""
    if not (rows and are_by_number(mapped)):
        return rows
    if not (is_measured(rows[0][1]) or begins_numbers(rows[0][1], mapped)):
        return rows
    line, first = rows[0]
    found.assumed.append("columns go by their numbers from 1, as the table has no head")
    return [(line, [str(i) for i, _ in enumerate(first, start=1)]), *rows]


def are_by_number(mapped: Sequence[Mapped]) -> bool:
    """Tell whether each column is mapped by a number, ``3`` or ``3 [in]``."""
    return all(m.name.isdecimal() for m in mapped)


def begins_numbers(row: list[str], mapped: Sequence[Mapped]) -> bool:
    """Tell numbers where columns are mapped by theirs; 1, 2 and 3 themselves are heads.

    A 3 among measured numbers names no column. What has fewer cells is a line above them.
    """
    if not are_by_number(mapped) or len(row) < max(int(m.name) for m in mapped):
        return False
    is_named = all(named_in(row, m) for m in mapped)
    return is_measured(row) or (2 * len(_numbers(row)) > len(row) and not is_named)


def is_measured(row: Sequence[str]) -> bool:
    """Tell numbers, decimals among them, from heads, which may be whole numbers."""
    numbers = _numbers(row)
    return 2 * len(numbers) > len(row) and any("." in number or "," in number for number in numbers)


def _numbers(row: Sequence[str]) -> list[str]:
    return [cell for cell in row if _NUMBER.fullmatch(cell.strip())]


def refuse_no_head(path: Path, rows: Sequence[Row], title: Sequence[str]) -> None:
    """Refuse numbers in place of names, and what is no list of touches, such as a map of the bed.

    Columns may be numbered 1, 2, 3; numbers with decimals among them are measured ones.

    Raises:
        InputError: It is one.
    """
    line, heads = rows[0][0], [head.strip() for head in rows[0][1]]
    if said := advice("\n".join([*title, *heads, *(" ".join(row) for _, row in rows[1:_ROWS])])):
        raise InputError(path, None, None, said)
    above = [line.split() for line in title if line.strip()]
    for first in (0, 1):  # the numbers of the columns may have been put above
        if height_maps.is_height_map([*above, *(row for _, row in rows[first:_ROWS] if any(row))]):
            raise InputError(path, None, None, height_maps.ADVICE)
    if is_measured(heads):
        expected = "expected a line of heads above the numbers, such as X [mm],Z [mm]"
        expected += ", or columns by number, --map coordinate_mm=3"
        raise InputError(path, line, None, f"{expected}; got {', '.join(heads[:20])}")


def say_short(
    heads: Sequence[str], body: Sequence[Row], mapped: Sequence[Mapped], found: Imported
) -> None:
    """Say which rows end before a column that is mapped; what they lack counts as empty."""
    last = max(heads.index(m.head) for m in mapped)
    short = [line for line, row in body if len(row) <= last]
    if short:
        said = f"rows shorter than the head, whose last cells count as empty: {len(short)}"
        found.assumed.append(f"{said}, {named(short)}")


def refuse_surplus(path: Path, heads: Sequence[str], body: Sequence[Row]) -> None:
    """Refuse a row with more cells than heads, as decimal commas without quotes make them.

    Empty cells behind the last head are none; ones that lack behind a row's last are empty.

    Raises:
        InputError: The first one.
    """
    for line, row in body:
        filled = max((i for i, cell in enumerate(row, 1) if cell.strip()), default=0)
        if filled > len(heads):
            message = f"expected {len(heads)} cells, got {filled}: are there decimal commas?"
            raise InputError(path, line, None, message)


def say_empty(
    heads: Sequence[str], body: Sequence[Row], mapped: Sequence[Mapped], found: Imported
) -> None:
    """Say which cells hold a word that stands for nothing, as NaN or n/a."""
    places = {heads.index(m.head) for m in mapped}
    words = [
        (line, cell.strip())
        for line, row in body
        for i, cell in enumerate(row)
        if i in places and cell.strip() and not tells(cell)
    ]
    if words:
        line, word = words[0]
        first = f"the first {quoted(word)} in line {line}"
        found.assumed.append(f"cells that count as empty: {len(words)}, {first}")
