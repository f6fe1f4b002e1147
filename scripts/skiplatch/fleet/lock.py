"""One writer at a time."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.files import failures_named
from skiplatch.fleet.layout import LOCK_FILE


class BusyError(InputError):
    """Another one writes to the store; it will be done some time."""


@contextmanager
def written_alone(store: Path) -> Iterator[None]:
    """Hold the store against other writers; the kernel lets go of it if this process dies.

    Raises:
        BusyError: Another one writes to it.
    """
    with failures_named(store / LOCK_FILE, "write"):
        lock = os.open(store / LOCK_FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            message = "another skiplatch writes to this store; try again when it is done"
            raise BusyError(store, None, None, message) from error
        yield
    finally:
        os.close(lock)
