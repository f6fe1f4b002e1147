"""Dates as spreadsheets write them, and times of day."""

import re
from collections.abc import Iterator, Sequence
from datetime import date, datetime, time, timedelta
from itertools import repeat

HALF_DAY = 12
MONTHS = 12
_DOTTED_DATE = re.compile(r"^(\d{2})\.(\d{2})\.(\d{4})[ T]+(?=\d)", re.ASCII)
"""07.10.2025 08:15:00: with points the day comes first."""
_AMERICAN = re.compile(
    r"^(\d{1,2})/(\d{1,2})/(\d{4})[ ,T]+(\d{1,2})(:\d{2})(:\d{2}(?:\.\d+)?)?\s*([AP])M$",
    re.ASCII | re.IGNORECASE,
)
"""10/07/2025 08:15:00 AM: with halves of the day the month comes first."""
_TIME_OF_DAY = re.compile(
    r"(\d{1,2})(:\d{2}(?::\d{2}(?:[.,]\d{1,6})?)?)(?:\s*([AP])M)?", re.ASCII | re.IGNORECASE
)
_DATE = re.compile(r"(\d{1,2})([./])(\d{1,2})\2(\d{4})", re.ASCII)
_YEAR_FIRST = re.compile(r"(\d{4})([-./])(\d{1,2})\2(\d{1,2})", re.ASCII)
_ANY_DAY = datetime.fromisoformat("2000-01-01")  # of no zone, as the times
_ONE_DAY = timedelta(days=1)


def are_times_of_day(stamps: Sequence[str]) -> bool:
    """Tell whether no date stands beside a time in any cell that is filled."""
    filled = [stamp for stamp in stamps if stamp]
    return bool(filled) and all(map(_TIME_OF_DAY.fullmatch, filled))


def as_dates(times: Sequence[str], dates: Sequence[date | None] | None = None) -> Iterator[str]:
    """Put dates before times of day.

    Where none is known, a time is less than half a day from the one before. What is no time of a
    day stays as it is.
    """
    last = _ANY_DAY
    for text, day in zip(times, repeat(None) if dates is None else dates, strict=dates is not None):
        if (told := _time_of(text)) is None:
            yield text
            continue
        if day is None:
            days = round((last - datetime.combine(_ANY_DAY, told)) / _ONE_DAY)
            last = datetime.combine(_ANY_DAY, told) + days * _ONE_DAY
        else:
            last = datetime.combine(day, told)
        yield last.isoformat()


def dates_of(cells: Sequence[str], times: Sequence[str]) -> list[date | None] | None:
    """Give the dates of cells, None for an empty one; nothing if a cell is none.

    With points the day comes first, and with halves of the day beside it the month does. Else a
    number that is no month tells, and without one nobody knows.
    """
    slashed = [m for m in map(_DATE.fullmatch, cells) if m and m[2] == "/"]
    orders = {"day" if int(m[1]) > MONTHS else "month" for m in slashed if _is_told(m)}
    halves = any(m and m[3] for m in map(_TIME_OF_DAY.fullmatch, times))
    order = "month" if halves else orders.pop() if len(orders) == 1 else ""
    found = [_date_of(cell, order) for cell in cells]
    are_known = all(day or not cell for day, cell in zip(found, cells, strict=True))
    return found if are_known and any(found) else None


def _is_told(slashed: re.Match[str]) -> bool:
    return max(int(slashed[1]), int(slashed[3])) > MONTHS


def _date_of(cell: str, order: str) -> date | None:
    """Read a date; in one with slashes the day or the month comes first, as is told."""
    if match := _YEAR_FIRST.fullmatch(cell):
        year, month, day = match[1], match[3], match[4]
    elif (match := _DATE.fullmatch(cell)) and (match[2] == "." or order):
        year, month, day = match[4], match[1], match[3]
        if match[2] == "." or order == "day":
            month, day = day, month
    else:
        return None
    try:
        return date(int(year), int(month), int(day))
    except ValueError:
        return None


def _time_of(text: str) -> time | None:
    match = _TIME_OF_DAY.fullmatch(text)
    if match is None:
        return None
    hour, rest, half = int(match[1]), match[2].replace(",", "."), match[3]
    if half:
        hour = hour % HALF_DAY + HALF_DAY * (half in "Pp")
    try:
        return time.fromisoformat(f"{hour:02}{rest}")
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
