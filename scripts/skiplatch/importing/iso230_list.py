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

_NUMBER_OF = re.compile(
    r"[\W_]*(?:(?<![^\W\d_])(?:no|nr|num|number|nummer|idx|index)\.?|#)$", re.IGNORECASE
)
"""What ends the head of a column that numbers what stands before it."""
_RUNS = COLUMNS_BY_HEAD["run"]
_BARE_SENSES = ("+", "-", "\u2212", "↑", "↓", "→", "←")
"""Cells that can be nothing else."""
_UNITS_OF_DEVIATIONS = ("µm", "um", "arcsec", '"', "″")
"""In which nobody tells a position."""
_SIGN = re.compile(r"[A-Z]?[+-]|[+-]?1(?:\.0*)?", re.ASCII)


def columns_of_list(heads: Sequence[str], below: Sequence[str] = ()) -> Mapping[str, int]:
    """Give which columns a list of touches has, by what they hold; none if it is no such list.

    It tells the sense or the run of each; a head such as Run 1 is that of a run itself.
    """
    found = _columns(heads, below)
    is_numbered = "run" in found and bool(_RUNS.search(_stem(heads[found["run"]])))
    return found if "sense" in found or is_numbered else {}


def columns_where_places_repeat(rows: Sequence[Row]) -> Mapping[str, int]:
    """Give them of a table with one value a row, some of whose positions come again."""
    (_, heads), *body = rows
    found = _columns(heads, body[0][1] if body else ())
    has_runs = any(says_sense(head) for i, head in enumerate(heads) if i not in found.values())
    if not found or has_runs:
        return {}
    places = [row[found["position"]] for _, row in body if len(row) == len(heads)]
    return found if len(set(places)) < len(places) else {}


def _columns(heads: Sequence[str], below: Sequence[str]) -> dict[str, int]:
    """Give what columns hold; nothing if two hold the same, or none a position or a value.

    Where no head does, signs or arrows below it tell that of the senses, and its unit that of the
    deviations, whatever the language.
    """
    found: dict[str, int] = {}
    for i, head in enumerate(heads):
        kind = _kind(bracketed(head)[0])
        if kind in found:
            return {}
        if kind:
            found[kind] = i
    others = [i for i in range(len(heads)) if i not in found.values()]
    senses = [i for i in others if "".join(below[i : i + 1]).strip() in _BARE_SENSES]
    deviations = [i for i in others if bracketed(heads[i])[1] in _UNITS_OF_DEVIATIONS]
    if len(senses) == 1:
        found.setdefault("sense", senses[0])
    if len(deviations) == 1 and "actual" not in found:
        found.setdefault("deviation", deviations[0])
    has_both = "position" in found and found.keys() & {"deviation", "actual"}
    return found if has_both else {}


def _kind(name: str) -> str | None:
    """Give what a column holds; a number of a target is no target, and one of nothing a run's."""
    if _NUMBER_OF.search(name):
        stem = _stem(name)
        return "run" if not stem or _RUNS.search(stem) else None
    return next((kind for kind, words in COLUMNS_BY_HEAD.items() if words.search(name)), None)


def _stem(head: str) -> str:
    """Give what a head numbers, or the head if it says no number; nothing of Run 1."""
    stem = _NUMBER_OF.sub("", bracketed(head)[0])
    return "" if stem[-1:].isdigit() else stem


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
    def run(self) -> str:
        """Give what a column calls the run; empty where none does."""
        return self.row[self.columns["run"]] if "run" in self.columns else ""

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
    body = rectangular(path, rows)[1:]
    columns = _without_numbers_of_lines(columns, body)
    found.known.append("a touch in each line, in the order in which they were made")
    if ignored := [head for i, head in enumerate(heads) if i not in columns.values() and head]:
        found.unread.append(f"columns that are not needed: {', '.join(ignored)}")
    touches = [_TouchLine(path, line, heads, row, columns) for line, row in body]
    negative = _are_negative(touches, found)
    unit = split_unit(heads[columns["deviation"]], "µm")[1] if "deviation" in columns else "mm"
    met: Counter[tuple[float, bool]] = Counter()
    places: dict[float, dict[str, tuple[str, int]]] = {}
    runs: dict[str, None] = {}
    for touch, is_back in zip(touches, negative, strict=True):
        place = touch.number("position")
        met[place, is_back] += 1
        run = touch.run or str(met[place, is_back])
        name = f"run {run} {'-' if is_back else '+'}{f' [{unit}]' if unit else ''}"
        if name in places.setdefault(place, {}):
            message = f"run {run} meets {place:g} in this sense twice"
            raise InputError(path, touch.line, None, message)
        places[place][name] = touch.deviation, touch.line
        runs[name] = None
    nothing = "", 0
    at = [[of.get(run, nothing) for run in runs] for of in places.values()]
    cells = [
        [repr(place), *(cell for cell, _ in row)] for place, row in zip(places, at, strict=True)
    ]
    lines = [[0, *(line for _, line in row)] for row in at]
    return RunTable([heads[columns["position"]], *runs], cells, lines, in_order=True)


def _without_numbers_of_lines(columns: Mapping[str, int], body: Sequence[Row]) -> dict[str, int]:
    """Leave out a column of runs in which no number comes again: it numbers the lines."""
    kept = dict(columns)
    if "run" in kept and len({row[kept["run"]] for _, row in body}) == len(body):
        del kept["run"]
    return kept


def _are_negative(touches: Sequence[_TouchLine], found: Imported) -> list[bool]:
    """Tell which touches were in the negative sense: as a column says, or else by their ways.

    One that no way of its run leads to has the sense of the way to the next.
    """
    if all("sense" in touch.columns for touch in touches):
        return [touch.is_negative for touch in touches]
    found.assumed.append(
        "no column tells the sense: it is that of the way from the line before in the same run"
    )
    next_way: dict[str, int] = {}
    told = []
    for touch, way in zip(reversed(touches), reversed(_ways(touches)), strict=True):
        told.append((way or next_way.get(touch.run, 0)) < 0)
        next_way[touch.run] = way
    return told[::-1]


def _ways(touches: Sequence[_TouchLine]) -> list[int]:
    """Give on which side the target before in the same run lies: 1 where it is the next lower one.

    It is 0 where a run begins, or goes on from elsewhere.
    """
    targets = sorted({touch.number("position") for touch in touches})
    number_of = {target: i for i, target in enumerate(targets)}
    before: dict[str, int] = {}
    ways = []
    for touch in touches:
        here = number_of[touch.number("position")]
        way = here - before.get(touch.run, here)
        ways.append(way if abs(way) == 1 else 0)
        before[touch.run] = here
    return ways
