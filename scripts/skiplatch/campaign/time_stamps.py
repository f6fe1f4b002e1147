"""The column `time`: ISO 8601 in place of seconds."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign.column_kinds import Values
from skiplatch.errors import InputError, quoted

TIME_NAME = "time"
EXPECTED = 'a date and time such as "2026-03-01T14:05:12.250"'
DATE_CHARACTERS = len("2026-03-01")
LONGEST_S = 1e9


def seconds(path: Path, lines: Values, stamps: Values) -> FloatArray:
    """Turn time stamps, shape (n,), into seconds since the earliest; NaN where there is none.

    Stamps with and without a zone do not mix: nobody knows how far they are apart.

    Raises:
        InputError: A stamp is none, or only some have a zone.
    """
    times = [_time(path, int(line), text) for line, text in zip(lines, stamps, strict=True)]
    known = [(line, time) for line, time in zip(lines, times, strict=True) if time]
    if not known:
        return np.full(len(times), np.nan)
    has_zone = known[0][1].tzinfo is not None
    for line, time in known:
        if (time.tzinfo is not None) != has_zone:
            message = "expected a zone in every time stamp or in none"
            raise InputError(path, int(line), TIME_NAME, message)
    zero, last = min(time for _, time in known), max(time for _, time in known)
    if (last - zero).total_seconds() > LONGEST_S:
        raise InputError(path, None, TIME_NAME, f"runs from {zero} to {last}")
    return np.array([(time - zero).total_seconds() if time else np.nan for time in times])


def belongs_elsewhere(name: str, cell: str) -> str:
    """Say where a date and time goes that stands in a column of seconds; empty for any other."""
    is_stamp = name == "time_s" and _parsed(cell) is not None
    return f'; dates and times go in a column "{TIME_NAME}"' if is_stamp else ""


def _time(path: Path, line: int, text: str) -> datetime | None:
    if not text:
        return None
    if (time := _parsed(text)) is None:
        raise InputError(path, line, TIME_NAME, f"expected {EXPECTED}, got {quoted(text)}")
    return time


def _parsed(text: str) -> datetime | None:
    try:
        time = datetime.fromisoformat(text)
        if len(text) > DATE_CHARACTERS:
            return time.astimezone(UTC) if time.tzinfo is not None else time
    except (ValueError, OverflowError):
        pass
    return None
