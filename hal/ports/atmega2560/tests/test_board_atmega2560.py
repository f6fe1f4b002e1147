"""The ATmega2560 port in simavr: a short run of its program, and its stack against the bound."""

import importlib
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from skiplatch.bench.latches import Latch, LatchReports

PROGRAM = Path("build/boards/atmega2560/firmware.elf")
RUN = Path("build/rigs/atmega2560/tests/run")
RAM_BYTES = 8192
FRAME_BYTES = 8
TOUCHES = 300
STEP_US = 200
SEEN_TO_US = 15  # from the edge until its interrupt has read the position
SCAN_CYCLES = 4000 * 16
PLC_LATE_CYCLES = 50 * 16  # until the scan has read its clock, behind any other interrupt


@dataclass(frozen=True)
class Run:
    """Rising edges (cycle, steps), the records that came of them, and the stack they took."""

    edges: list[tuple[int, int]]
    latches: list[Latch]
    stack_bytes: int


def play(path: str) -> Run:
    if not (PROGRAM.exists() and RUN.exists()):
        pytest.skip("no ATmega2560 here: scripts/setup/system.sh cross emulators")
    command = [str(RUN), str(PROGRAM), path, str(TOUCHES), "1"]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    rows = [line.split() for line in lines]
    sent = bytes(int(row[1]) for row in rows if row[0] == "byte")
    reports = LatchReports()
    taken = [reports.take(sent[i : i + FRAME_BYTES]) for i in range(0, len(sent), FRAME_BYTES)]
    assert (reports.damaged, reports.lost, reports.unpaired) == (0, 0, 0)
    return Run(
        [(int(row[1]), int(row[2])) for row in rows if row[0] == "edge"],
        [latch for latch in taken if latch is not None],
        next(int(row[1]) for row in rows if row[0] == "stack"),
    )


@pytest.fixture(scope="module")
def skip() -> Run:
    return play("s")


@pytest.fixture(scope="module")
def plc() -> Run:
    return play("p")


def late_cycles(run: Run) -> list[int]:
    """Ticks of the latch less the edge's cycle: the clock's own start is in all of them."""
    return [latch.ticks - edge for (edge, _), latch in zip(run.edges, run.latches, strict=True)]


def test_every_touch_is_reported_on_its_path(skip: Run, plc: Run) -> None:
    assert [latch.path for latch in skip.latches] == ["skip"] * TOUCHES
    assert [latch.path for latch in plc.latches] == ["plc"] * TOUCHES


def test_a_captured_edge_is_stamped_to_the_tick(skip: Run) -> None:
    late = late_cycles(skip)

    assert max(late) - min(late) <= 1


def test_the_plc_stamps_at_its_next_scan(skip: Run, plc: Run) -> None:
    start = min(late_cycles(skip))  # the clock reads this at cycle 0
    late = [cycles - start for cycles in late_cycles(plc)]

    assert min(late) >= 0
    assert max(late) < SCAN_CYCLES + PLC_LATE_CYCLES
    assert max(late) - min(late) > SCAN_CYCLES // 2  # false alarm: 300 · 2⁻²⁹⁹


def test_the_position_is_that_of_the_edge_or_of_a_step_just_after_it(skip: Run) -> None:
    pairs = zip(skip.edges, skip.latches, strict=True)
    off = [latch.position_counts - counts for (_, counts), latch in pairs]

    assert set(off) <= {0, 1}
    assert sum(off) < 3.0 * TOUCHES * SEEN_TO_US / STEP_US  # false alarm: below 1e-9


def test_the_stack_stays_within_the_bound(skip: Run, plc: Run) -> None:
    sys.path.insert(0, str(Path("scripts/lint").resolve()))
    table = importlib.import_module("size_table")
    bound = table.measure("atmega2560", table.PROCESSORS["avr"])["atmega2560", "program"]
    most_bytes = max(skip.stack_bytes, plc.stack_bytes)

    assert bound.stack / 4 < most_bytes <= bound.stack
    assert bound.ram + bound.stack < RAM_BYTES
