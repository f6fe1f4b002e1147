"""Run one suite on the STM32F4 in QEMU.

python -m hal.ports.stm32f4.tests.qemu_suite build/boards/stm32f4/contract/test_hal_edge
"""

import sys

from hal.ports.stm32f4.tests.emulator import Emulator
from tests.boards.qemu_suite import run_suite

if __name__ == "__main__":
    sys.exit(run_suite(Emulator))
