"""How a table as ISO 230-2 has it is laid out: runs in columns, runs in rows, or a touch a line.

Each is turned into positions × runs.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from skiplatch.campaign.column_kinds import CellError
from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted
from skiplatch.importing.iso230_heads import is_negative, says_sense
from skiplatch.importing.model import Imported
from skiplatch.importing.spreadsheets import ANY_NUMBER, begins_with_a_word, tells
from skiplatch.importing.units_in_heads import bracketed, split_unit
from skiplatch.numbers import number

FEWEST_CELLS = 3  # of a line: a position and a run in either sense, or a sense beside both
_SIGN = re.compile(r"[A-Z]?[+-]|[+-]?1(?:\.0*)?", re.ASCII)
_COLUMNS: Mapping[str, re.Pattern[str]] = {
    name: re.compile(rf"(?<![^\W\d_])(?:{words})", re.IGNORECASE)
    for name, words in {
        "deviation": "dev|err|abw|fehler",
        "actual": r"actual|meas|ist(?![^\W\d_])|mess",
        "sense": r"sense|sign|dir(?:ection)?(?![^\W\d_])|richtung|sinn",
        "run": r"run|cycle|lauf|zyklus|repe|wiederhol|series|serie|no\.?$|nr\.?$",
        "position": r"pos|target|soll|nominal|ziel",
    }.items()
}
"""Of a list, by the words that begin in their heads; the first that holds counts."""


@dataclass(frozen=True, slots=True, eq=False)
class RunTable:
    """Positions × runs.

    Attributes:
        heads: Of the positions, and of each run.
        rows: The cells below them.
        lines: Where each of these stands in the file.
        in_order: Touches were made in the order of the lines.
    """

    heads: list[str]
    rows: list[list[str]]
    lines: list[list[int]]
    in_order: bool = False

    def without(self, dropped: set[int]) -> "RunTable":
        """Leave columns out."""
        kept = [i for i in range(len(self.heads)) if i not in dropped]
        heads, *rows = ([cells[i] for i in kept] for cells in (self.heads, *self.rows))
        return RunTable(heads, rows, [[own[i] for i in kept] for own in self.lines], self.in_order)


def is_head(cells: list[str], below: list[str]) -> bool:
    """Tell the head of a table of any layout by the line after it."""
    if len(cells) < 2 or len(below) != len(cells) or not any(below[1:]):
        return False
    if columns_of_list(cells):
        return True
    if _are_numbers(cells[1:]):
        return len(cells) >= FEWEST_CELLS and says_sense(below[0]) and _are_numbers(below[1:])
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
    if columns := columns_of_list(rows[0][1]):
        return _from_list(path, rows, columns, found)
    if _are_in_rows(rows):
        found.assumed.append("runs are in rows, positions in the head")
        return _from_rows(_rectangular(path, rows))
    return _from_columns(_rectangular(path, _without_lines_below(rows, found)))


def columns_of_list(heads: Sequence[str]) -> Mapping[str, int]:
    """Give which columns a list of touches has, by what they hold; none if it is no such list."""
    found: dict[str, int] = {}
    for i, head in enumerate(heads):
        name = bracketed(head)[0]
        kind = next((kind for kind, words in _COLUMNS.items() if words.search(name)), None)
        if kind in found:
            return {}
        if kind:
            found[kind] = i
    is_list = {"position", "sense"} <= found.keys() and found.keys() & {"deviation", "actual"}
    return found if is_list else {}


def _are_in_rows(rows: list[Row]) -> bool:
    (_, head), *body = rows
    return (
        len(head) >= FEWEST_CELLS
        and _are_numbers(head[1:])
        and any(says_sense(row[0]) for _, row in body)
    )


def _without_lines_below(rows: list[Row], found: Imported) -> list[Row]:
    last = len(rows)
    while last > 2 and begins_with_a_word(rows[last - 1][1]):
        last -= 1
    if last < len(rows):
        found.unread.append(f"lines below the table: {len(rows) - last}")
    return rows[:last]


def _rectangular(path: Path, rows: list[Row]) -> list[Row]:
    width = len(rows[0][1])
    for line, row in rows:
        if len(row) != width:
            raise InputError(path, line, None, f"expected {width} cells, got {len(row)}")
    return rows


def _from_columns(rows: list[Row]) -> RunTable:
    (_, heads), *body = rows
    return RunTable(heads, [row for _, row in body], [[line] * len(row) for line, row in body])


def _from_rows(rows: list[Row]) -> RunTable:
    """Turn a table on its side; a unit in its corner is that of the runs, if no position's."""
    columns = list(zip(*(row for _, row in rows), strict=True))
    heads, lines = [*columns[0]], [line for line, _ in rows]
    unit = split_unit(heads[0], "µm")[1]
    if unit and unit != "mm":
        heads = ["", *(f"{head} [{unit}]" for head in heads[1:])]
    return RunTable(heads, [[*cells] for cells in columns[1:]], [lines] * (len(columns) - 1))


