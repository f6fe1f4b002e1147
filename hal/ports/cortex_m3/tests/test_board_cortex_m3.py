"""The Cortex-M3 port in QEMU: a short run of what `make boards` measures at length."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from hal.ports.cortex_m3.tests import qemu_rig
from skiplatch.bench.latches import Latch
from tests.boards.qemu_checks import Checks, astray_um, speeds_um_us
from tests.boards.record import Recorded
from tests.boards.train_checks import TrainChecks

SKIP_LATE_US = 1.2
STEP_LATE_US = 2.0 * SKIP_LATE_US  # a step counts late: masked, then a more urgent interrupt


class TestCortexM3(Checks):
    """The line waits for the firmware's own critical sections at most."""

    RIG = qemu_rig.CortexM3
    TOUCHES = 90  # half a second of virtual time, so that SysTick wraps
    SKIP_LATE_US = SKIP_LATE_US
    SCAN_LATE_US = 5.0
    SCAN_WAVERS_US = 3.0 * SKIP_LATE_US  # masked, and two more urgent ones: a step, the clock's

    def test_positions_are_those_of_their_stamps_to_half_a_count(
        self, recorded: list[Recorded]
    ) -> None:
        step_late_um = speeds_um_us(recorded) * STEP_LATE_US

        assert np.all(astray_um(recorded) <= qemu_rig.RESOLUTION_UM / 2.0 + step_late_um)


class TestTrain(TrainChecks):
    """The program whose edges come at each interrupt of timer 1."""

    RIG = qemu_rig.CortexM3
    ARMED_BY = 0x40006410  # of port C


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
        pytest.skip("no arm-none-eabi-gcc here: scripts/setup/system.sh cross")
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
