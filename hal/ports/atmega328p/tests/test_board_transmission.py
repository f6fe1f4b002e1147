"""The ATmega328P measures a transmission error in simavr: a short run of `make boards`."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from hal.ports.atmega328p.tests import emulator, transmission_rig
from hal.ports.atmega328p.tests.emulator import Events
from hal.ports.atmega328p.tests.simavr_rig import FRAME_BYTES
from hal.ports.atmega328p.tests.transmission_rig import Trains
from skiplatch.transmission.firmware import NAS_PER_ARCSEC

PROGRAM = Path("build/boards/atmega328p/transmission.elf")
SPEED_REV_S = 5.0
SUSTAINED_PER_S = 8000.0  # docs/TRANSMISSION.md: a little more
BURST, BURST_PER_S = 128, 130_000.0
LATE_CYCLES = 115  # an interrupt that has just begun
LINE_ARCSEC = 1_296_000.0 / (1024 * 40.7)


@pytest.fixture(autouse=True)
def _board() -> None:
    if not PROGRAM.exists() or not emulator.RIG.exists():
        pytest.skip("no ATmega328P board here: scripts/setup/system.sh cross emulators")


@cache
def played(speed_rev_s: float = SPEED_REV_S) -> tuple[Trains, Events]:
    """Have the program measure a second of the chain."""
    given = transmission_rig.trains(speed_rev_s, 1.0)
    return given, transmission_rig.play(PROGRAM, given)


def test_no_pulse_is_lost_at_the_sustained_rate() -> None:
    given, events = played(SUSTAINED_PER_S / (1024 + 3600 / 40.7))

    assert given.per_s > 0.99 * SUSTAINED_PER_S
    assert transmission_rig.unseen(events) == 0
    assert len(transmission_rig.board_points(events)) > 600


def test_a_burst_is_taken_at_the_rate_of_the_interrupts() -> None:
    burst = transmission_rig.trains(BURST_PER_S / (1024 + 3600 / 40.7), 0.01).first(BURST)

    assert burst.per_s > 0.99 * BURST_PER_S
    assert transmission_rig.unseen(transmission_rig.play(PROGRAM, burst)) == 0


def test_the_output_is_stamped_exactly_and_the_input_after_what_masks_it() -> None:
    _, events = played()

    assert np.all(transmission_rig.late_cycles(events, 1) == 0)
    late = transmission_rig.late_cycles(events, 0)
    assert late.min() >= 0
    assert late.max() <= LATE_CYCLES
    assert np.mean(late <= transmission_rig.EXTRA_CYCLES) > 0.85


def test_the_points_are_those_of_the_host_for_the_same_stamps() -> None:
    _, events = played()

    off = transmission_rig.off_arcsec(
        transmission_rig.board_points(events),
        transmission_rig.host_points(*transmission_rig.noted(events)),
    )

    assert len(off) > 430
    assert np.mean(off == 0) > transmission_rig.SAME_SHARE
    assert np.abs(off).max() < transmission_rig.SWAPPED_ARCSEC


def test_lost_pulses_begin_a_new_part_and_leave_no_step() -> None:
    _, events = played(12.0)
    data = bytes(value for _, value in events.received)
    frames = [data[i : i + FRAME_BYTES] for i in range(0, len(data), FRAME_BYTES)]
    parts = np.array([frame[0] for frame in frames])
    delta = np.array([int.from_bytes(frame[3:8], "little", signed=True) for frame in frames])
    arcsec = delta * (transmission_rig.NAS_PER_UNIT / NAS_PER_ARCSEC)

    assert transmission_rig.unseen(events) > 0
    assert parts[-1] == sum(lost > 0 for _, _, lost in events.notes) > 0
    steps = np.abs(np.diff(arcsec))[np.diff(parts) == 0]
    assert len(steps) > 50
    assert steps.max() < LINE_ARCSEC / 4.0
