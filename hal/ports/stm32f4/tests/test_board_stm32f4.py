"""The STM32F4 port in QEMU: a short run of what `make boards` measures at length."""

from pathlib import Path

import numpy as np
import pytest

from hal.ports.stm32f4.tests.emulator import Emulator
from hal.ports.stm32f4.tests.qemu_rig import BELIEVED, RESOLUTION_UM, Stm32F4
from skiplatch.campaign import InputPath
from tests.boards.qemu_rig import play
from tests.boards.record import Recorded

PROGRAM = Path("build/boards/stm32f4/firmware.elf")
TOUCHES = 30  # on each path
SKIP_LATE_US = 1.2  # the longest stretch in which the port masks interrupts, and the handler
SCAN_LATE_US = 2.5  # from SysTick by way of the line to the clock, and a byte that leaves meanwhile
UM_US_PER_MM_MIN = 1.0 / 60_000.0  # µm/µs in a mm/min


@pytest.fixture(scope="module")
def recorded() -> list[Recorded]:
    """Record one run."""
    if not Path(Emulator.QEMU).exists() or not PROGRAM.exists():
        pytest.skip("no STM32F4 board here: hal/ports/stm32f4/setup.sh, make setup-test")
    return play(Stm32F4, PROGRAM, TOUCHES)


def late_us(recorded: list[Recorded], path: InputPath) -> np.ndarray:
    """Give latch minus edge, in µs; NaN where none was latched."""
    return np.array([t.latch_us - t.edge_us for t in recorded if t.path == path])


def test_the_skip_input_latches_every_edge_at_once(recorded: list[Recorded]) -> None:
    late = late_us(recorded, InputPath.SKIP)

    assert len(late) == TOUCHES
    assert np.all((late > 0.0) & (late < SKIP_LATE_US))


def test_the_plc_task_latches_every_edge_at_the_next_scan(recorded: list[Recorded]) -> None:
    late = late_us(recorded, InputPath.PLC)
    latch_us = np.array([t.latch_us for t in recorded if t.path == InputPath.PLC])
    scans = (latch_us - latch_us[0]) / BELIEVED.plc.scan_us

    assert len(late) == TOUCHES
    assert np.all((late > 0.0) & (late < BELIEVED.plc.scan_us + SCAN_LATE_US))
    assert np.abs(scans - np.round(scans)).max() * BELIEVED.plc.scan_us < SCAN_LATE_US


def test_positions_are_the_counts_at_their_stamps(recorded: list[Recorded]) -> None:
    late = np.array([t.latch_us - t.edge_us for t in recorded])
    deviation_um = np.array([t.deviation_um for t in recorded])
    speed_um_us = np.array([t.feed_mm_min for t in recorded]) * UM_US_PER_MM_MIN

    off_um = np.abs(deviation_um - speed_um_us * late)

    assert off_um.max() <= 2.0 * RESOLUTION_UM  # the count at the edge is rounded, and so is this
