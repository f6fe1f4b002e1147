"""The ATmega328P port in simavr: a short run of what `make boards` measures at length.

simavr 1.6 omits the four cycles in which the chip enters an interrupt; they are in no figure here.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from hal.ports.atmega328p.tests import emulator, simavr_rig
from hal.ports.atmega328p.tests.edges import Block, commands, plan
from hal.ports.atmega328p.tests.emulator import (
    CAPTURE,
    CYCLES_PER_US,
    PIN_CHANGE,
    TIMER_TICKS,
    Events,
    Stimulus,
)
from skiplatch.campaign import InputPath
from tests.boards.record import Recorded

FOLDER = Path("build/boards/atmega328p")
TOUCHES = 60  # on each path
TICK_US = 0.0625
BODY_CYCLES = 120
SPACING_US = 20
TRAIN = 32  # what a contact may bounce in a row
PULSE_CYCLES = CYCLES_PER_US  # 1 µs
SCAN_US = 2000.0
# Beside the scan: what the interrupts that come before it take, and reading clock and line.
SCAN_LATE_US = 60.0
PRESCALER = 64
# Disturbances that move a captured stamp are not among these.
PROOF = ("nominal", "other_interrupt", "critical_section", "scan_body")
ALL = (
    *PROOF,
    "pin_change",
    "prescaler",
    "software_filter",
    "pin_change-other_interrupt",
    "pin_change-critical_section",
)


def program(build: str) -> Path:
    """Give a program, or skip where it could not be built."""
    path = FOLDER / f"firmware-{build}.elf"
    if not path.exists() or not emulator.RIG.exists():
        pytest.skip("no ATmega328P board here: scripts/setup/system.sh cross emulators")
    return path


@cache
def played(build: str) -> tuple[Events, list[Recorded]]:
    """Run a program once."""
    stimuli, blocks = plan(TOUCHES, seed=1)
    events = emulator.run(program(build), stimuli)
    touches = simavr_rig.recorded(events, blocks, PRESCALER if "prescaler" in build else 1)
    return events, touches


def late_us(build: str, path: InputPath) -> np.ndarray:
    """Give latch minus edge of all touches on a path, in µs; NaN where there was no latch."""
    return np.array([t.latch_us - t.edge_us for t in played(build)[1] if t.path == path])


# ---- the captured stamp --------------------------------------------------------------------------


@pytest.mark.parametrize("build", PROOF)
def test_the_captured_stamp_is_within_a_tick_of_every_edge(build: str) -> None:
    late = late_us(build, InputPath.SKIP)

    assert len(late) == TOUCHES
    assert np.abs(late).max() <= TICK_US


def test_a_coarser_clock_stamps_within_one_of_its_ticks() -> None:
    late = late_us("prescaler", InputPath.SKIP)

    assert late.min() >= -PRESCALER * TICK_US
    assert late.max() <= TICK_US
    assert np.ptp(late) > TICK_US  # it is not the finer one


@pytest.mark.parametrize("build", ["nominal", "other_interrupt"])
def test_an_edge_about_an_overflow_of_the_timer_keeps_its_time(build: str) -> None:
    zero = emulator.run(program(build), [(200_000, "q", 0)]).clock_zero(prescaler=1)
    random = np.random.default_rng(2)
    turns = zero + TIMER_TICKS * (2 + np.arange(3 * TOUCHES))
    rises = turns + random.integers(-60, 60, len(turns))
    stimuli = commands(20_000, "3", "s")
    for rise in rises:
        stimuli += [(int(rise), "e", 1), (int(rise) + 800, "e", 0)]
    stimuli.append((int(rises[-1]) + 50_000, "q", 0))
    events = emulator.run(program(build), stimuli)
    block = Block(InputPath.SKIP, 3000.0, len(rises))

    touches = simavr_rig.recorded(events, [block], prescaler=1)

    assert max(abs(t.latch_us - t.edge_us) for t in touches) <= TICK_US


# ---- the edge interrupt --------------------------------------------------------------------------


@pytest.mark.parametrize("build", ["nominal", "other_interrupt"])
def test_the_edge_interrupt_is_short(build: str) -> None:
    assert played(build)[0].bodies[CAPTURE].most <= BODY_CYCLES


def train(spacing_us: int, high_cycles: int, edges: int, trains: int) -> list[Stimulus]:
    """Give trains of edges at random cycles, the axis at its fastest, on the skip path."""
    random = np.random.default_rng(3)
    stimuli = commands(20_000, "3", "s")
    cycle = 100_000
    for _ in range(trains):
        cycle += int(random.integers(30_000, 50_000))
        for i in range(edges):
            rise = cycle + i * spacing_us * CYCLES_PER_US
            stimuli += [(rise, "e", 1), (rise + high_cycles, "e", 0)]
        cycle += edges * spacing_us * CYCLES_PER_US
    return [*stimuli, (cycle + 50_000, "q", 0)]


def test_no_edge_is_lost_20_us_after_another() -> None:
    trains = 10 * TOUCHES // TRAIN
    events = emulator.run(program("nominal"), train(SPACING_US, 160, TRAIN, trains))

    assert events.bodies[CAPTURE].calls == TRAIN * trains
    assert events.lost == 0


def test_every_pulse_of_a_microsecond_is_seen() -> None:
    events = emulator.run(program("nominal"), train(2000, PULSE_CYCLES, 1, 5 * TOUCHES))
    block = Block(InputPath.SKIP, 3000.0, 5 * TOUCHES)

    touches = simavr_rig.recorded(events, [block], prescaler=1)

    assert not np.isnan([t.latch_us for t in touches]).any()


def test_an_armed_skip_input_costs_nothing_while_no_edge_comes() -> None:
    busy = []
    for letter in "ns":
        stimuli = [*commands(20_000, "3", letter), (8_000_000, "q", 0)]
        events = emulator.run(program("nominal"), stimuli)
        assert CAPTURE not in events.bodies
        busy.append(events.busy)

    assert busy[0] == busy[1]


# ---- the other paths -----------------------------------------------------------------------------


def test_the_pin_change_stamp_is_late_by_the_interrupts_that_mask_it() -> None:
    late = late_us("pin_change", InputPath.SKIP)

    assert late.min() > 0.0
    assert late.max() < 20.0
    assert played("pin_change")[0].bodies[PIN_CHANGE].calls >= TOUCHES


def test_the_plc_task_latches_at_the_next_scan() -> None:
    late = late_us("nominal", InputPath.PLC)

    assert len(late) == TOUCHES
    assert late.min() > -SCAN_LATE_US
    assert late.max() < SCAN_US + SCAN_LATE_US
    assert np.ptp(late) > SCAN_US / 2.0  # false alarm: less than 60 · 2⁻⁵⁹


# ---- the axis ------------------------------------------------------------------------------------


@pytest.mark.parametrize("build", ALL)
def test_pulses_on_the_pin_are_pulses_in_the_firmware(build: str) -> None:
    checks = played(build)[0].checks

    assert len(checks) == 2 * TOUCHES
    assert all(pulses == counts for pulses, counts in checks)


def test_the_latched_position_is_within_a_step_of_the_edge() -> None:
    off = [t.deviation_um for t in played("nominal")[1] if t.path == InputPath.SKIP]

    assert min(off) >= 0.0
    assert max(off) <= simavr_rig.RESOLUTION_UM


def test_touch_cycles_measure_the_surface() -> None:
    events = emulator.run(program("nominal"), cycles(4))

    measured = [latch.position_counts for latch, _ in simavr_rig.latches(events)]
    assert len(measured) == 4
    assert measured == [pulses for _, pulses in events.rises[1::2]]
    assert all(pulses == counts for pulses, counts in events.checks)


def cycles(count: int) -> list[Stimulus]:
    """Deflect the probe as if a surface stood 1000 steps from the start of each cycle.

    The times follow from the motion: 1000 mm/min is 1,920 cycles a step, 100 mm/min 19,200.
    """
    fast, slow = 1_920, 19_200
    stimuli = commands(20_000, "c")
    cycle = 20_000
    for _ in range(count):
        touch = cycle + 1000 * fast
        retreat = touch + 40_000
        again = retreat + 120 * fast + 200_000 + 100 * slow
        stimuli += [(touch, "e", 1), (retreat, "e", 0), (again, "e", 1), (again + 40_000, "e", 0)]
        cycle = again + 1200 * fast + 800_000
    return [*stimuli, (cycle, "q", 0)]
