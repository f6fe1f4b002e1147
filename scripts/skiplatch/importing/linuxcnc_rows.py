"""The rows of a file that ``(PROBEOPEN …)`` makes, and which of them cannot be read.

LinuxCNC opens the file anew and writes over what stood there. What is left behind the new rows
begins with a stump, which may still have all its columns.
"""

import math
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.importing import height_maps
from skiplatch.importing.gcode_program import Row
from skiplatch.importing.log_lines import read_text
from skiplatch.importing.model import Imported
from skiplatch.importing.named_lines import named
from skiplatch.numbers import number

COLUMNS = 9
FEWEST = 3

_AS_PRINTED = re.compile(r"-?(?:0|[1-9][0-9]*)\.[0-9]{6}")
"""A number as LinuxCNC writes it, by ``%f``."""


@dataclass(frozen=True, slots=True)
class _Written:
    """A line that is not blank: its number, its words, and their values if all are numbers."""

    line: int
    words: list[str]
    values: Row


@dataclass(frozen=True, slots=True)
class ProbeRows:
    """What the file holds.

    Attributes:
        rows: Numbers of each row that was read.
        lines: Its line in the file.
        columns: How many numbers a row has.
        broken: Lines without that many numbers.
        stumps: Lines with a number that is not written as those of most others are.
        others: What stands in the lines without that many numbers.
        is_cut: The last line alone is one of these, and the file ends within it.
    """

    rows: list[Row]
    lines: list[int]
    columns: int
    broken: list[int]
    stumps: list[int]
    others: list[str]
    is_cut: bool = False

    def say(self, found: Imported) -> None:
        """Say which lines could not be read."""
        if self.broken:
            said = f"{len(self.broken)} lines that do not hold {self.columns} numbers"
            found.unread.append(f"{said}: {named(self.broken)}")
        if self.stumps:
            found.unread.append(
                f"{len(self.stumps)} rows with a number that is not written with six decimals, as "
                f"LinuxCNC writes them: {named(self.stumps)}"
            )


def read_rows(path: Path) -> ProbeRows:
    """Read the file.

    Raises:
        InputError: It cannot be read, or has no row.
    """
    text = read_text(path)
    if height_maps.is_height_map(height_maps.words_of(text)):
        raise InputError(path, None, None, height_maps.ADVICE)
    written = [
        _Written(place, line.split(), _values(line.split()))
        for place, line in enumerate(text.splitlines(), start=1)
        if line.strip()
    ]
    whole = [one for one in written if len(one.values) in (COLUMNS, FEWEST)]
    if not whole:
        expected = f"expected lines of {COLUMNS} numbers, as (PROBEOPEN {path.name}) writes them"
        raise InputError(path, None, None, expected)
    columns = _usual(whole, lambda one: len(one.values))
    kept = [one for one in whole if len(one.values) == columns]
    stumps = _stumps(kept)
    read = [one for one in kept if one.line not in stumps]
    lines = {one.line for one in kept}
    broken = [one.line for one in written if one.line not in lines]
    return ProbeRows(
        rows=[one.values for one in read],
        lines=[one.line for one in read],
        columns=columns,
        broken=broken,
        stumps=stumps,
        others=[" ".join(one.words) for one in written if one.line not in lines],
        is_cut=broken + stumps == [written[-1].line] and not text.endswith(("\r", "\n")),
    )


def _values(words: list[str]) -> Row:
    """Give the numbers of a line; none where a word is no number that is finite."""
    try:
        values = tuple(number(word) for word in words)
    except ValueError:
        return ()
    return values if all(map(math.isfinite, values)) else ()


def _usual(rows: list[_Written], of: Callable[[_Written], int]) -> int:
    """Give what most rows have; the larger one in doubt."""
    counts = Counter(map(of, rows))
    return max(counts, key=lambda value: (counts[value], value))


def _stumps(rows: list[_Written]) -> list[int]:
    """Give the lines of rows that are not written as most are; none where most are edited."""
    odd = [one.line for one in rows if not all(map(_AS_PRINTED.fullmatch, one.words))]
    return odd if len(odd) < len(rows) / 2 else []
