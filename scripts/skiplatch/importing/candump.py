"""Text of candump as it shows frames on a screen, with or without times: ``can0  181   [8]  00 …``.

With -L it writes them as python-can reads them.
"""

import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import TextIO

from skiplatch.importing.encodings import marked_encoding, without_colours

LOOKED_AT = 50  # lines, after which the form of a log is known
MOST_CHARACTERS = 4096  # of a line

_LOGGED = re.compile(r"\s*\([\d.]+\)\s+\S+\s+[0-9A-F]{3,8}##?[0-9A-F]*", re.IGNORECASE)
_SHOWN = re.compile(
    r"\s*(?:\([^)]*\)\s+)?\S+\s+(?:(?:RX|TX)\s+\S+\s+\S+\s+)?"
    r"(?P<id>[0-9A-F]{3}|[0-9A-F]{8})\s+\[\d{1,2}\]\s*(?P<data>(?:[0-9A-F]{2}(?:\s|$))*)",
    re.IGNORECASE,
)


def is_logged(path: Path) -> bool:
    """Tell whether candump -L wrote a file, whatever its ending."""
    return _begins_with(path, _LOGGED)


def is_shown(path: Path) -> bool:
    """Tell whether a file holds what candump shows on a screen."""
    return _begins_with(path, _SHOWN)


def shown_frames(path: Path) -> Iterator[tuple[int, bytes]]:
    """Give the id and the bytes of each frame; other lines are passed over."""
    with _opened(path) as file:
        for line in _lines(file):
            if frame := _SHOWN.match(line):
                yield int(frame["id"], 16), bytes.fromhex(frame["data"])


def _begins_with(path: Path, form: re.Pattern[str]) -> bool:
    with _opened(path) as file:
        return any(form.match(line) for line in islice(_lines(file), LOOKED_AT))


def _opened(path: Path) -> TextIO:
    return path.open(encoding=marked_encoding(path) or "ascii", errors="replace")


def _lines(file: TextIO) -> Iterator[str]:
    return map(without_colours, iter(lambda: file.readline(MOST_CHARACTERS), ""))
