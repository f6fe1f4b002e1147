"""Lines of logs: what programs put before them is taken off, and their time is read.

Real logs come by way of terminals, web pages and forums: with a time before each line or in a line
of its own, with ``Recv:``, ``>>>``, ``//``, list marks and HTML spaces.
"""

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from skiplatch.errors import CampaignWarning, InputError
from skiplatch.files import failures_named, refuse_special_or_large
from skiplatch.importing.encodings import (
    UTF8,
    encoding_of,
    refuse_no_text,
    unmarked_encoding,
    without_colours,
)
from skiplatch.importing.log_order import is_newest_first

MAX_BYTES = 500 * 2**20
MAX_LINE_CHARACTERS = 10_000
S_PER_DAY = 86_400.0

_TIME = (
    r"(?P<h>\d{1,2}):(?P<m>\d{2}):(?P<s>\d{2}(?:[.,]\d+)?)(?:\s*(?P<half>[AaPp][Mm]))?"
    r"(?:Z|[+-]\d{2}:?\d{2})?"
)
_DATE = (
    r"(?:\d{1,4}[-./]\d{1,2}[-./]\d{1,4}[,T ]?\s*"
    r"|(?:(?:Mon|Tue|Wed|Thu|Fri|Sat|Sun),?\s+)?"
    r"(?:Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)\s+\d{1,2},?\s+(?:\d{4},?\s+)?)?"
)
"""In figures, or as ts and syslog write it: Apr 02."""
_STAMP = re.compile(rf"^\s*[\[(]?{_DATE}{_TIME}\s*[\])]?\s*[:|>-]*\s*", re.ASCII)
_MARK = re.compile(
    r"^(?:\s|[-*•]\s|\$ |>>>|<<<|>(?!\s*$)|<(?![A-Za-z])|//|!!|echo:|"
    r"(?:Recv|Send|RX|TX|READ|SENT|SENDING|RECV|INFO|DEBUG)\s*:?\s*(?=\W|\w)|\|"
    r"|\[(?:INFO|DEBUG|WARN|WARNING|ERROR)\]\s*|Normal info:)+",
)
_WRITTEN_END = re.compile(r"(?:\\[rn])+$")
"""The end of a line as a program wrote it that shows control characters: `\\r\\n`."""

_BOLD = re.compile(r"(?<![\w*\])])\*\*(?=[^\s*])([^*]*[^\s*])\*\*(?![\w*\[(])")
"""Of Markdown, as in an issue; `2**3` and a checksum `*42` are none."""
_CODE = re.compile(r"(`+)([^`]*)\1")

_GLUED = re.compile(r"(?<=[\w.)\]])(?=(?:Recv|Send): )")
"""Where a page lost the end of a line."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a log.

    Attributes:
        number: From 1.
        text: Without what stands before it.
        raw: As it stands in the file.
        time_s: Time of day, going on past midnight; None where the log has none.
    """

    number: int
    text: str
    raw: str
    time_s: float | None


def read_text(path: Path, wanted: str = "a log", *, or_windows: bool = False) -> str:
    """Read what is `wanted` in any of the usual encodings; lines too long for a touch are blank.

    Args:
        path: The file.
        wanted: For messages.
        or_windows: What is no UTF-8 is in Windows-1252. In logs of a serial line it is noise.

    Raises:
        InputError: It cannot be read or is no text of lines.
    """
    text = without_colours(_decoded(path, wanted, or_windows=or_windows))
    lines = text.splitlines()
    long = [number for number, line in enumerate(lines) if len(line) > MAX_LINE_CHARACTERS]
    if not long:
        return text
    for number in long:
        lines[number] = ""
    if not any(line.strip() for line in lines):
        message = f"a line of more than {MAX_LINE_CHARACTERS} characters: expected {wanted}"
        raise InputError(path, long[0] + 1, None, message)
    message = f"lines of more than {MAX_LINE_CHARACTERS} characters are left out: {len(long)}"
    warnings.warn(CampaignWarning(path, long[0] + 1, None, message), stacklevel=2)
    return "\n".join(lines)


def _decoded(path: Path, wanted: str, *, or_windows: bool) -> str:
    with failures_named(path, "read"):
        refuse_special_or_large(path, MAX_BYTES)
        data = path.read_bytes()
    if not data.strip():
        raise InputError(path, None, None, "an empty file")
    if encoding := encoding_of(data):
        return data.decode(encoding, errors="replace")
    refuse_no_text(path, data)
    if b"\0" in data[:4096]:
        raise InputError(path, None, None, f"no text: expected {wanted}")
    return data.decode(unmarked_encoding(data) if or_windows else UTF8, errors="replace")


def read_lines(path: Path) -> list[Line]:
    """Give the lines of a log that are not blank, the oldest first.

    Raises:
        InputError: It cannot be read or is no text.
    """
    lines = list(_lines(read_text(path)))
    if len({line.time_s for line in lines}) < 2 and is_newest_first(line.text for line in lines):
        message = (
            "read from below: what begins touches stands behind them, and what ends them above"
        )
        warnings.warn(CampaignWarning(path, None, None, message), stacklevel=2)
        return lines[::-1]
    return _oldest_first(lines)


def _lines(text: str) -> Iterator[Line]:
    time_s: float | None = None
    for number, raw in enumerate(text.splitlines(), 1):
        for part in _GLUED.split(_without_markdown(raw.replace("\u00a0", " "))):
            rest = _without_marks(part)
            if stamp := _STAMP.match(rest):
                time_s = _seconds(stamp)
                rest = _without_marks(rest[stamp.end() :])
            if rest := _WRITTEN_END.sub("", rest.strip()).rstrip():
                yield Line(number, rest, raw, time_s)


def _without_markdown(text: str) -> str:
    """Take off what makes words bold or code on the page that a log was copied from."""
    if "`" not in text and "**" not in text:
        return text
    return _BOLD.sub(r"\1", _CODE.sub(r"\2", text))


def _without_marks(text: str) -> str:
    match = _MARK.match(text)
    return text[match.end() :] if match else text


def _seconds(stamp: re.Match[str]) -> float:
    hour = int(stamp["h"]) % 24
    if stamp["half"]:
        hour = hour % 12 + (12 if stamp["half"].lower() == "pm" else 0)
    return hour * 3600.0 + int(stamp["m"]) * 60.0 + float(stamp["s"].replace(",", "."))


def _oldest_first(lines: list[Line]) -> list[Line]:
    """Turn consoles round that show the newest line first, and let times go on past midnight."""
    times = [line.time_s for line in lines if line.time_s is not None]
    pairs = list(pairwise(times))
    falls = sum(later < earlier for earlier, later in pairs)
    rises = sum(later > earlier for earlier, later in pairs)
    if falls > max(1, rises):
        lines = lines[::-1]
    days, last, found = 0, None, []
    for line in lines:
        time_s = line.time_s
        if time_s is not None:
            if last is not None and time_s < last - S_PER_DAY / 2:
                days += 1
            last = time_s
            time_s += days * S_PER_DAY
        found.append(Line(line.number, line.text, line.raw, time_s))
    return found
