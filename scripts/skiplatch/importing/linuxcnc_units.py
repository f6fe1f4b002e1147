"""In which unit a log of LinuxCNC begins, by what tells it.

LinuxCNC logs in the unit of the program, which begins in that of the machine. Where no G20 and no
G21 is at hand, a reading that no machine and no probe makes speaks for the other unit. Where that
tells nothing, either, mm is assumed, and said to be.
"""

import re
import statistics
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.importing.gcode_program import Row, Run
from skiplatch.importing.linuxcnc_ini import Ini
from skiplatch.importing.linuxcnc_rows import ProbeRows
from skiplatch.importing.model import Imported
from skiplatch.importing.probe_move import AXES, LINEAR, ProbeMove
from skiplatch.units import INCH, MM, MM_PER_INCH

UNITS_OPTION = "--units"
LIKELIEST = "ZYXABC"  # axes, where the coordinates of several look touched

FARTHEST_MM = 10_000.0
"""No machine that LinuxCNC moves reaches farther."""
SLOWEST_MM_MIN, FASTEST_MM_MIN = 1.0, 2500.0
"""Nobody probes slower or faster where a period of 1 ms passes between two looks."""
TIGHTEST_MM, WIDEST_MM = 0.0001, 0.1
"""Touches of a probe on a machine scatter by more, and by less."""

