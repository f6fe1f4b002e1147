"""Run one suite on the Cortex-M3 in QEMU.

python -m hal.ports.cortex_m3.tests.qemu_suite build/boards/cortex_m3/contract/test_hal_edge
"""

import sys

from hal.ports.cortex_m3.tests.emulator import Emulator
from tests.boards.qemu_suite import run_suite

if __name__ == "__main__":
    sys.exit(run_suite(Emulator))
