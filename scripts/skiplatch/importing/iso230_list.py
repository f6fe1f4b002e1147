"""Lists of touches of ISO 230-2, one in a line, with columns of position, sense and deviation."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from skiplatch.campaign.column_kinds import CellError
from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted
from skiplatch.importing.iso230_heads import is_negative, says_sense
from skiplatch.importing.iso230_run_table import COLUMNS_BY_HEAD, RunTable, rectangular
from skiplatch.importing.model import Imported
from skiplatch.importing.spreadsheets import ANY_NUMBER, tells
from skiplatch.importing.units_in_heads import bracketed, split_unit

_SIGN = re.compile(r"[A-Z]?[+-]|[+-]?1(?:\.0*)?", re.ASCII)


def columns_of_list(heads: Sequence[str]) -> Mapping[str, int]:
    """Give which columns a list of touches has, by what they hold; none if it is no such list."""
    found: dict[str, int] = {}
    for i, head in enumerate(heads):
        name = bracketed(head)[0]
        kind = next((kind for kind, words in COLUMNS_BY_HEAD.items() if words.search(name)), None)
        if kind in found:
            return {}
        if kind:
            found[kind] = i
    is_list = {"position", "sense"} <= found.keys() and found.keys() & {"deviation", "actual"}
    return found if is_list else {}


def tells_sense(cell: str) -> bool:
    """Tell whether a cell of a column of senses holds one: a word, an arrow or a sign."""
    return says_sense(cell) or bool(_SIGN.fullmatch(cell.replace("\u2212", "-")))


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
        if not tells_sense(cell):
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


def gathered(path: Path, rows: list[Row], columns: Mapping[str, int], found: Imported) -> RunTable:
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
    for line, row in rectangular(path, rows)[1:]:
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
