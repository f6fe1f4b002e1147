"""The FU540 port in QEMU: a short run of what `make boards` measures at length."""

import numpy as np

from hal.ports.sifive_u.tests.qemu_rig import INSTRUCTION_US, RESOLUTION_UM, SifiveU
from tests.boards.qemu_checks import Checks, astray_um
from tests.boards.record import Recorded
from tests.boards.train_checks import TrainChecks


class TestSifiveU(Checks):
    """The line waits for the firmware's own critical sections, and for a byte that leaves."""

    RIG = SifiveU
    TOUCHES = 30
    SKIP_LATE_US = 4.0
    SCAN_LATE_US = 8.0
    SCAN_WAVERS_US = 8.0

    def test_positions_are_the_counts_at_their_stamps(self, recorded: list[Recorded]) -> None:
        assert astray_um(recorded).max() <= 2.0 * RESOLUTION_UM

    def test_edges_come_anywhere_within_an_instruction(self, recorded: list[Recorded]) -> None:
        within_ns = {round(1000.0 * np.fmod(t.edge_us, INSTRUCTION_US)) for t in recorded}

        assert len(within_ns) > 8  # of 16; false alarm: less than 10^-13


class TestTrain(TrainChecks):
    """The program whose edges come at each interrupt of CLINT's timer."""

    RIG = SifiveU
    ARMED_BY = 0x10060018  # GPIO_RISE_IE
