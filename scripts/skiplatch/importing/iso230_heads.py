"""Heads of the columns of a table as ISO 230-2 has it: what is a run, in which sense and unit."""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.importing.spreadsheets import WORKED_OUT
from skiplatch.importing.units_in_heads import UNITS, bracketed, split_unit

_NEGATIVE = re.compile(
    r"↓|←|(?<![^\W\d_])(?:down|rev|neg|back|minus|r(?:ü|ue)ck|zur(?:ü|ue)ck)", re.IGNORECASE
)
_POSITIVE = re.compile(r"↑|→|(?<![^\W\d_])(?:up|fwd|forw|pos|plus|vor|hin)", re.IGNORECASE)
_MINUS = re.compile(r"(?<!\w)[-\u2212]|[-\u2212](?!\w)")
"""No hyphen, as that of run-1 is."""
_SENSE = r"[ _]?(?:[↑↓+\-\u2212]|up|down|fwd|rev)?"
_SYMBOL = re.compile(rf"[24]?[ABEMRSUs]\u0304?_?[i\u1d62]?{_SENSE}")
"""Of results, as ISO 230-2 names them: of reversal, scatter, repeatability, accuracy."""
_LETTERED = re.compile(rf"[A-Za-z]{_SENSE}")
_OTHER_UNITS = set().union(*(UNITS[quantity] for quantity in ("s", "mm/min", "°C")))
"""Of what is no deviation; none of them is a unit of length or of angle."""


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


def says_mm(path: Path, line: int, heads: Sequence[str]) -> bool | None:
    """Tell whether the heads of the runs say mm rather than µm; None where they name no unit.

    Raises:
        InputError: One of the columns is in another unit than can be.
    """
    heads = [head.strip() for head in heads]
    lengths = [split_unit(head, "mm")[1] for head in heads]
    lengths[0] = split_unit(f"position {heads[0]}", "mm")[1]  # its head may be nothing but a unit
    for number, (head, length) in enumerate(zip(heads, lengths, strict=True)):
        unit = bracketed(head)[1] or split_unit(head, "mm/min")[1]
        allowed = {"", "mm", "µm", "um"} if number else {"", "mm"}
        if unit in _OTHER_UNITS or length not in allowed:
            what = "runs with deviations" if number else "positions"
            message = f"expected {what}, got a column in {unit or length}: {quoted(head)}"
            raise InputError(path, line, None, message)
    named = {length == "mm" for length in lengths[1:] if length}
    if len(named) > 1:
        raise InputError(path, line, None, "expected all runs in one unit, got mm and µm")
    return next(iter(named), None)
