"""Heads of the columns of a table as ISO 230-2 has it: what is a run, in which sense and unit."""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.importing.spreadsheets import WORKED_OUT
from skiplatch.importing.units_in_heads import UNITS, bracketed, split_unit
from skiplatch.units import UM_PER_MM

_NEGATIVE = re.compile(
    r"↓|←|(?<![^\W\d_])(?:down|rev|neg|back|bwd|minus|r(?:ü|ue)ck|zur(?:ü|ue)ck|ccw|anti|counter)",
    re.IGNORECASE,
)
_POSITIVE = re.compile(
    r"↑|→|(?<![^\W\d_])(?:up|fwd|forw|pos|plus|vor|hin|cw|clockw)", re.IGNORECASE
)
_MINUS = re.compile(r"(?<!\w)[-\u2212]|[-\u2212](?!\w)")
"""No hyphen, as that of run-1 is."""
_SENSE = r"[ _]?(?:[↑↓+\-\u2212]|up|down|fwd|bwd|rev)?"
_SYMBOL = re.compile(rf"[24]?[ABEMRSUs]\u0304?_?[i\u1d62]?{_SENSE}")
"""Of results, as ISO 230-2 names them: of reversal, scatter, repeatability, accuracy."""
_LETTERED = re.compile(rf"[A-Za-z]{_SENSE}")
_ANY_UNIT = set().union(*UNITS.values())
POSITION_UNITS = {"mm": {"mm"}, "deg": {"deg", "°"}}
RUN_UNITS = {
    "µm": {"µm": 1.0, "um": 1.0, "mm": UM_PER_MM},
    "arcsec": UNITS["arcsec"],
}
"""What deviations may be in, and how many µm or arcsec that is."""
SAME_UNIT = {"um": "µm", "°": "deg", '"': "arcsec", "″": "arcsec", "sec": "arcsec"}
"""Other names of units."""


def is_negative(head: str) -> bool:
    """Tell whether a run is in the negative sense."""
    if _NEGATIVE.search(head):
        return True
    return bool(_MINUS.search(head)) and not _POSITIVE.search(head)


def says_sense(head: str) -> bool:
    """Tell whether words or an arrow name a sense; a sign alone may be that of a number."""
    return bool(_NEGATIVE.search(head) or _POSITIVE.search(head))


def no_runs(heads: Sequence[str]) -> set[int]:
    """Give which columns hold what was worked out of the runs; the first holds positions.

    Letters are symbols of results only where the runs are not told apart by letters.
    """
    names = [bracketed(head.strip())[0] for head in heads]
    worked_out = {i for i, name in enumerate(names) if i and WORKED_OUT.search(name)}
    symbols = {i for i, name in enumerate(names) if i and _SYMBOL.fullmatch(name)} - worked_out
    runs = set(range(1, len(heads))) - worked_out - symbols
    if not runs or any(_LETTERED.fullmatch(names[i]) for i in runs):
        symbols = set()
    dropped = worked_out | symbols
    return dropped if len(dropped) < len(heads) - 1 else set()


def unit_said(path: Path, line: int, heads: Sequence[str], *, turns: bool) -> str | None:
    """Give the unit that the heads of the runs name; None where they name none.

    Args:
        path: Of the table.
        line: Of its head.
        heads: Of the positions and of the runs.
        turns: Whether the axis is a rotary one.

    Raises:
        InputError: One of the columns is in another unit than can be.
    """
    of_runs, of_positions = ("arcsec", "deg") if turns else ("µm", "mm")
    named = set()
    for number, head in enumerate(heads):
        # The head of the positions may be nothing but a unit.
        of, text = (of_runs, head) if number else (of_positions, f"position {head}")
        found = _unit_of(text, of)
        if found and found not in (RUN_UNITS[of] if number else POSITION_UNITS[of]):
            what = f"runs with deviations in {of} or {'deg' if turns else 'mm'}"
            expected = what if number else f"positions in {of}"
            message = f"expected {expected}, got {quoted(head)}"
            raise InputError(path, line, None, message)
        if number and found:
            named.add(SAME_UNIT.get(found, found))
    if len(named) > 1:
        units = " and ".join(sorted(named))
        raise InputError(path, line, None, f"expected all runs in one unit, got {units}")
    return next(iter(named), None)


def _unit_of(head: str, expected: str) -> str:
    """Give the unit that a head ends with, expected or not; else nothing."""
    stated = bracketed(head)[1]
    units = (split_unit(head, of)[1] for of in (expected, "mm", "mm/min"))
    return next(filter(None, units), stated if stated in _ANY_UNIT else "")


def unit_in_title(title: Sequence[str], *, turns: bool) -> str | None:
    """Give the unit that a title names, as in "all values in mm"; None where it names none."""
    units = "|".join(map(re.escape, RUN_UNITS["arcsec" if turns else "µm"]))
    words = rf"\b(?:in|unit|units|einheit)\W{{1,3}}(?P<unit>{units}|micromet\w+)(?!\w)"
    text = "\n".join(title).replace("\u03bc", "µ")
    named = (match["unit"].lower() for match in re.finditer(words, text, re.IGNORECASE))
    found = {"µm" if unit.startswith("micro") else SAME_UNIT.get(unit, unit) for unit in named}
    return found.pop() if len(found) == 1 else None
