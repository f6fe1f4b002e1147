"""Seals of commands under a key that host and injector share, docs/INJECTION.md."""

import re
import stat
from pathlib import Path

from siphash24 import siphash24

from skiplatch.errors import InputError
from skiplatch.files import failures_named, read_bytes

KEY = re.compile(rb"([0-9a-fA-F]{32})(?:\r?\n)?")
SEAL_BYTES = 5
COMMAND_BYTES = 7  # all of a frame but its checksum
NO_SHOT = bytes(10)
OTHERS = stat.S_IRWXG | stat.S_IRWXO
MOST_BYTES = 4096


def read_key(path: Path) -> bytes:
    """Read a key of 32 hexadecimal digits.

    Raises:
        InputError: The file cannot be read, may be read by others, or holds anything else. The
            message never shows what stands in it.
    """
    data = read_bytes(path, MOST_BYTES)
    with failures_named(path, "read"):
        if path.stat().st_mode & OTHERS:
            message = "others may read or change this key; chmod 600 it"
            raise InputError(path, None, None, message)
    found = KEY.fullmatch(data)
    if found is None:
        raise InputError(path, None, None, "not a key: expected 32 hexadecimal digits")
    return bytes.fromhex(found[1].decode())


def shot_bytes(line: int, level: int, count: int, width_us: int, period_us: int) -> bytes:
    """Give what a TRIGGER plays as it is sealed."""
    numbers = ((line, 1), (level, 1), (count, 2), (width_us, 3), (period_us, 3))
    return b"".join(number.to_bytes(size, "little") for number, size in numbers)


class Sealer:
    """Seals the ARM that opens a session, and then its TRIGGERs, one after the other."""

    def __init__(self, key: bytes) -> None:
        self._key = key
        self._challenge = bytes(SEAL_BYTES)
        self._number = 0

    def begin(self, challenge: int) -> None:
        """Seal for a new session from now on; its challenge is the injector's."""
        self._challenge = challenge.to_bytes(SEAL_BYTES, "little")
        self._number = 0

    def seal(self, frame: bytes, shot: bytes = NO_SHOT) -> int:
        """Give the seal of a command; an ARM has no shot."""
        number = self._number.to_bytes(4, "little")
        sealed = self._challenge + number + frame[:COMMAND_BYTES] + shot
        return int.from_bytes(siphash24(sealed, key=self._key).digest()[:SEAL_BYTES], "little")

    def go_on(self) -> None:
        """Seal for the next place in the session: what was sealed was obeyed."""
        self._number += 1
