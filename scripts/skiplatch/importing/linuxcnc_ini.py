"""The INI file of a LinuxCNC: the unit that its programs begin in, and the servo period."""

import math
import re
from dataclasses import dataclass
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.importing.log_lines import read_text
from skiplatch.numbers import number
from skiplatch.units import MM_PER_INCH

_SECTION = re.compile(r"\s*\[(\w+)\]")
_KEY = re.compile(r"\s*(\w+)\s*=\s*([^#;\s]*)")
_UNITS = {"mm": False, "metric": False, "in": True, "inch": True, "imperial": True}
_PERIOD_NS = (1e4, 1e8)
_NEAR = 1e-3
_NS_PER_US = 1e3


@dataclass(frozen=True, slots=True)
class Ini:
    """What a probe log does not say of its machine.

    Attributes:
        is_inch: Programs begin in inches: [TRAJ] LINEAR_UNITS.
        servo_us: [EMCMOT] SERVO_PERIOD; None if the file has none.
    """

    is_inch: bool
    servo_us: float | None


def read_ini(path: Path) -> Ini:
    """Read the INI file of a machine.

    Raises:
        InputError: It cannot be read, or does not tell the unit.
    """
    keys = _keys(read_text(path, "the INI file of a LinuxCNC"))
    if ("TRAJ", "LINEAR_UNITS") not in keys:
        raise InputError(path, None, None, "expected LINEAR_UNITS in [TRAJ], found none")
    line, word = keys["TRAJ", "LINEAR_UNITS"]
    is_inch = _unit(word)
    if is_inch is None:
        message = f'expected LINEAR_UNITS = mm or inch, got "{word[:20]}"'
        raise InputError(path, line, None, message)
    period = keys.get(("EMCMOT", "SERVO_PERIOD"))
    return Ini(is_inch, None if period is None else _period_us(path, *period))


def _keys(text: str) -> dict[tuple[str, str], tuple[int, str]]:
    """Give line and value of each key by its section; of several the first, as LinuxCNC does."""
    found: dict[tuple[str, str], tuple[int, str]] = {}
    section = ""
    for at, line in enumerate(text.splitlines(), start=1):
        if begun := _SECTION.match(line):
            section = begun[1]
        elif key := _KEY.match(line):
            found.setdefault((section, key[1]), (at, key[2]))
    return found


def _unit(word: str) -> bool | None:
    """Tell whether a word, or the number of units in a mm, is that of inches."""
    if (told := _UNITS.get(word.lower())) is not None:
        return told
    try:
        units_a_mm = number(word)
    except ValueError:
        return None
    near = (is_inch for is_inch in (False, True) if _is_near(units_a_mm, is_inch=is_inch))
    return next(near, None)


def _is_near(units_a_mm: float, *, is_inch: bool) -> bool:
    return math.isclose(units_a_mm, 1.0 / MM_PER_INCH if is_inch else 1.0, rel_tol=_NEAR)


def _period_us(path: Path, line: int, word: str) -> float:
    try:
        period_ns = number(word)
    except ValueError:
        period_ns = math.nan
    least, most = _PERIOD_NS
    if not least <= period_ns <= most:
        message = f'expected SERVO_PERIOD in ns, {least:.0f} to {most:.0f}, got "{word[:20]}"'
        raise InputError(path, line, None, message)
    return period_ns / _NS_PER_US