@dataclass(frozen=True, slots=True)
class _TouchLine:
    """A line of a list, with one touch.

    Attributes:
        path: Of the list.
        line: Of the file.
        heads: Of the columns.
        row: The cells.
        columns: Which of them are there, by what they hold.
    """

    path: Path
    line: int
    heads: Sequence[str]
    row: Sequence[str]
    columns: Mapping[str, int]

    def number(self, kind: str) -> float:
        """Read a cell that has to be a number."""
        column = self.columns[kind]
        try:
            return float(ANY_NUMBER.parse([self.row[column]], required=True)[0])
        except CellError as error:
            raise InputError(self.path, self.line, self.heads[column], error.message) from error

    @property
    def is_negative(self) -> bool:
        """Tell whether the cell of the sense says the negative one."""
        cell = self.row[self.columns["sense"]]
        if not says_sense(cell) and not _SIGN.fullmatch(cell.replace("\u2212", "-")):
            message = f"expected a sense of motion, got {quoted(cell)}"
            raise InputError(self.path, self.line, None, message)
        return is_negative(cell)

    @property
    def deviation(self) -> str:
        """Give the deviation as it stands, or the way from the target to what was measured."""
        if "deviation" in self.columns:
            return self.row[self.columns["deviation"]]
        if not tells(self.row[self.columns["actual"]]):
            return ""
        return f"{self.number('actual') - self.number('position'):.9f}"


def _from_list(
    path: Path, rows: list[Row], columns: Mapping[str, int], found: Imported
) -> RunTable:
    """Gather touches that stand one in a line, a run and sense a column.

    Where no column numbers the runs, a place that is touched again begins the next one.
    """
    heads = rows[0][1]
    found.known.append("a touch in each line, in the order in which they were made")
    if ignored := [head for i, head in enumerate(heads) if i not in columns.values() and head]:
        found.unread.append(f"columns that are not needed: {', '.join(ignored)}")
    unit = split_unit(heads[columns["deviation"]], "µm")[1] if "deviation" in columns else "mm"
    met: Counter[tuple[float, bool]] = Counter()
    places: dict[float, dict[str, tuple[str, int]]] = {}
    runs: dict[str, None] = {}
    for line, row in _rectangular(path, rows)[1:]:
        touch = _TouchLine(path, line, heads, row, columns)
        place, negative = touch.number("position"), touch.is_negative
        met[place, negative] += 1
        run = row[columns["run"]] if "run" in columns else str(met[place, negative])
        name = f"run {run} {'-' if negative else '+'}{f' [{unit}]' if unit else ''}"
        if name in places.setdefault(place, {}):
            message = f"run {run} meets {place:g} in this sense twice"
            raise InputError(path, line, None, message)
        places[place][name] = touch.deviation, line
        runs[name] = None
    nothing = "", 0
    at = [[of.get(run, nothing) for run in runs] for of in places.values()]
    cells = [
        [repr(place), *(cell for cell, _ in row)] for place, row in zip(places, at, strict=True)
    ]
    lines = [[0, *(line for _, line in row)] for row in at]
    return RunTable([heads[columns["position"]], *runs], cells, lines, in_order=True)


def _are_numbers(cells: Sequence[str]) -> bool:
    return all(map(_is_number, cells))


def _is_number(cell: str) -> bool:
    try:
        number(cell.replace(",", "."))
    except ValueError:
        return not tells(cell)
    return True
