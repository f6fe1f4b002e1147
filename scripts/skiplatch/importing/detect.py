"""Which kind of log a file is, by what stands in it."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.importing.grbl import read_grbl
from skiplatch.importing.klipper import read_klipper
from skiplatch.importing.linuxcnc import read_linuxcnc
from skiplatch.importing.log_lines import read_text
from skiplatch.importing.marlin import read_marlin
from skiplatch.importing.model import Imported

_NINE_NUMBERS = r"^\s*(?:-?\d+\.\d+\s+){8}-?\d+\.\d+\s*$"
KINDS: Mapping[str, tuple[re.Pattern[str], Callable[[Path], Imported]]] = {
    "grbl": (re.compile(r"\[PRB:"), lambda path: read_grbl(path, None)),
    "klipper": (
        re.compile(r"probe(?:: at| at) -?[\d.]+,", re.IGNORECASE),
        lambda path: read_klipper(path, None),
    ),
    "marlin": (
        re.compile(r"(?<!\d)\d{1,6} of \d{1,6}:?\s*z:|Bed X:"),
        lambda path: read_marlin(path, None),
    ),
    "linuxcnc": (
        re.compile(_NINE_NUMBERS, re.MULTILINE),
        lambda path: read_linuxcnc(path, None, None, None, inch=False),
    ),
}


def read_any(path: Path) -> tuple[str, Imported]:
    """Read a log of whatever kind and give the name of that.

    Raises:
        InputError: It cannot be read, or is of no kind that can be told.
    """
    text = read_text(path)
    for kind, (sign, read) in KINDS.items():
        if sign.search(text):
            return kind, read(path)
    kinds = ", ".join(KINDS)
    message = f"expected a campaign or a log of {kinds}; for others see skiplatch import"
    raise InputError(path, None, None, message)
