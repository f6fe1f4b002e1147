"""Logs of controllers that no reader knows, and what to do with them."""

import re
from collections.abc import Mapping

_TOUCHES: Mapping[str, re.Pattern[str]] = {
    "RepRapFirmware (Duet)": re.compile(r"^.*Stopped at height -?[\d.]+ ?mm", re.MULTILINE),
    "TinyG or g2core": re.compile(r'^.*\{"prb":', re.MULTILINE),
}


def advice(text: str) -> str:
    """Give what to do with a log of touches that is none of those that are read; else nothing."""
    for name, sign in _TOUCHES.items():
        if sign.search(text):
            return (
                f"touches of {name}, whose logs are not read: put their coordinates into a table "
                "with a head, such as Z [mm], for import csv --map coordinate_mm=Z --axis Z"
            )
    return ""
