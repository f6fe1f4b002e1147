"""The Cortex-M3 port in QEMU: a short run of what `make boards` measures at length."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from hal.ports.cortex_m3.tests import qemu_rig
from skiplatch.bench.latches import Latch
from skiplatch.campaign import InputPath
from tests.boards.qemu_rig import play
from tests.boards.record import Recorded

PROGRAM = Path("build/boards/cortex_m3/firmware.elf")
TOUCHES = 90  # on each path: half a second of virtual time, so that SysTick wraps
EMULATED_SCAN_US = qemu_rig.BELIEVED.plc.scan_us  # QEMU's timers are a tick short
SKIP_LATE_US = 1.2  # the longest stretch in which the port masks interrupts, and the handler
SCAN_LATE_US = 5.0  # from the timer by way of the line, which is read first, to the clock
UM_US_PER_MM_MIN = 1.0 / 60_000.0
STEP_LATE_US = 2.0 * SKIP_LATE_US  # a step counts late: masked, then a more urgent interrupt
SCAN_WAVERS_US = 3.0 * SKIP_LATE_US  # masked, and two more urgent interrupts: a step, the clock's


@pytest.fixture(scope="module")
def recorded() -> list[Recorded]:
    """Record one run."""
    if not shutil.which("qemu-system-arm") or not PROGRAM.exists():
        pytest.skip("no Cortex-M3 board here: scripts/setup_system.sh cross emulators")
    return play(qemu_rig.CortexM3, PROGRAM, TOUCHES)


def late_us(recorded: list[Recorded], path: InputPath) -> np.ndarray:
    """Give latch minus edge, in µs."""
    return np.array([t.latch_us - t.edge_us for t in recorded if t.path == path])


def test_every_edge_is_latched_on_both_paths(recorded: list[Recorded]) -> None:
    for path in InputPath:
        late = late_us(recorded, path)
        assert len(late) == TOUCHES
        assert np.isfinite(late).all()


def test_the_skip_input_latches_at_once(recorded: list[Recorded]) -> None:
    late = late_us(recorded, InputPath.SKIP)

    assert late.min() > 0.0
    assert late.max() < SKIP_LATE_US


def test_the_plc_task_latches_at_the_next_scan(recorded: list[Recorded]) -> None:
    late = late_us(recorded, InputPath.PLC)

    assert late.min() > 0.0
    assert late.max() < EMULATED_SCAN_US + SCAN_LATE_US
    assert np.ptp(late) > EMULATED_SCAN_US / 2.0  # false alarm: 90 · 2⁻⁸⁹


def test_the_scans_lie_on_one_lattice(recorded: list[Recorded]) -> None:
    latch = np.array([t.latch_us for t in recorded if t.path == InputPath.PLC])
    off = (latch - latch[0]) / EMULATED_SCAN_US

    assert np.abs(off - np.round(off)).max() * EMULATED_SCAN_US < SCAN_WAVERS_US


def test_positions_are_those_of_their_stamps_to_half_a_count(recorded: list[Recorded]) -> None:
    late = np.array([t.latch_us - t.edge_us for t in recorded])
    deviation_um = np.array([t.deviation_um for t in recorded])
    speed_um_us = np.array([t.feed_mm_min for t in recorded]) * UM_US_PER_MM_MIN

    off_um = np.abs(deviation_um - speed_um_us * late)

    assert np.all(off_um <= qemu_rig.RESOLUTION_UM / 2.0 + speed_um_us * STEP_LATE_US)


def test_a_deviation_counts_from_the_very_place_of_the_edge() -> None:
    step_ticks = qemu_rig.STEP_TICKS / 1000.0 - 1.0  # at 1000 mm/min, in QEMU
    started, edge, stamp = (round(steps * step_ticks) for steps in (3.0, 10.25, 12.75))
    latch = Latch(ticks=0, position_counts=9, sequence=0, flags=0)

    deviation_um = qemu_rig.deviation_um(latch, stamp, edge, started, 1000.0)

    assert deviation_um == pytest.approx((9.5 - 7.25) * qemu_rig.RESOLUTION_UM, abs=0.001)


UNWINDABLE = """\
int main(void);
void reset(void);

int  main(void) { return 0; }
void reset(void) { (void)main(); }
"""


def test_a_library_with_tables_for_unwinding_brings_no_unwinder(tmp_path: Path) -> None:
    if not shutil.which("arm-none-eabi-gcc"):
        pytest.skip("no arm-none-eabi-gcc here: scripts/setup_system.sh cross")
    source, program = tmp_path / "unwindable.c", tmp_path / "unwindable.elf"
    source.write_text(UNWINDABLE)
    options = "-mcpu=cortex-m3 -mthumb -funwind-tables -Wl,--gc-sections --specs=nano.specs"
    script = ["-nostartfiles", "-T", "hal/ports/cortex_m3/lm3s6965.ld"]
    command = ["arm-none-eabi-gcc", *options.split(), *script, str(source), "-o", str(program)]

    subprocess.run(command, check=True)
    listing = ["arm-none-eabi-nm", str(program)]
    symbols = subprocess.run(listing, check=True, capture_output=True, text=True).stdout
    assert " reset\n" in symbols
    assert "_Unwind" not in symbols
