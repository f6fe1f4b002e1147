"""Units in the heads of a table's columns: ``Error [mm]``, ``Feed (in/min)``, ``error_mm``."""

import re
from collections.abc import Mapping

import numpy as np


def _of_inches(inch: float) -> dict[str, float]:
    """Give an inch, its thousandth and its millionth by their names."""
    thousandth, millionth = inch / 1e3, inch / 1e6
    whole = {"in": inch, "inch": inch, "mil": thousandth, "thou": thousandth}
    return {**whole, "µin": millionth, "uin": millionth}


UNITS: Mapping[str, Mapping[str, float]] = {
    "mm": {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "m": 1e3, **_of_inches(25.4)},
    "µm": {"µm": 1.0, "um": 1.0, "mm": 1e3, "m": 1e6, "nm": 1e-3, **_of_inches(25_400.0)},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "µs": {"µs": 1.0, "us": 1.0, "ms": 1e3, "s": 1e6, "ns": 1e-3},
    "mm/min": {"mm/min": 1.0, "mm/s": 60.0, "m/min": 1e3, "m/s": 6e4, "in/min": 25.4, "ipm": 25.4},
    "deg": {"deg": 1.0, "°": 1.0, "rad": 180.0 / np.pi, "arcsec": 1.0 / 3600.0},
    "arcsec": {
        "arcsec": 1.0,
        '"': 1.0,
        "″": 1.0,
        "sec": 1.0,
        "deg": 3600.0,
        "°": 3600.0,
        "rad": 180.0 * 3600.0 / np.pi,
        "mdeg": 3.6,
        "µrad": 0.18 * 3.6 / np.pi,
    },
    "°C": {"°C": 1.0, "C": 1.0, "degC": 1.0, "K": 1.0, "F": 5.0 / 9.0, "°F": 5.0 / 9.0},
}
"""By the unit of a campaign: what others are of it."""
BRACKETS = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<unit>[^\]]*)\]|\((?P<aside>[^)]*)\))$")
_GREEK_MU = "\u03bc"  # looks like the µ of UNITS


def bracketed(head: str) -> tuple[str, str]:
    """Take what stands in brackets off the end of a head; nothing where none do."""
    ending = BRACKETS.match(head)
    if ending is None:
        return head, ""
    unit = (ending["unit"] or ending["aside"] or "").strip()
    return ending["name"], unit.replace(_GREEK_MU, "µ")


def split_unit(head: str, unit: str) -> tuple[str, str]:
    """Take the unit off a head, in brackets or behind a blank or an underscore.

    Args:
        head: As it stands in the table.
        unit: Of the campaign's column; empty where it has none.

    Returns:
        The name and the unit as `UNITS` has it; the head and nothing where it names none of them.
    """
    head = head.replace(_GREEK_MU, "µ")
    name, found = bracketed(head)
    if found:
        named = [known for known in UNITS.get(unit, {}) if _same(found, known)]
        return (name, named[0]) if named else (head, "")
    for known in sorted(UNITS.get(unit, {}), key=len, reverse=True):
        before = head[: -len(known)]
        if before.strip(" _") and before[-1] in " _" and _same(head[len(before) :], known):
            return before.rstrip(" _"), known
    return head, ""


def _same(written: str, unit: str) -> bool:
    """Tell whether a unit is meant: controllers write capitals, and programs mm_s for mm/s."""
    return written.lower().replace("_", "/") == unit.lower()
