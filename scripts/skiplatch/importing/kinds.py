"""Which importer reads a file, by what stands in it: the one place that tells logs apart."""

import re
import warnings
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from itertools import islice
from pathlib import Path

from skiplatch.errors import CampaignWarning, InputError
from skiplatch.files import DAMAGE, refuse_special_or_large
from skiplatch.importing.candump import is_logged, is_shown
from skiplatch.importing.dialects import READ, advice
from skiplatch.importing.log_lines import MAX_BYTES, read_text

HOLDS: Mapping[str, str] = {
    **{kind: f"touches of {kind}" for kind in READ},
    "csv": "touches of a table",
    "iso230": "runs of ISO 230-2",
    "edges": "edges of a capture",
    "can": "frames of a CAN bus",
    "mdf": "channels of MDF",
}
"""What each importer, named as a command, reads."""
TABLE = "a table"
_SAME: Mapping[str, set[str]] = {
    "csv": {"csv", "iso230", TABLE},
    "iso230": {"csv", "iso230", TABLE},
    "edges": {"edges", TABLE},
    "can": {"can", "mdf"},
}
"""What each importer may read besides its own: a capture may be a table, too."""
_MAGIC: Mapping[str, tuple[bytes, ...]] = {"can": (b"LOGG",), "mdf": (b"MDF  ", b"UnFinMF")}
_ZIP = b"PK\x03\x04"
_SESSION = ("metadata", "version")
"""Members of a session of sigrok."""
_LOOKED_AT = 4000  # characters
_ROWS = 20
_VCD = re.compile(r"^\s*\$(?:date|version|comment|timescale|scope|var)\b", re.MULTILINE)
_SIGROK = re.compile(r"^;.*(?:libsigrok|Samplerate)", re.MULTILINE)
_SCOPE = re.compile(
    r'^"?(?:time|x) ?(?:[\[(][mµun]?s[\])])?"?[,;\t]"?(?:ch|voltage)'
    r"|^\W*(?:sequence|seconds?|[mµun]?s)\W*[,;\t]\W*[mµ]?V(?:olt)?\b|\btInc\s*=",
    re.IGNORECASE | re.MULTILINE,
)
"""How heads of an oscilloscope's CSV name the columns or their units."""
_TIMES = re.compile(r'"?time ?[\[(][mµun]?s[\])]', re.IGNORECASE)
_LEVEL = re.compile(r'\s*"?[01](?:\.0+)?"?\s*')
_RUNS = re.compile(r"^[^\n]*[,;\t ][^\n,;\t]*[↑↓]", re.MULTILINE)
_ASC = re.compile(r"^base\s+(?:hex|dec)\s+timestamps\b", re.MULTILINE | re.IGNORECASE)
_NUMBER = re.compile(r'\s*"?[+-]?\d+(?:[.,]\d*)?(?:e[+-]?\d+)?"?\s*', re.IGNORECASE)


def kind_of(path: Path) -> str:
    """Give the command of `skiplatch import` that reads a file, `TABLE`, or nothing.

    Raises:
        InputError: It cannot be read at all.
    """
    return next(_kinds(path), "")


def _kinds(path: Path) -> Iterator[str]:
    """Give all kinds of which a file has a sign, those first that are the surest."""
    refuse_special_or_large(path, MAX_BYTES)  # a pipe would be waited for
    with path.open("rb") as file:
        begins = file.read(len(max(_ZIP, *_MAGIC["mdf"], key=len)))
    if begins.startswith(_ZIP):
        yield from ["edges"] if _is_session(path) else []
        return
    if found := [kind for kind, signs in _MAGIC.items() if begins.startswith(signs)]:
        yield from found
        return
    if is_logged(path) or is_shown(path):
        yield "can"
    text = _text(path)
    yield from (kind for kind, holds in _SIGNS.items() if holds(text))


def other_kind(path: Path, kind: str) -> str:
    """Say what to do with a file that has no sign of the kind that it was read as; else nothing."""
    found: list[str] = []
    with suppress(InputError, OSError):
        found = list(_kinds(path))
    if _SAME.get(kind, {kind}) & {*found[:1], *({kind} & set(found))}:
        return ""
    with suppress(InputError, OSError):
        if said := advice(_text(path)):
            return said
    if not found:
        return ""
    if found[0] == TABLE:
        return f"no {HOLDS[kind]}, but a table: skiplatch import csv or iso230 reads it"
    has, holds = HOLDS[kind], HOLDS[found[0]]
    touches = "touches "
    if has.startswith(touches):
        holds = holds.removeprefix(touches)
    return f"no {has}, but {holds}: skiplatch import {found[0]} reads them"


def _text(path: Path) -> str:
    with warnings.catch_warnings():  # whoever reads it warns
        warnings.simplefilter("ignore", CampaignWarning)
        return read_text(path, or_windows=True)


def is_scope(text: str) -> bool:
    """Tell whether it was an oscilloscope that wrote a capture."""
    begins = text[:_LOOKED_AT]
    return bool(_SCOPE.search(begins)) and not _TIMES.match(begins)


def _is_session(path: Path) -> bool:
    with suppress(*DAMAGE), zipfile.ZipFile(path) as archive:
        return all(name in archive.namelist() for name in _SESSION)
    return False


def _is_capture(text: str) -> bool:
    begins = text[:_LOOKED_AT]
    return any(sign.search(begins) for sign in (_VCD, _SIGROK, _SCOPE)) or _has_levels(text)


def _has_levels(text: str) -> bool:
    """Tell whether channels of 0 and 1 stand beside a time, as Saleae writes them."""
    head, *rows = list(islice((line for line in text.splitlines() if line.strip()), _ROWS)) or [""]
    if not _TIMES.match(head.lstrip("\ufeff")) or not rows:
        return False
    mark = next((mark for mark in ";\t," if mark in head), ",")
    return all(mark in row and all(map(_LEVEL.fullmatch, row.split(mark)[1:])) for row in rows)


def _is_table(text: str) -> bool:
    """Tell whether there are rows of as many cells each, most of them numbers."""
    lines = [line for line in text.splitlines()[: 2 * _ROWS] if line.strip()]
    for mark in ";\t,":
        rows = [line.split(mark) for line in lines if not line.startswith("#")]
        widths = [len(row) for row in rows]
        usual = max(widths, key=widths.count, default=0)
        alike = [row for row in rows if len(row) == usual]
        cells = [cell for row in alike[1:] for cell in row if cell.strip()]
        numbers = sum(bool(_NUMBER.fullmatch(cell)) for cell in cells)
        if usual > 1 and 2 * len(alike) > len(rows) and 2 * numbers >= len(cells) > 0:
            return True
    return False


def _holds(sign: re.Pattern[str], text: str) -> bool:
    return bool(sign.search(text))


def _begins(sign: re.Pattern[str], text: str) -> bool:
    return bool(sign.search(text[:_LOOKED_AT]))


_SIGNS: Mapping[str, Callable[[str], bool]] = {
    "can": partial(_begins, _ASC),
    "edges": _is_capture,
    **{kind: partial(_holds, sign) for kind, sign in READ.items()},
    "iso230": partial(_begins, _RUNS),
    TABLE: _is_table,
}
