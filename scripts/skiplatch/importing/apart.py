"""Reading in a process of its own: of damaged files asammdf dies, or logs more than a line."""

import os
import warnings
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

from pebble import ProcessExpired, concurrent

from skiplatch.errors import CampaignWarning, InputError

Read = TypeVar("Read")

LIMIT_S = 600.0
"""After so long the reader hangs."""
STDERR = 2


def read_apart(reader: Callable[[Path], Read], path: Path) -> Read:
    """Give what the reader makes of a file, and its warnings; it is a function of a module.

    Raises:
        InputError: The reader refuses it, dies of it, or comes to no end.
    """
    read: Read
    try:
        read, told = _read(reader, path).result()
    except ProcessExpired as error:
        raise InputError(path, None, None, "cannot be read: its reader died of it") from error
    except TimeoutError as error:
        said = f"cannot be read: its reader came to no end within {LIMIT_S:g} s"
        raise InputError(path, None, None, said) from error
    for warning in told:
        warnings.warn(warning, stacklevel=2)
    return read


@concurrent.process(timeout=LIMIT_S, mp_context=get_context("forkserver"))
def _read(reader: Callable[[Path], Read], path: Path) -> tuple[Read, list[CampaignWarning]]:
    os.dup2(os.open(os.devnull, os.O_WRONLY), STDERR)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", CampaignWarning)
        read = reader(path)
    return read, [one.message for one in caught if isinstance(one.message, CampaignWarning)]
