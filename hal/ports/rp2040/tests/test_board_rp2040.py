"""The RP2040 port in rp2040js: a short run of what `make boards` measures at length."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from hal.ports.rp2040.tests.emulator import Emulator
from hal.ports.rp2040.tests.rig import RESOLUTION_UM, Rp2040
from tests.boards.qemu_checks import Checks, astray_um, speeds_um_us
from tests.boards.qemu_rig import symbols_of
from tests.boards.record import Recorded
from tests.boards.train_checks import counted_by_latch, records_in

PROGRAM = Path("build/boards/rp2040/firmware.elf")
TICK_US = 1.0
SKIP_LATE_US = 3.0
STEPS, EDGE = 4, 13  # interrupts
TRAIN, SPACING_NS = 512, 20_000
REST_NS = 100_000_000
STEPS_AT_REST = 1000  # of 5 µm, at 3000 mm/min


class TestRp2040(Checks):
    """The line waits for the firmware's own critical sections at most."""

    RIG = Rp2040
    TOUCHES = 30
    SKIP_LATE_US = SKIP_LATE_US
    SCAN_LATE_US = 8.0
    SCAN_WAVERS_US = 8.0
    STAMP_EARLY_US = TICK_US

    def test_positions_are_those_of_their_stamps_to_half_a_count(
        self, recorded: list[Recorded]
    ) -> None:
        step_late_um = speeds_um_us(recorded) * (2.0 * SKIP_LATE_US + TICK_US)

        assert (astray_um(recorded) <= RESOLUTION_UM / 2.0 + step_late_um).all()


@pytest.fixture(scope="module")
def symbols() -> dict[str, int]:
    if not Emulator.is_here() or not PROGRAM.exists():
        pytest.skip("no rp2040 here: make setup-test says what is missing")
    return symbols_of(PROGRAM, Emulator.NM)


@pytest.fixture
def running(symbols: dict[str, int]) -> Iterator[Emulator]:
    """Give the board with its skip input armed, scanning, its axis at 3000 mm/min."""
    with Emulator(PROGRAM) as emulator:
        Rp2040(emulator, symbols, 0).start_block(b"s", b"3")
        yield emulator


def told_of(running: Emulator, symbols: dict[str, int]) -> int:
    """Give how many edges the skip input has told of: sent, or counted by its latch."""
    return counted_by_latch(running, symbols) + records_in(len(running.sent))


def test_no_edge_of_a_train_is_lost_while_all_interrupts_run(
    running: Emulator, symbols: dict[str, int]
) -> None:
    before = told_of(running, symbols)
    for _ in range(TRAIN):
        running.deflect_in(SPACING_NS // 2)
        running.run(SPACING_NS)
    running.run(REST_NS)

    assert told_of(running, symbols) - before == TRAIN


def test_an_armed_input_costs_nothing_while_the_line_rests(running: Emulator) -> None:
    before = running.entered(EDGE), running.entered(STEPS)
    running.run(REST_NS)

    assert running.entered(EDGE) == before[0]
    assert running.entered(STEPS) - before[1] == pytest.approx(STEPS_AT_REST, abs=1)
