"""Run one suite on the Cortex-M3 in QEMU, with its pin and its UARTs wired to themselves.

    python -m hal.ports.cortex_m3.tests.qemu_suite build/boards/cortex_m3/contract/test_hal_edge

The report comes by semihosting, and so does the exit status.
"""

import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from hal.ports.cortex_m3.tests.emulator import Emulator

TIMEOUT_S = 240.0
SEMIHOSTING = (
    *("-chardev", "stdio,id=report"),
    *("-semihosting-config", "enable=on,target=native,chardev=report"),
)


def main() -> int:
    """Run the suite on the command line; give its exit status."""
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    with Emulator(Path(sys.argv[1]), SEMIHOSTING, loops_back=True) as emulator:
        with suppress(ConnectionError):  # a short suite is over before QEMU has answered
            emulator.go()
        try:
            return emulator.process.wait(TIMEOUT_S)
        except subprocess.TimeoutExpired:
            print(f"no end after {TIMEOUT_S:g} s")
            return 1


if __name__ == "__main__":
    sys.exit(main())
