"""Refuse slow arithmetic in interrupt code: `lint_isr_objects.py OBJECT_FOLDER` of an AVR build.

An AVR has neither a divider nor floating point, so either shows up as a call to a routine of libgcc
that takes hundreds of cycles.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

INTERRUPT_SOURCES = ("firmware/input/latch.c", "firmware/input/skip_input.c")
DIVISION = re.compile(r"^__(?:u?div|u?mod|u?divmod)[a-z]*\d*$")
FLOATING_POINT = re.compile(
    r"^__(?:add|sub|mul|div|neg|cmp|eq|ne|lt|le|gt|ge|unord|float\w*|fix\w*)(?:[sd]f)\w*$"
)


def undefined_symbols(path: Path) -> list[str]:
    """Return what the object file calls from elsewhere."""
    listing = subprocess.run(
        ["avr-nm", "--undefined-only", "--format=posix", str(path)],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return [line.split()[0] for line in listing.splitlines() if line]


def main(arguments: list[str]) -> int:
    """Print the faults; 1 if there are any."""
    faults = []
    for source in INTERRUPT_SOURCES:
        path = Path(arguments[0], source).with_suffix(".o")
        if not path.is_file():
            faults.append(f"{path}: not there to be checked")
            continue
        for symbol in undefined_symbols(path):
            if DIVISION.match(symbol):
                faults.append(f"{source}: divides in software ({symbol})")
            elif FLOATING_POINT.match(symbol):
                faults.append(f"{source}: floating point ({symbol})")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
