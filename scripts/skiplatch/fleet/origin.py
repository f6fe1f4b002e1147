"""Where a campaign comes from: its rig, and when it was recorded."""

import re
import unicodedata
import warnings
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE
from skiplatch.campaign.csv_text import read_rows
from skiplatch.campaign.time_stamps import TIME_NAME
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import CampaignWarning, InputError, quoted
from skiplatch.fleet import clock
from skiplatch.fleet.layout import refuse_rig

RIG_KEY, TIME_KEY = "rig", "recorded_at"
EXPECTED = "expected a date and time such as 2026-03-01T14:05:12Z"
_END_OF_DAY = re.compile(r"(?<=[T ])24(?=:00(:00([.,]0+)?)?(Z|[+-]|$))")
_LEAP_SECOND = re.compile(r"(?<=:[0-5][0-9]):60(?=[.,Z+-]|$)")
SHOWN = "%Y-%m-%dT%H:%M:%S"


def rig_of(folder: Path, named: str | None) -> str:
    """Give the rig: as it was named, else `[notes] rig`, else the folder that it lies in.

    Names that look the same are the same: see `tidied`.

    Raises:
        InputError: That is no name of a rig.
    """
    if named is not None:
        return refuse_rig(folder, tidied(named))
    notes = _notes(folder)
    if RIG_KEY in notes:
        return refuse_rig(folder / NOMINAL_FILE, tidied(notes[RIG_KEY]))
    return refuse_rig(folder, tidied(folder.resolve().parent.name))


def tidied(name: object) -> object:
    """Give a name in the normal form NFC and without blanks at its ends."""
    return unicodedata.normalize("NFC", name).strip() if isinstance(name, str) else name


def recorded_at(folder: Path) -> datetime:
    """Give when it was recorded, in UTC without a zone.

    What `told_time` gives, else when touches.csv was last written, which was not later than now.

    Raises:
        InputError: What stands there is no time.
    """
    if told := told_time(folder):
        return told
    written_s = (folder / TOUCHES_FILE).stat().st_mtime
    written = datetime.fromtimestamp(written_s, UTC).replace(tzinfo=None)
    return min(written, clock.now()).replace(microsecond=0)


def told_time(folder: Path) -> datetime | None:
    """Give when a campaign says that it was recorded; None if it does not.

    `[notes] recorded_at`, else the earliest stamp in the column time. What has no zone counts as
    UTC. Warns of a time that is still to come by the clock of this machine.

    Raises:
        InputError: What stands there is no time.
    """
    notes = _notes(folder)
    if TIME_KEY in notes:
        return _told(folder / NOMINAL_FILE, TIME_KEY, notes[TIME_KEY])
    path = folder / TOUCHES_FILE
    stamps = _stamps(path)
    if not stamps:
        return None
    earliest = min(stamps, key=lambda stamp: _utc(_read(path, TIME_NAME, stamp)))
    return _told(path, TIME_NAME, earliest)


def _notes(folder: Path) -> Mapping[str, Any]:
    path = folder / NOMINAL_FILE
    notes: Mapping[str, Any] = parse_toml(path, read_toml_text(path)).get("notes", {})
    return notes


def _stamps(path: Path) -> set[str]:
    rows = read_rows(path)
    _, header = next(rows, (0, []))  # a file may change under one's hands
    names = [name.strip().lower() for name in header]
    if TIME_NAME not in names:
        return set()
    place = names.index(TIME_NAME)
    return {row[place] for _, row in rows if len(row) > place} - {""}


def _parsed(text: str) -> datetime:
    """Read ISO 8601, also the end of a day and a leap second, which Python does not know.

    Raises:
        ValueError: It is none.
        OverflowError: It lies beyond the year 9999.
    """
    early, is_day = _END_OF_DAY.subn("00", text)
    early, is_leap = _LEAP_SECOND.subn(":59", early)
    return datetime.fromisoformat(early) + timedelta(days=is_day, seconds=is_leap)


def _read(path: Path, name: str, written: object) -> datetime:
    try:
        time = written if isinstance(written, datetime) else _parsed(str(written))
        _utc(time)
    except (ValueError, OverflowError) as error:
        raise InputError(path, None, name, f"{EXPECTED}, got {quoted(str(written))}") from error
    return time


def _utc(time: datetime) -> datetime:
    return time.astimezone(UTC).replace(tzinfo=None) if time.tzinfo else time


def _told(path: Path, name: str, written: object) -> datetime:
    """Give a time in UTC; warns of one that is still to come."""
    time, now = _read(path, name, written), clock.now()
    if _utc(time) > (now if time.tzinfo else now + clock.EASTERNMOST):
        later = f"{quoted(str(written))} is later than the clock of this machine, {now:{SHOWN}} UTC"
        warnings.warn(CampaignWarning(path, None, name, later), stacklevel=2)
    return _utc(time)
