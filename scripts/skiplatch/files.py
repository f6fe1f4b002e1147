"""Reading within limits, and writing so that nothing is ever seen half-written."""

import errno
import json
import os
import shutil
import stat
import struct
import time
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from skiplatch.errors import InputError, quoted
from skiplatch.undo import make_folders, replace, temporary_sibling

Json = Any
"""What a JSON document holds: anything."""
MOST_JSON_BYTES = 64 << 20
DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError, ValueError, OverflowError),
    *(NotImplementedError, RuntimeError),  # a method or an encryption that nobody chose
)
"""What reading an archive ends in that has lost bits."""
NO_READER_S = 0.05
"""After which a pipe is asked again whether it has a reader."""


def atomic_write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write UTF-8 text as it stands; see `atomic_write_bytes`."""
    atomic_write_bytes(path, text.encode())


def atomic_write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Replace the file by one holding the data, or leave it as it was.

    What is not a file (a terminal, a pipe, /dev/null) is written to directly.

    Raises:
        InputError: The file cannot be written.
    """
    with failures_named(path, "write"):
        target = Path(os.path.realpath(path))
        if target.exists() and not target.is_file():
            _write_through(target, data)
        else:
            _replace(target, data)


def atomic_write_folder(path: str | os.PathLike[str], texts: Mapping[str, str]) -> None:
    """Make a folder of UTF-8 files, by name, or leave nothing.

    The folders above it are made where they are missing.

    Raises:
        InputError: Something other than an empty folder stands there already, or the folder
            cannot be written.
    """
    with _new_folder(path) as temporary:
        temporary.mkdir()
        for name, text in texts.items():
            _write_synced(temporary / name, text.encode())


def atomic_copy_folder(source: Path, path: str | os.PathLike[str]) -> None:
    """Copy a folder and all below it, or leave nothing; see `atomic_write_folder`.

    Raises:
        InputError: As there.
    """
    with _new_folder(path) as temporary:
        shutil.copytree(source, temporary)


@contextmanager
def _new_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give the name of a folder to make in the block, which then comes to its place."""
    refuse_occupied(path)
    with failures_named(path, "write"):
        target = Path(os.path.realpath(path))
        make_folders(target.parent)
        temporary = temporary_sibling(target)
        try:
            yield temporary
            replace(temporary, target)
        except BaseException:
            shutil.rmtree(temporary, ignore_errors=True)
            raise


def refuse_occupied(path: str | os.PathLike[str]) -> None:
    """Raise InputError unless nothing or an empty folder stands there; for early warning."""
    with failures_named(path, "write"):
        target = Path(path)
        if target.exists() and not (target.is_dir() and not any(target.iterdir())):
            raise InputError(path, None, None, "exists already and is not an empty folder")


def refuse_unwritable(path: str | os.PathLike[str], *, makes_folders: bool = False) -> None:
    """Raise InputError if no file or folder can be made or replaced there; for early warning.

    Args:
        path: The file or folder.
        makes_folders: Whether folders above it are made where they are missing.
    """
    with failures_named(path, "write"):
        target = Path(os.path.realpath(path))
        folder = target.parent
        while makes_folders and not folder.exists() and folder != folder.parent:
            folder = folder.parent
        if not os.access(folder, os.F_OK):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
        if not folder.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR))
        if not os.access(target if target.exists() else folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        if target.is_char_device():
            with target.open("wb", buffering=0) as device:
                device.write(b"")  # to which a full one says already that it is full


@contextmanager
def failures_named(path: str | os.PathLike[str], doing: str) -> Iterator[None]:
    """Turn an OSError into an InputError such as ``path: cannot read: Permission denied``."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(path, None, None, f"cannot {doing}: {reason}") from error


@contextmanager
def foreign_reader(path: Path, max_bytes: int, what: str) -> Iterator[None]:
    """Guard the reading of a file by a library: what that stumbles over is told in one line.

    Args:
        path: The file.
        max_bytes: How large it can be.
        what: What it should be, such as "CAN log".

    Raises:
        InputError: The file cannot be read, is no regular one, is too large, or is no such thing.
    """
    try:
        with failures_named(path, "read"):
            refuse_special_or_large(path, max_bytes)
            yield
    except (InputError, MemoryError):
        raise
    except Exception as error:
        raise InputError(path, None, None, f"no {what}: {quoted(str(error))}") from error


def read_bytes(path: Path, max_bytes: int) -> bytes:
    """Read a regular file that is not larger than can be meant.

    Raises:
        InputError: The file cannot be read, is none, or is too large.
    """
    with failures_named(path, "read"):
        refuse_special_or_large(path, max_bytes)
        return path.read_bytes()


def read_text(path: Path, max_bytes: int) -> str:
    """Read UTF-8 text as `read_bytes` does; a byte order mark is accepted.

    Raises:
        InputError: See `read_bytes`; or it is no such text.
    """
    data = read_bytes(path, max_bytes)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(path, line, None, "not UTF-8 text") from error


def read_json(path: Path, max_bytes: int = MOST_JSON_BYTES) -> Json:
    """Read a JSON document as `read_text` does.

    Raises:
        InputError: See `read_text`; or it is no JSON, or one that nests too deeply.
    """
    text = read_text(path, max_bytes)
    try:
        return json.loads(text, parse_int=_whole_number)
    except json.JSONDecodeError as error:
        raise InputError(path, error.lineno, error.colno, f"no JSON: {error.msg}") from error
    except (RecursionError, ValueError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise InputError(path, None, None, f"no JSON: {reason}") from error


def _whole_number(digits: str) -> int:
    """Read a whole number that any number type of what reads the document has room for.

    Raises:
        ValueError: It has more than 64 bits.
    """
    number = int(digits)
    if number.bit_length() >= 64:
        raise ValueError(f"a whole number beyond 64 bits: {quoted(digits)}")
    return number


def refuse_special_or_large(path: Path, max_bytes: int) -> None:
    """Raise InputError for what is no regular file or holds more bytes than can be meant."""
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError(path, None, None, "not a regular file")
    if status.st_size > max_bytes:
        message = f"larger than {max_bytes} bytes, which is the most that is read"
        raise InputError(path, None, None, message)


def _replace(target: Path, data: bytes) -> None:
    temporary = temporary_sibling(target)
    try:
        _write_synced(temporary, data)
        replace(temporary, target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _write_through(target: Path, data: bytes) -> None:
    """Write to what is no file, once it takes something."""
    with os.fdopen(_opened(target), "wb", buffering=0) as stream:
        os.set_blocking(stream.fileno(), True)
        rest = memoryview(data)
        while rest:
            rest = rest[stream.write(rest) :]


def _opened(target: Path) -> int:
    """Open for writing; ask again until a pipe has a reader.

    A call that waits for one would not end by a signal that came just before it.
    """
    while True:
        try:
            return os.open(target, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno != errno.ENXIO or not target.is_fifo():
                raise
        time.sleep(NO_READER_S)


def _write_synced(path: Path, data: bytes) -> None:
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
