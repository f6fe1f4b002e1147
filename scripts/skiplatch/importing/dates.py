"""Dates as spreadsheets write them."""

import re

HALF_DAY = 12
_DOTTED_DATE = re.compile(r"^(\d{2})\.(\d{2})\.(\d{4})[ T]+(?=\d)", re.ASCII)
"""07.10.2025 08:15:00: with points the day comes first."""
_AMERICAN = re.compile(
    r"^(\d{1,2})/(\d{1,2})/(\d{4})[ ,T]+(\d{1,2})(:\d{2})(:\d{2}(?:\.\d+)?)?\s*([AP])M$",
    re.ASCII | re.IGNORECASE,
)
"""10/07/2025 08:15:00 AM: with halves of the day the month comes first."""


def iso_of(stamp: str) -> str:
    """Write a date as ISO 8601 does; what is none of those known stays as it is."""
    match = _AMERICAN.match(stamp)
    if match is None:
        return _DOTTED_DATE.sub(r"\3-\2-\1T", stamp)
    month, day, year, hour, minute, second, half = match.groups()
    hours = int(hour) % HALF_DAY + HALF_DAY * (half in "Pp")
    return f"{year}-{int(month):02}-{int(day):02}T{hours:02}{minute}{second or ':00'}"
