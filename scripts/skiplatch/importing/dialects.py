"""Whose touches a log holds, and what to do with those that no reader knows."""

import re
from collections.abc import Mapping

from skiplatch.importing import height_maps
from skiplatch.importing.duet_touches import STOPPED

READ: Mapping[str, re.Pattern[str]] = {
    "grbl": re.compile(r"\[PRB:"),
    "klipper": re.compile(
        r"probe(?:: at| at) -?[\d.]+,|\bTouch \d+(?: of \d+)?: -?\d+\.\d{4}|"
        r"\bMeasurements gathered: ",
        re.IGNORECASE,
    ),
    "marlin": re.compile(rf"(?<!\d)\d{{1,6}} of \d{{1,6}}:?\s*z:|(?i:Bed X:)|{STOPPED}"),
    "linuxcnc": re.compile(
        r"^[ \t]*(?:(?:-?\d+\.\d+[ \t]+){8}-?\d+\.\d+"
        r"|(?:-?\d+\.\d{6}[ \t]+){2}-?\d+\.\d{6})[ \t]*$",
        re.MULTILINE,
    ),
}
"""What a touch looks like in a log that `skiplatch import` reads, by the kind that it is called."""
_TOUCHES: Mapping[str, re.Pattern[str]] = {
    "TinyG or g2core": re.compile(r'\{"prb":'),
    "Smoothieware": re.compile(r"\bZ:-?[\d.]+ C:-?\d+\s*$", re.MULTILINE),
    "Repetier-Firmware": re.compile(r"Z-probe:\s*-?[\d.]+ X:"),
    "Prusa's Buddy firmware": re.compile(r"Probe classified as|echo:Starting probe at \d"),
}
"""What a touch looks like there."""
_MAPS: Mapping[str, re.Pattern[str]] = {
    "RepRapFirmware (Duet)": re.compile(r"Bed probe heights:|RepRapFirmware height map"),
    "Smoothieware": re.compile(r"\bprobe at -?[\d.]+,\s*-?[\d.]+ is -?[\d.]+ mm\b"),
    "Prusa's firmware": re.compile(r"\bNum X,Y:\s*\d+,\d+"),
    "Repetier-Firmware": re.compile(r"CurrentZ:-?[\d.]+ atZ:|Z-probe average height:"),
}
"""What a map of the bed looks like, which is worked out of one touch of each place."""
_FEATURE = re.compile(r"\b(?:POSN|SIZE)\s+[XYZD]\s*-?[\d.]+\s+ACTUAL\s+-?[\d.]+")
"""What Renishaw's Inspection Plus and Productivity+ print of a feature."""
_TABLE = "a head, such as Z [mm], for import csv --map coordinate_mm=Z --axis Z"


def advice(text: str) -> str:
    """Give what to do with a log of touches that no importer reads; empty where nothing tells."""
    if height_maps.is_height_map(height_maps.words_of(text)):
        return height_maps.ADVICE
    if name := _name(text, _TOUCHES):
        how = f"put their coordinates into a table with {_TABLE}"
        return f"touches of {name}, whose logs are not read: {how}"
    if _FEATURE.search(text):
        how = "print where each touch was latched, as DPRNT[X#5061[44]] does, for import csv"
        return f"a report of features, each worked out of several touches: {how}"
    if name := _name(text, _MAPS):
        how = f"touch one several times, and put its coordinates into a table with {_TABLE}"
        return f"a map of the bed by {name}, with one touch of each place: {how}"
    return ""


def _name(text: str, signs: Mapping[str, re.Pattern[str]]) -> str:
    return next((name for name, sign in signs.items() if sign.search(text)), "")
