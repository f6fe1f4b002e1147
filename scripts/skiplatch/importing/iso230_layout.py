"""How a table as ISO 230-2 has it is laid out, each turned into positions × runs.

Runs stand in columns, their senses in the heads or in a line above these; or in rows, as in the
form of the standard; or each touch in a line.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted
from skiplatch.importing.iso230_heads import is_negative, says_sense
from skiplatch.importing.iso230_list import (
    columns_of_list,
    columns_where_places_repeat,
    gathered,
    tells_sense,
)
from skiplatch.importing.iso230_run_table import COLUMNS_BY_HEAD, RunTable, rectangular
from skiplatch.importing.model import Imported
from skiplatch.importing.spreadsheets import begins_with_a_word, tells
from skiplatch.importing.units_in_heads import split_unit
from skiplatch.numbers import number

FEWEST_CELLS = 3  # of a line: a position and a run in either sense, or a sense beside both
_SIGNS = ("+", "-", "\u2212")
_PLACE = re.compile(r"position|target|soll", re.IGNORECASE)
_NUMBERED = re.compile(r"\d\s*$", re.ASCII)  # of a run


def is_head(cells: list[str], below: list[str]) -> bool:
    """Tell the head of a table of any layout by the line after it."""
    if len(cells) < 2 or len(below) != len(cells) or not any(below[1:]):
        return False
    if columns_of_list(cells, below):
        return True
    if _is_above_senses(cells, below) or _are_merged_senses(cells, below):
        return True
    if labels := _labels_with_a_sense(cells):
        return _are_numbers(below[labels:])
    if _are_numbers(cells[1:]):
        return len(cells) >= FEWEST_CELLS and _names_a_run(below[0]) and _are_numbers(below[1:])
    return bool(below[0]) and _are_numbers(below) and not _are_numbers(cells[:1])


def laid_out(path: Path, rows: list[Row], found: Imported) -> RunTable:
    """Give a table of any layout, with its head first, as positions × runs.

    Raises:
        InputError: A row has another number of cells, or a list a touch without what it takes.
    """
    rows = [(line, [cell.strip() for cell in row]) for line, row in rows]
    rows = [row for row in rows if any(row[1])]
    if not rows:
        return RunTable([], [], [])
    first = rows[1][1] if len(rows) > 1 else []
    if columns := columns_of_list(rows[0][1], first) or columns_where_places_repeat(rows):
        return gathered(path, rows, columns, found)
    if len(rows) > 1 and _is_above_senses(rows[0][1], rows[1][1]):
        return _from_form(rectangular(path, rows), found)
    if len(rows) > 1 and _are_merged_senses(rows[0][1], rows[1][1]):
        rows = _with_senses(rows)
    if labels := _labels_with_a_sense(rows[0][1]):
        found.assumed.append("runs are in rows, positions in the head")
        return _from_rows(_with_sense_in_label(path, rectangular(path, rows), labels))
    if _are_in_rows(rows):
        found.assumed.append("runs are in rows, positions in the head")
        return _from_rows(rectangular(path, rows))
    table = _from_columns(rectangular(path, _without_lines_below(rows, found)))
    if _is_numbered(table):
        found.unread.append(f"a column that numbers the positions: {table.heads[0]}")
        return table.without({0})
    return table


def _labels_with_a_sense(cells: Sequence[str]) -> int:
    """Give how many columns tell of a run, a sense among them, left of positions; else 0."""
    labels = next((i for i, cell in enumerate(cells) if _is_number(cell)), 0)
    has_sense = any(map(COLUMNS_BY_HEAD["sense"].search, cells[:labels]))
    is_table = len(cells) > labels > 1 and _are_numbers(cells[labels:])
    return labels if has_sense and is_table else 0


def _with_sense_in_label(path: Path, rows: list[Row], labels: int) -> list[Row]:
    """Join the columns that tell of a run into one, which ends with an arrow for its sense."""
    (head_line, head), *body = rows
    at = next(i for i in range(labels) if COLUMNS_BY_HEAD["sense"].search(head[i]))
    joined = [(head_line, ["", *head[labels:]])]
    for line, row in body:
        if not tells_sense(row[at]):
            message = f"expected a sense of motion, got {quoted(row[at])}"
            raise InputError(path, line, head[at], message)
        names = [cell for i, cell in enumerate(row[:labels]) if i != at]
        label = f"{' '.join(names)} {'↓' if is_negative(row[at]) else '↑'}"
        joined.append((line, [label, *row[labels:]]))
    return joined


def _are_in_rows(rows: list[Row]) -> bool:
    (_, head), *body = rows
    return (
        len(head) >= FEWEST_CELLS
        and _are_numbers(head[1:])
        and any(_names_a_run(row[0]) for _, row in body)
    )


def _is_above_senses(cells: Sequence[str], below: Sequence[str]) -> bool:
    """Tell a line of positions above one of senses, as the form of ISO 230-2 has them."""
    return (
        len(below) == len(cells) >= FEWEST_CELLS
        and any(cells[1:])
        and _are_numbers(cells[1:])
        and all(map(says_sense, below[1:]))
    )


def _are_merged_senses(cells: Sequence[str], below: Sequence[str]) -> bool:
    """Tell a line of senses, each over several columns, above the heads of these."""
    over = [cell for cell in cells[1:] if cell]
    return (
        len(below) == len(cells) > len(over) + 1
        and bool(over)
        and all(map(says_sense, over))
        and all(below[1:])
        and not any(map(says_sense, below[1:]))
    )


def _filled(cells: Sequence[str]) -> list[str]:
    """Fill cells that were merged with the one before."""
    filled = list(cells[:1])
    for cell in cells[1:]:
        filled.append(cell or (filled[-1] if len(filled) > 1 else ""))
    return filled


def _with_senses(rows: list[Row]) -> list[Row]:
    """Join a line of senses with the heads below it."""
    (_, senses), (line, heads), *body = rows
    joined = [f"{head} {sense}" for head, sense in zip(heads, _filled(senses), strict=True)]
    return [(line, [heads[0], *joined[1:]]), *body]


def _from_form(rows: list[Row], found: Imported) -> RunTable:
    """Read the form of ISO 230-2: a line of positions, one of senses, and then a line a run."""
    (_, positions), (_, senses), *body = rows
    places = _filled(positions)
    runs = [row for row in body if _NUMBERED.search(row[1][0])]
    if others := [row[0] for _, row in body if not _NUMBERED.search(row[0])]:
        found.unread.append(f"lines that are no runs: {', '.join(others)}")
    kinds = list(dict.fromkeys(senses[1:]))
    heads = [f"{row[0]} {kind}" for _, row in runs for kind in kinds]
    at = {(place, kind): i for i, (place, kind) in enumerate(zip(places, senses, strict=True)) if i}
    table, lines = [], []
    for place in dict.fromkeys(places[1:]):
        cells = [at.get((place, kind)) for kind in kinds]
        table.append([place, *(row[i] if i else "" for _, row in runs for i in cells)])
        lines.append([rows[0][0], *(line for line, _ in runs for _ in kinds)])
    return RunTable([places[0], *heads], table, lines)


def _is_numbered(table: RunTable) -> bool:
    """Tell whether the first column numbers the rows, and the next one holds the positions."""
    numbers = [row[0] for row in table.rows]
    return (
        len(table.heads) >= FEWEST_CELLS
        and bool(COLUMNS_BY_HEAD["position"].search(table.heads[1]))
        and numbers == [str(i) for i in range(1, len(numbers) + 1)]
    )


def _without_lines_below(rows: list[Row], found: Imported) -> list[Row]:
    last = len(rows)
    while last > 2 and begins_with_a_word(rows[last - 1][1]):
        last -= 1
    if last < len(rows):
        found.unread.append(f"lines below the table: {len(rows) - last}")
    return rows[:last]


def _from_columns(rows: list[Row]) -> RunTable:
    (_, heads), *body = rows
    return RunTable(heads, [row for _, row in body], [[line] * len(row) for line, row in body])


def _from_rows(rows: list[Row]) -> RunTable:
    """Turn a table on its side; a unit in its corner is that of the runs, if no position's."""
    columns = list(zip(*(row for _, row in rows), strict=True))
    heads, lines = [*columns[0]], [line for line, _ in rows]
    unit = split_unit(heads[0], "µm")[1]
    if unit and (unit != "mm" or COLUMNS_BY_HEAD["deviation"].search(heads[0])):
        heads = ["", *(f"{head} [{unit}]" for head in heads[1:])]
    return RunTable(heads, [[*cells] for cells in columns[1:]], [lines] * (len(columns) - 1))


def _names_a_run(cell: str) -> bool:
    """Tell whether a line is a run, by its sense; a position is none, though it begins as one."""
    is_signed = cell.endswith(_SIGNS) and COLUMNS_BY_HEAD["run"].search(cell)
    return bool(says_sense(cell) or is_signed) and not _PLACE.search(cell)


def _are_numbers(cells: Sequence[str]) -> bool:
    return all(map(_is_number, cells))


def _is_number(cell: str) -> bool:
    try:
        number(cell.replace(",", "."))
    except ValueError:
        return not tells(cell)
    return True
