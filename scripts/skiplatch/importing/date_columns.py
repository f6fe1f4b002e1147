"""Tables whose dates stand in a column beside that of the times of day."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from skiplatch.campaign.column_kinds import tidy
from skiplatch.campaign.csv_text import Row
from skiplatch.campaign.time_stamps import TIME_NAME
from skiplatch.errors import InputError
from skiplatch.importing.dates import are_times_of_day, as_dates, dates_of, iso_of
from skiplatch.importing.mapped import DATE, Mapped
from skiplatch.importing.model import Imported

_DATE_HEADS = {"date", "datum", "day", "tag", "fecha", "data"}
_TIME_HEADS = {"time", "zeit", "uhrzeit", "hora", "heure", "ora", "tijd"}
_BREAKS = re.compile(r"[\W\d_]+")


def with_dates(heads: list[str], body: Sequence[Row], mapped: Sequence[Mapped]) -> list[Mapped]:
    """Add the columns of dates and of times of day, where heads and cells tell and no map does."""
    found = list(mapped)
    by_column = {m.column: m for m in mapped}
    if "time_s" in by_column or DATE in by_column:
        return found
    if TIME_NAME in by_column:
        times = column_of(heads, body, by_column[TIME_NAME].head)
        dates = _named(heads, mapped, _DATE_HEADS) if are_times_of_day(times) else ()
        return found + [_as(DATE, h) for h in _only(heads, body, dates, times)]
    for head in _named(heads, mapped, _TIME_HEADS):
        times = column_of(heads, body, head)
        dates = _only(heads, body, _named(heads, mapped, _DATE_HEADS), times)
        if dates and are_times_of_day(times):
            return [*found, _as(DATE, dates[0]), _as(TIME_NAME, head)]
    return found


def stamps(
    path: Path, heads: list[str], body: Sequence[Row], mapped: Sequence[Mapped], found: Imported
) -> list[str]:
    """Give the time of each row as ISO 8601 has it, with the date of its own column if there is.

    Raises:
        InputError: A column of dates holds none, or stands beside no times of day.
    """
    heads_of = {m.column: m.head for m in mapped}
    times = list(map(tidy, column_of(heads, body, heads_of[TIME_NAME])))
    if DATE not in heads_of:
        return _dated(times, found)
    if not are_times_of_day(times):
        message = "expected times of day, such as 14:05:12, as the dates stand in another column"
        raise InputError(path, body[0][0], heads_of[TIME_NAME], message)
    dates = dates_of([*map(tidy, column_of(heads, body, heads_of[DATE]))], times)
    if dates is None:
        message = "expected dates such as 2026-03-14 or 14.03.2026, which tell day from month"
        raise InputError(path, body[0][0], heads_of[DATE], message)
    return list(as_dates(times, dates))


def column_of(heads: list[str], body: Sequence[Row], head: str) -> list[str]:
    """Give the cells of a column; what a short row lacks is empty."""
    at = heads.index(head)
    return [row[at].strip() if at < len(row) else "" for _, row in body]


def _dated(times: list[str], found: Imported) -> list[str]:
    """Write dates and times as ISO 8601 does."""
    if not are_times_of_day(times):
        return [iso_of(stamp) for stamp in times]
    found.assumed.append(
        "times of day without a date: from one touch to the next less than half a day"
    )
    return list(as_dates(times))


def _named(heads: list[str], mapped: Sequence[Mapped], words: set[str]) -> list[str]:
    """Give the heads with one of the words that no map names and that stand there once."""
    taken = {m.head for m in mapped}
    free = (head for head in heads if head not in taken and heads.count(head) == 1)
    return [head for head in free if words & set(_BREAKS.split(head.lower()))]


def _only(
    heads: list[str], body: Sequence[Row], named: Iterable[str], times: Sequence[str]
) -> list[str]:
    """Give the one column that holds dates; nothing where several do."""
    dated = [head for head in named if dates_of(column_of(heads, body, head), times)]
    return dated if len(dated) == 1 else []


def _as(column: str, head: str) -> Mapped:
    return Mapped(column, head, head, "")
