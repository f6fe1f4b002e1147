"""The port with grbl's pins in simavr: a short run of what `make boards` measures at length."""

from pathlib import Path

import numpy as np
import pytest

from hal.ports.atmega328p.tests import emulator
from hal.ports.atmega328p_grbl.tests.grbl_rig import Touch, play

PROGRAM = Path("build/boards/atmega328p_grbl/firmware.elf")
TOUCHES = 60
LATE_US = 30.0  # an interrupt behind another one: the pin's, the step's, the UART's
PULSE_LATE_US = 12.0  # the step interrupt begins with sums
OFTEN = 0.9  # of the touches no pulse waits for another interrupt
UM_US_PER_MM_MIN = 1.0 / 60_000.0


@pytest.fixture(scope="module")
def played() -> list[Touch]:
    """Record one run."""
    if not PROGRAM.exists() or not emulator.RIG.exists():
        pytest.skip("no ATmega328P board here: scripts/setup/system.sh cross emulators")
    events, touches = play(PROGRAM, TOUCHES)
    assert all(pulses == steps for pulses, steps in events.checks)
    return touches


def test_every_edge_is_stamped_at_once(played: list[Touch]) -> None:
    late = np.array([touch.late_us for touch in played])

    assert len(late) == TOUCHES
    assert np.all((late > 0.0) & (late < LATE_US))


def test_the_latched_place_is_that_of_the_stamp_between_two_pulses(played: list[Touch]) -> None:
    speed_um_us = np.array([touch.feed_mm_min for touch in played]) * UM_US_PER_MM_MIN
    late = np.array([touch.late_us for touch in played])
    off = np.array([touch.off_um for touch in played])

    apart_um = np.abs(off - speed_um_us * late)
    assert np.all(apart_um < 0.1 + speed_um_us * LATE_US)
    assert np.mean(apart_um < 0.1 + speed_um_us * PULSE_LATE_US) > OFTEN