ROUND = 0.005  # what is programmed stands on multiples of this, what is touched does not
NEGLIGIBLE = 1e-4
_SAME_SURFACE = 0.6 / MM_PER_INCH  # apart in a row of coordinates, in either unit
_SAME_PLACE = 3  # decimals
_FEWEST_OF_SURFACE, _FEWEST = 4, 6  # touches from which on their scatter is known
_MAD_TO_SIGMA = 1.4826
_SAID_INCH = re.compile(r"\bG20\b|\binch(?:es)?\b", re.IGNORECASE)
_SAID_MM = re.compile(r"\bG21\b|\bmm\b|\bmillimet(?:re|er)s?\b", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Reason:
    """What speaks for a unit; no words where it is known."""

    is_inch: bool
    words: str = ""

    def say(self, found: Imported, *, inch: bool) -> None:
        """Say the unit that the moves were in, which is assumed where the log alone tells it."""
        if self.words:
            unit = INCH if inch else MM
            found.assume(f"coordinates in {unit}: {self.words}", UNITS_OPTION)
        else:
            found.known.append(f"the program's unit was the {INCH if inch else 'millimetre'}")


def unit_begun(
    path: Path,
    read: ProbeRows,
    runs: Mapping[bool, Run],
    axis: str,
    *,
    inch: bool | None,
    ini: Ini | None,
) -> Reason:
    """Give the unit that a program began in, where it matters.

    Args:
        path: The log.
        read: Its rows.
        runs: What the program does, by whether it begins in inches; none if it is not at hand.
        axis: What probed.
        inch: Whether it was the inch, if that is told.
        ini: Of the machine, if that is at hand.

    Raises:
        InputError: What tells it contradicts itself.
    """
    if inch is not None:
        return Reason(inch)
    in_mm = runs[False].moves if runs else ()
    if runs and [m.is_inch for m in in_mm] == [m.is_inch for m in runs[True].moves]:
        return Reason(is_inch=False)
    if said := unit_told(read.others):
        return said
    if ini:
        return Reason(ini.is_inch, "LINEAR_UNITS of the .ini, as no G20 or G21 says otherwise")
    if axis not in LINEAR and not in_mm:
        return Reason(is_inch=False, words=f"what {axis} was latched at is no length")
    return unit_shown(path, read.rows, in_mm)


def probed_axis(rows: Sequence[Row]) -> str:
    """Give the axis whose coordinates look touched rather than programmed."""

    def touched(number: int) -> int:
        return looks_touched([row[number] for row in rows if number < len(row)])

    return max(LIKELIEST, key=lambda axis: touched(AXES.index(axis)))


def unit_told(lines: Sequence[str]) -> Reason | None:
    """Give the unit that lines beside the coordinates name, if they name one alone."""
    named = {
        is_inch
        for line in lines
        for is_inch, said in ((True, _SAID_INCH), (False, _SAID_MM))
        if said.search(line)
    }
    if len(named) != 1:
        return None
    is_inch = named.pop()
    return Reason(is_inch, f"a line of the log says {INCH if is_inch else MM}")


def unit_shown(path: Path, rows: Sequence[Row], moves: Sequence[ProbeMove]) -> Reason:
    """Give the unit without which the log would be of no machine; mm where either could be.

    Args:
        path: The log.
        rows: Its coordinates.
        moves: The program's, as if it were in mm.

    Raises:
        InputError: Neither could be.
    """
    reasons = [*_by_reach(rows), *_by_feeds(moves), *_by_scatter(rows)]
    if not reasons:
        return Reason(is_inch=False, words="no G20, G21 or .ini tells another unit")
    if len({reason.is_inch for reason in reasons}) == 1:
        return reasons[0]
    message = (
        f"expected {UNITS_OPTION} {MM} or {UNITS_OPTION} {INCH}: no G20 or G21 tells the unit, and "
        "the touches could be in neither"
    )
    raise InputError(path, None, None, message)


def looks_touched(values: Sequence[float]) -> int:
    """Count the coordinates that nobody would have programmed."""
    multiples = (value / ROUND for value in values)
    return sum(abs(m - round(m)) > NEGLIGIBLE for m in multiples)


def _by_reach(rows: Sequence[Row]) -> Iterator[Reason]:
    farthest = max(abs(value) for row in rows for value in _linear(row))
    if farthest * MM_PER_INCH > FARTHEST_MM:
        yield Reason(
            is_inch=False,
            words=f"in inches the log would reach {farthest * MM_PER_INCH / 1e3:.0f} m",
        )


def _by_feeds(moves: Sequence[ProbeMove]) -> Iterator[Reason]:
    feeds = [move.feed for move in moves if move.feed]
    if not feeds:
        return
    least, most = min(feeds), max(feeds)
    if most * MM_PER_INCH > FASTEST_MM_MIN:
        words = f"in inches F{most:g} would be {most * MM_PER_INCH:.0f} mm/min"
        yield Reason(is_inch=False, words=words)
    if least < SLOWEST_MM_MIN:
        yield Reason(is_inch=True, words=f"F{least:g} is too slow in mm/min")


def _by_scatter(rows: Sequence[Row]) -> Iterator[Reason]:
    scatter = max(filter(None, map(_scatter, _touched(rows))), default=None)
    if scatter is None:
        return
    if scatter < TIGHTEST_MM:
        words = f"in mm the touches would scatter by {1e3 * scatter:.2g} µm alone"
        yield Reason(is_inch=True, words=words)
    if scatter * MM_PER_INCH > WIDEST_MM:
        words = f"in inches the touches would scatter by {1e3 * scatter * MM_PER_INCH:.0f} µm"
        yield Reason(is_inch=False, words=words)


def _touched(rows: Sequence[Row]) -> Iterator[list[list[float]]]:
    """Give for each axis that looks touched the touches of each surface, in their order."""
    for number, axis in enumerate(AXES):
        column = [row[number] for row in rows if number < len(row)]
        if axis in LINEAR and 2 * looks_touched(column) > len(column):
            yield list(_surfaces(rows, number))


def _surfaces(rows: Sequence[Row], number: int) -> Iterator[list[float]]:
    places: dict[tuple[float, ...], list[float]] = defaultdict(list)
    for row in rows:
        place = tuple(round(v, _SAME_PLACE) for i, v in enumerate(row) if i != number)
        places[place].append(row[number])
    for values in map(sorted, places.values()):
        ends = [i for i, (a, b) in enumerate(pairwise(values), 1) if b - a > _SAME_SURFACE]
        for begin, end in pairwise([0, *ends, len(values)]):
            yield values[begin:end]


def _scatter(surfaces: Sequence[Sequence[float]]) -> float | None:
    """Give σ about the middle of each surface, where enough touches tell it; outliers spared."""
    off = [
        abs(value - statistics.median(values))
        for values in surfaces
        if len(values) >= _FEWEST_OF_SURFACE
        for value in values
    ]
    return _MAD_TO_SIGMA * statistics.median(off) if len(off) >= _FEWEST else None


def _linear(row: Row) -> list[float]:
    return [value for axis, value in zip(AXES, row, strict=False) if axis in LINEAR]
