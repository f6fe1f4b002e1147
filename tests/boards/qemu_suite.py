"""Run one suite on a board in QEMU, with what it drives wired to its pin.

    python -m tests.boards.qemu_suite MODULE SUITE

MODULE has the board's `Emulator`, SUITE is the program of a suite.

The report comes by semihosting, and so does the exit status.
"""

import importlib
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

TIMEOUT_S = 240.0
SEMIHOSTING = (
    *("-chardev", "stdio,id=report"),
    *("-semihosting-config", "enable=on,target=native,chardev=report"),
)


def main(module: str, suite: str) -> int:
    """Run the suite; give its exit status."""
    board = importlib.import_module(module).Emulator
    with board(Path(suite), SEMIHOSTING, loops_back=True) as emulator:
        with suppress(ConnectionError):  # a short suite is over before QEMU has answered
            emulator.go()
        try:
            return int(emulator.process.wait(TIMEOUT_S))
        except subprocess.TimeoutExpired:
            print(f"no end after {TIMEOUT_S:g} s")
            return 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
