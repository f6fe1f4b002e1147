"""Logs of controllers that no reader knows, and what to do with them."""

import re
from collections.abc import Mapping

_TOUCHES: Mapping[str, re.Pattern[str]] = {
    "RepRapFirmware (Duet)": re.compile(r"Stopped at height -?[\d.]+ ?mm"),
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
_TABLE = "a head, such as Z [mm], for import csv --map coordinate_mm=Z --axis Z"


def advice(text: str) -> str:
    """Give what to do with a log of touches that is none of those that are read; else nothing."""
    if name := _name(text, _TOUCHES):
        how = f"put their coordinates into a table with {_TABLE}"
        return f"touches of {name}, whose logs are not read: {how}"
    if name := _name(text, _MAPS):
        how = f"touch one several times, and put its coordinates into a table with {_TABLE}"
        return f"a map of the bed by {name}, with one touch of each place: {how}"
    return ""


def _name(text: str, signs: Mapping[str, re.Pattern[str]]) -> str:
    return next((name for name, sign in signs.items() if sign.search(text)), "")
