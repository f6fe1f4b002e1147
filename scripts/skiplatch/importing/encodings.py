"""Encodings of text logs that their first bytes tell: a terminal's "save as" likes UTF-16."""

import codecs
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_MARKS = {
    codecs.BOM_UTF32_LE: "utf-32",  # begins as that of UTF-16 does
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
    codecs.BOM_UTF8: "utf-8-sig",
}
_LOOKED_AT = 400  # bytes
_MOST_ZERO = 0.4  # of the bytes at odd or at even places of text that has two bytes a character


def marked_encoding(path: Path) -> str | None:
    """Give the encoding that the byte order mark of a file tells; None where it has none."""
    with path.open("rb") as file:
        return encoding_of(file.read(len(codecs.BOM_UTF32_LE)))


def encoding_of(data: bytes) -> str | None:
    """Give the encoding that a byte order mark tells; None where there is none."""
    return next((name for mark, name in _MARKS.items() if data.startswith(mark)), None)


def looks_like_unmarked_utf16(data: bytes) -> bool:
    """Tell whether text has two bytes a character, and no mark that says so."""
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
