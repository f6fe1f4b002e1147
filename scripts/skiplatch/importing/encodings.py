"""Encodings of text logs that their first bytes tell: a terminal's "save as" likes UTF-16."""

import codecs
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from skiplatch.errors import InputError

_MARKS = {
    codecs.BOM_UTF32_LE: "utf-32",  # begins as that of UTF-16 does
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
    codecs.BOM_UTF8: "utf-8-sig",
}
_ZIP = b"PK\x03\x04"
_COMPRESSED = (b"\x1f\x8b", _ZIP, b"BZh", b"\xfd7zXZ", b"\x28\xb5\x2f\xfd", b"7z\xbc\xaf")
"""First bytes of gzip, zip, bzip2, xz, zstd and 7-Zip."""
_OLD_WORKBOOK = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"  # of .xls
_WORKBOOKS = (".xlsx", ".xlsm", ".xlsb", ".ods")
_IN_WORKBOOKS = (b"[Content_Types].xml", b"opendocument.spreadsheet")  # of .xlsx and .ods
UTF8 = "utf-8"
WINDOWS = "cp1252"
IS_WINDOWS = "no UTF-8: letters beyond ASCII were read as Windows-1252 has them"
_COLOURS = re.compile(r"\x1b\[[0-9;]*[mK]")
_LOOKED_AT = 400  # bytes
_MOST_ZERO = 0.4  # of the bytes at odd or at even places of text that has two bytes a character


def marked_encoding(path: Path) -> str | None:
    """Give the encoding that the byte order mark of a file tells; None where it has none."""
    with path.open("rb") as file:
        return encoding_of(file.read(len(codecs.BOM_UTF32_LE)))


def encoding_of(data: bytes) -> str | None:
    """Give the encoding that a byte order mark tells; None where there is none."""
    return next((name for mark, name in _MARKS.items() if data.startswith(mark)), None)


def unmarked_encoding(data: bytes) -> str:
    """Give UTF-8, or that of Windows where it is none: many programs know no other."""
    try:
        data.decode(UTF8)
    except UnicodeDecodeError:
        return WINDOWS
    return UTF8


def is_windows(path: Path) -> bool:
    """Tell whether a file has no byte order mark and is no UTF-8."""
    data = path.read_bytes()
    return encoding_of(data) is None and unmarked_encoding(data) == WINDOWS


def without_colours(text: str) -> str:
    """Take off what tells a terminal the colour of what follows; files have it as well."""
    return _COLOURS.sub("", text) if "\x1b" in text else text


def refuse_no_text(path: Path, data: bytes) -> None:
    """Refuse what has no byte order mark and is no text of one byte a letter, or UTF-8.

    Raises:
        InputError: It is a workbook, compressed, or UTF-16; says what to do.
    """
    if data.startswith(_OLD_WORKBOOK) or (data.startswith(_ZIP) and _is_workbook(path, data)):
        raise InputError(path, None, None, "a workbook of a spreadsheet: export the sheet as CSV")
    if data.startswith(_COMPRESSED):
        raise InputError(path, None, None, "a compressed file: unpack it first")
    if _looks_like_unmarked_utf16(data):
        message = "UTF-16 without a byte order mark: save it as UTF-8, or as UTF-16 with the mark"
        raise InputError(path, None, None, message)


def _is_workbook(path: Path, data: bytes) -> bool:
    """Tell whether a zip holds a workbook."""
    return path.suffix.lower() in _WORKBOOKS or any(name in data for name in _IN_WORKBOOKS)


def _looks_like_unmarked_utf16(data: bytes) -> bool:
    first = data[:_LOOKED_AT]
    return any(half.count(0) > _MOST_ZERO * len(half) for half in (first[::2], first[1::2]) if half)


@contextmanager
def in_utf8(path: Path) -> Iterator[Path]:
    """Give a file for a library that reads UTF-8 without a mark: itself, or for a while a copy."""
    encoding = marked_encoding(path)
    if encoding is None:
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="skiplatch-") as folder:
        copy = Path(folder) / path.name  # its ending tells the library what it is
        with (
            path.open(encoding=encoding, errors="replace", newline="") as marked,
            copy.open("w", encoding="utf-8", newline="") as plain,
        ):
            shutil.copyfileobj(marked, plain)
        yield copy
