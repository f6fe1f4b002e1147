"""The skip input beside a model of grblHAL's probe input, on the same touches in rp2040js."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from hal.ports.rp2040.tests.emulator import Emulator
from hal.ports.rp2040.tests.grblhal_rig import play

PROGRAM = Path("build/boards/rp2040/beside_grblhal.elf")
TOUCHES = 20
TICK_US = 1.0
HANDLER_US = 3.0
INTERRUPT_US = {100.0: 375.0, 1000.0: 75.0, 3000.0: 100.0}
"""From one interrupt of grblHAL's stepper to the next at a feed in mm/min, 200 steps/mm."""


@pytest.fixture(scope="module")
def late() -> dict[float, NDArray[np.float64]]:
    """Give µs and steps after the edge of both at each feed in mm/min; shape (n, 2, 2)."""
    if not Emulator.is_here() or not PROGRAM.exists():
        pytest.skip("no rp2040 here: make setup-test says what is missing")
    return play(PROGRAM, TOUCHES, seed=1)


@pytest.mark.parametrize("feed_mm_min", INTERRUPT_US)
def test_the_skip_input_latches_at_once(
    late: dict[float, NDArray[np.float64]], feed_mm_min: float
) -> None:
    us = late[feed_mm_min][:, 0, 0]

    assert us.min() > -TICK_US
    assert us.max() < HANDLER_US


@pytest.mark.parametrize("feed_mm_min", INTERRUPT_US)
def test_the_model_of_grblhal_latches_at_the_next_interrupt_of_its_stepper(
    late: dict[float, NDArray[np.float64]], feed_mm_min: float
) -> None:
    us = late[feed_mm_min][:, 1, 0]

    assert us.min() > -TICK_US
    assert us.max() < INTERRUPT_US[feed_mm_min] + HANDLER_US
    assert np.ptp(us) > INTERRUPT_US[feed_mm_min] / 2.0  # false alarm: n · 2^(1 − n)


def test_the_model_of_grblhal_is_a_step_late_where_each_interrupt_has_a_step(
    late: dict[float, NDArray[np.float64]],
) -> None:
    assert (late[3000.0][:, 1, 1] == 1.0).all()
