"""The skip input on core 1 of the RP2040, in rp2040js with a second core."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from hal.ports.rp2040.tests.emulator import NODE, Emulator
from hal.ports.rp2040.tests.rig import Rp2040
from skiplatch.campaign import InputPath
from tests.boards.qemu_checks import late_us
from tests.boards.qemu_rig import play, symbols_of
from tests.boards.train_checks import COUNTERS, records_in

BUILDS = Path("build/boards/rp2040")
TWO_CORES = "firmware-two_cores.elf"
MASKING = {"one": "firmware-critical_section.elf", "two": "firmware-two_cores-critical_section.elf"}
TOUCHES = 30
TICK_US = 1.0
HANDLER_US = 1.0
SCAN_US = 1000.0
SCAN_LATE_US = 8.0
MASKED_US = 80.0
EDGE = 13  # interrupt
TRAIN, SPACING_NS = 512, 20_000
REST_NS = 100_000_000
SECOND_CORE = Path(__file__).with_name("second_core.js").resolve()


def build(name: str) -> Path:
    program = BUILDS / name
    if not Emulator.is_here() or not program.exists():
        pytest.skip(f"no rp2040js or no {program} here: make setup-test says what is missing")
    return program


@contextmanager
def running(name: str) -> Iterator[tuple[Emulator, dict[str, int]]]:
    """Give a program with its skip input armed, scanning, its axis at 3000 mm/min."""
    program = build(name)
    symbols = symbols_of(program, Emulator.NM)
    with Emulator(program) as emulator:
        Rp2040(emulator, symbols, 0).start_block(b"s", b"3")
        yield emulator, symbols


def told_of(emulator: Emulator, symbols: dict[str, int]) -> int:
    """Give how many edges the skip input has told of: sent, or counted by its latch."""
    counters = symbols["skip"] + COUNTERS
    words = [emulator.read(counters), emulator.read(counters + 4)]
    return sum((word & 0xFFFF) + (word >> 16) for word in words) + records_in(len(emulator.sent))


def test_core_1_latches_at_once_and_core_0_at_the_next_scan() -> None:
    played = play(Rp2040, build(TWO_CORES), TOUCHES)
    skip, plc = (late_us(played, path) for path in (InputPath.SKIP, InputPath.PLC))

    assert len(skip) == len(plc) == TOUCHES
    assert skip.min() > -TICK_US
    assert skip.max() < HANDLER_US
    assert plc.min() > -TICK_US
    assert plc.max() < SCAN_US + SCAN_LATE_US
    assert np.ptp(plc) > SCAN_US / 2.0  # false alarm: n · 2^(1 − n)


def test_a_mask_of_core_0_delays_the_skip_input_there_and_not_on_core_1() -> None:
    """One in six edges falls into the mask. False alarm: 0.84^100 on core 0."""
    late = {
        cores: late_us(play(Rp2040, build(name), 100, paths="s"), InputPath.SKIP)
        for cores, name in MASKING.items()
    }

    assert late["one"].max() > HANDLER_US
    assert late["one"].max() < MASKED_US + HANDLER_US
    assert late["two"].max() < HANDLER_US


def test_edges_interrupt_core_1_alone() -> None:
    with running(TWO_CORES) as (emulator, _):
        for _ in range(TOUCHES):
            emulator.deflect_in(SPACING_NS)
            emulator.run(2 * SPACING_NS)

        assert emulator.entered(EDGE, core=1) == TOUCHES
        assert emulator.entered(EDGE, core=0) == 0


def test_no_edge_of_a_train_is_lost_on_core_1() -> None:
    with running(TWO_CORES) as (emulator, symbols):
        before = told_of(emulator, symbols)
        for _ in range(TRAIN):
            emulator.deflect_in(SPACING_NS // 2)
            emulator.run(SPACING_NS)
        emulator.run(REST_NS)

        assert told_of(emulator, symbols) - before == TRAIN


def test_an_armed_input_costs_core_1_nothing_while_the_line_rests() -> None:
    with running(TWO_CORES) as (emulator, _):
        emulator.run(REST_NS)

        assert emulator.entered(EDGE, core=1) == 0


def test_core_1_is_not_started_by_other_words_than_its_rom_asks_for() -> None:
    if not Emulator.is_here():
        pytest.skip("no rp2040js here: make setup-test says what is missing")
    script = f"""
        const {{ Machine }} = require('{SECOND_CORE.with_name("machine.js")}');
        const {{ chip, cores }} = new Machine('{build(TWO_CORES).resolve()}');
        for (const word of [0, 0, 1, 0x10000100, 0x20001000]) chip.writeUint32(0xd0000054, word);
        console.log(cores.length);
        chip.writeUint32(0xd0000054, 0x10000201);
        console.log(cores.length, cores[1].core.PC === 0x10000200);
        new Machine('{build(TWO_CORES).resolve()}').chip.writeUint32(0xd0000054, 1);
    """
    done = subprocess.run((NODE, "-e", script), capture_output=True, text=True, check=False)

    assert done.stdout == "1\n2 true\n"
    assert "core 1 is asked to start by 1 in place of 0" in done.stderr
