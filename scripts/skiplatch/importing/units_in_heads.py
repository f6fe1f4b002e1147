"""Units in the heads of a table's columns: ``Error [mm]``, ``Feed (in/min)``, ``error_mm``."""

import re
from collections.abc import Mapping

import numpy as np


def _of_inches(inch: float) -> dict[str, float]:
    """Give an inch, its thousandth and its millionth by their names."""
    thousandth, millionth = inch / 1e3, inch / 1e6
    whole = {"in": inch, '"': inch, "″": inch, "mil": thousandth, "thou": thousandth}
    return {**whole, "µin": millionth, "uin": millionth}


_ANGLES = {"deg": 1.0, "°": 1.0}
_TURNING = {"deg/min": 1.0, "°/min": 1.0, "deg/s": 60.0, "°/s": 60.0, "rpm": 360.0}
TURNED = {**_ANGLES, **_TURNING}
"""Of a way and a feed of a rotary axis, of which a degree counts as a millimetre."""
OF_A_WAY = "mm or deg"


_LENGTHS = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "m": 1e3, **_of_inches(25.4)}
UNITS: Mapping[str, Mapping[str, float]] = {
    "mm": _LENGTHS,
    OF_A_WAY: {**_LENGTHS, **_ANGLES},
    "µm": {"µm": 1.0, "um": 1.0, "mm": 1e3, "m": 1e6, "nm": 1e-3, **_of_inches(25_400.0)},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "µs": {"µs": 1.0, "us": 1.0, "ms": 1e3, "s": 1e6, "ns": 1e-3},
    "mm/min": {
        "mm/min": 1.0,
        "mm/s": 60.0,
        "m/min": 1e3,
        "m/s": 6e4,
        "in/min": 25.4,
        "ipm": 25.4,
        "in/s": 1524.0,
        **_TURNING,
    },
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
"""By the unit of a campaign: what others are of it. A way of a rotary axis is an angle."""
_SYMBOLS = {
    "mm": r"millimet(?:re|er)s?",
    "µm": r"um|microns?|micromet(?:re|er)s?",
    "in": r"inch(?:es)?",
    "mil": r"mils",
    "s": r"secs?|seconds?",
    "ms": r"msecs?|milliseconds?",
    "µs": r"us|[uµ]secs?|microseconds?",
    "min": r"mins|minutes?",
    "h": r"hrs?|hours?",
    "deg": r"degrees?",
}
"""Words for units, which may stand in a rate as well: ``mm/sec``, ``inches per minute``."""
_WORDS = [(re.compile(words), symbol) for symbol, words in _SYMBOLS.items()]
_PER = re.compile(r"\s*(?:/|_|\bper\b)\s*")
_BREAKS = " _,"
"""One of them stands before a unit without brackets: ``Z mm``, ``z_mm``, ``Z, mm``."""
BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]$")
_GREEK_MU = "\u03bc"  # looks like the µ of UNITS


def bracketed(head: str) -> tuple[str, str]:
    """Take what stands in brackets off the end of a head; nothing where none do."""
    ending = BRACKETS.match(head)
    if ending is None:
        return head, ""
    return ending["name"], ending["unit"].strip().replace(_GREEK_MU, "µ")


def split_unit(head: str, unit: str) -> tuple[str, str]:
    """Take the unit off a head: in brackets, or behind a blank, an underscore or a comma.

    Args:
        head: As it stands in the table.
        unit: Of the campaign's column; empty where it has none.

    Returns:
        The name and the unit as `UNITS` has it; the head and nothing where it names none of them.
    """
    head = head.replace(_GREEK_MU, "µ")
    name = head
    while BRACKETS.match(name):
        name, found = bracketed(name)
        if known := _known(found, unit):
            return name.rstrip(" _,/"), known
    if name != head:
        return head, ""
    for at, letter in enumerate(head):
        if letter in _BREAKS and head[:at].strip(_BREAKS) and (known := _known(head[at:], unit)):
            return head[:at].rstrip(_BREAKS), known
    return head, ""


def no_unit(head: str, unit: str) -> str:
    """Give what stands in brackets at the end of a head that should be a unit and is none."""
    units = UNITS.get(unit)
    return bracketed(head)[1] if units and not split_unit(head, unit)[1] else ""


def _known(written: str, unit: str) -> str:
    """Give the unit that is meant; empty where it is none.

    Controllers write capitals, and programs mm_s for mm/s.
    """
    plain = _PER.sub("/", written.lower().strip(" _,"))
    symbols = "/".join(map(_symbol, plain.split("/")))
    units = {known.lower(): known for known in UNITS.get(unit, ())}
    return units.get(plain) or units.get(symbols, "")


def _symbol(word: str) -> str:
    return next((symbol for words, symbol in _WORDS if words.fullmatch(word)), word)
