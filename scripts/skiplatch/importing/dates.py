"""Dates as spreadsheets write them, and times of day."""

import re
from collections.abc import Iterator, Sequence
from datetime import datetime, time, timedelta

HALF_DAY = 12
_DOTTED_DATE = re.compile(r"^(\d{2})\.(\d{2})\.(\d{4})[ T]+(?=\d)", re.ASCII)
"""07.10.2025 08:15:00: with points the day comes first."""
_AMERICAN = re.compile(
    r"^(\d{1,2})/(\d{1,2})/(\d{4})[ ,T]+(\d{1,2})(:\d{2})(:\d{2}(?:\.\d+)?)?\s*([AP])M$",
    re.ASCII | re.IGNORECASE,
)
"""10/07/2025 08:15:00 AM: with halves of the day the month comes first."""
_TIME_OF_DAY = re.compile(r"\d{1,2}:\d{2}(?::\d{2}(?:[.,]\d{1,6})?)?", re.ASCII)
_ANY_DAY = datetime.fromisoformat("2000-01-01")  # of no zone, as the times
_ONE_DAY = timedelta(days=1)


def are_times_of_day(stamps: Sequence[str]) -> bool:
    """Tell whether no date stands beside a time in any cell that is filled."""
    filled = [stamp for stamp in stamps if stamp]
    return bool(filled) and all(map(_TIME_OF_DAY.fullmatch, filled))


def as_dates(times: Sequence[str]) -> Iterator[str]:
    """Put dates before times of day; each is less than half a day from the one before.

    What is no time of a day stays as it is.
    """
    last = _ANY_DAY
    for text in times:
        if (told := _time_of(text)) is None:
            yield text
            continue
        days = round((last - datetime.combine(_ANY_DAY, told)) / _ONE_DAY)
        last = datetime.combine(_ANY_DAY, told) + days * _ONE_DAY
        yield last.isoformat()


def _time_of(text: str) -> time | None:
    try:
        return time.fromisoformat(text.zfill(len(text) + (text[1:2] == ":")).replace(",", "."))
    except ValueError:
        return None


def iso_of(stamp: str) -> str:
    """Write a date as ISO 8601 does; what is none of those known stays as it is."""
    match = _AMERICAN.match(stamp)
    if match is None:
        return _DOTTED_DATE.sub(r"\3-\2-\1T", stamp)
    month, day, year, hour, minute, second, half = match.groups()
    hours = int(hour) % HALF_DAY + HALF_DAY * (half in "Pp")
    return f"{year}-{int(month):02}-{int(day):02}T{hours:02}{minute}{second or ':00'}"
