"""What holds of boards in QEMU and the like: a short run of what `make boards` does at length."""

from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath
from tests.boards.qemu_rig import Rig, play
from tests.boards.record import Recorded

UM_US_PER_MM_MIN = 1.0 / 60_000.0  # µm/µs in a mm/min


def late_us(recorded: list[Recorded], path: InputPath) -> FloatArray:
    """Give latch minus edge, in µs; NaN where none was latched."""
    return np.array([t.latch_us - t.edge_us for t in recorded if t.path == path])


def speeds_um_us(recorded: list[Recorded]) -> FloatArray:
    """Give the speed of the axis at each touch."""
    return np.array([t.feed_mm_min for t in recorded]) * UM_US_PER_MM_MIN


def astray_um(recorded: list[Recorded]) -> FloatArray:
    """Give by how much each latched place is off the place at its own stamp."""
    late = np.array([t.latch_us - t.edge_us for t in recorded])
    deviation_um = np.array([t.deviation_um for t in recorded])
    return np.asarray(np.abs(deviation_um - speeds_um_us(recorded) * late))


class Checks:
    """Both paths, at the feeds of the rig.

    Attributes:
        RIG: Of the board.
        TOUCHES: On each path.
        SKIP_LATE_US: The longest stretch in which the port masks interrupts, and the handler.
        SCAN_LATE_US: From the timer by way of the line to the clock, behind other interrupts.
        SCAN_WAVERS_US: By so much scans are off their period.
        STAMP_EARLY_US: A tick, where it is longer than what the handler takes to read the clock.
    """

    RIG: ClassVar[type[Rig]]
    TOUCHES: ClassVar[int]
    SKIP_LATE_US: ClassVar[float]
    SCAN_LATE_US: ClassVar[float]
    SCAN_WAVERS_US: ClassVar[float]
    STAMP_EARLY_US: ClassVar[float] = 0.0

    @pytest.fixture(scope="class")
    @classmethod
    def recorded(cls) -> list[Recorded]:
        """Record one run."""
        board = cls.RIG.__module__.split(".")[2]
        program = Path("build/boards", board, "firmware.elf")
        if not cls.RIG.EMULATOR.is_here() or not program.exists():
            pytest.skip(f"no {board} here: make setup-test says what is missing")
        return play(cls.RIG, program, cls.TOUCHES)

    def test_every_edge_is_latched_on_both_paths(self, recorded: list[Recorded]) -> None:
        for path in InputPath:
            late = late_us(recorded, path)
            assert len(late) == self.TOUCHES
            assert np.isfinite(late).all()

    def test_the_skip_input_latches_at_once(self, recorded: list[Recorded]) -> None:
        late = late_us(recorded, InputPath.SKIP)

        assert late.min() > -self.STAMP_EARLY_US
        assert late.max() < self.SKIP_LATE_US

    def test_the_plc_task_latches_at_the_next_scan(self, recorded: list[Recorded]) -> None:
        late = late_us(recorded, InputPath.PLC)
        scan_us = self.RIG.BELIEVED.plc.scan_us

        assert late.min() > -self.STAMP_EARLY_US
        assert late.max() < scan_us + self.SCAN_LATE_US
        assert np.ptp(late) > scan_us / 2.0  # false alarm: n · 2^(1 − n)

    def test_the_scans_lie_on_one_lattice(self, recorded: list[Recorded]) -> None:
        latch = np.array([t.latch_us for t in recorded if t.path == InputPath.PLC])
        scan_us = self.RIG.BELIEVED.plc.scan_us
        off = (latch - latch[0]) / scan_us

        assert np.abs(off - np.round(off)).max() * scan_us < self.SCAN_WAVERS_US
