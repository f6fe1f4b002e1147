"""Run one suite on a Cortex-M in QEMU, with its pin and its UARTs wired to themselves.

The report comes by semihosting, and so does the exit status.
"""

import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from tests.boards.qemu import QemuBoard

TIMEOUT_S = 240.0
SEMIHOSTING = (
    *("-chardev", "stdio,id=report"),
    *("-semihosting-config", "enable=on,target=native,chardev=report"),
)


def run_suite(board: type[QemuBoard]) -> int:
    """Run the suite on the command line; give its exit status."""
    if len(sys.argv) != 2:
        print(f"{sys.argv[0]} SUITE: the program of one", file=sys.stderr)
        return 2
    with board(Path(sys.argv[1]), SEMIHOSTING, loops_back=True) as emulator:
        with suppress(ConnectionError):  # a short suite is over before QEMU has answered
            emulator.go()
        try:
            return emulator.process.wait(TIMEOUT_S)
        except subprocess.TimeoutExpired:
            print(f"no end after {TIMEOUT_S:g} s")
            return 1
