"""Packed logs: a few megabytes may unpack to more than any machine has memory for."""

import gzip
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from skiplatch.errors import InputError

CHUNK = 1 << 20
PACKED = ".gz"


@contextmanager
def unpacked(path: Path, max_bytes: int) -> Iterator[Path]:
    """Give a file unpacked: itself where its name does not end in .gz, else for a while a copy.

    Raises:
        InputError: It holds more than can be meant.
    """
    if path.suffix.lower() != PACKED:
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="skiplatch-") as folder:
        copy = Path(folder) / path.stem  # its ending tells the library what it is
        with gzip.open(path) as packed, copy.open("wb") as plain:
            while chunk := packed.read(CHUNK):
                if plain.tell() + len(chunk) > max_bytes:
                    raise _too_large(path, path.stem, max_bytes)
                plain.write(chunk)
        yield copy


def read_member(path: Path, archive: zipfile.ZipFile, name: str, max_bytes: int) -> bytes:
    """Read a member of a zip.

    Raises:
        InputError: It holds more than can be meant.
        KeyError: There is none of that name.
    """
    if archive.getinfo(name).file_size > max_bytes:
        raise _too_large(path, name, max_bytes)
    return archive.read(name)


def _too_large(path: Path, name: str, max_bytes: int) -> InputError:
    message = f"{name} in it is larger than {max_bytes} bytes, which is the most that is read"
    return InputError(path, None, None, message)
