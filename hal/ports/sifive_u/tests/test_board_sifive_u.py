"""The FU540 port in QEMU: a short run of what `make boards` measures at length."""

from hal.ports.sifive_u.tests.qemu_rig import RESOLUTION_UM, SifiveU
from tests.boards.qemu_checks import Checks, astray_um
from tests.boards.record import Recorded


class TestSifiveU(Checks):
    """The line waits for the firmware's own critical sections, and for a byte that leaves."""

    RIG = SifiveU
    TOUCHES = 30
    SKIP_LATE_US = 4.0
    SCAN_LATE_US = 8.0
    SCAN_WAVERS_US = 8.0

    def test_positions_are_the_counts_at_their_stamps(self, recorded: list[Recorded]) -> None:
        assert astray_um(recorded).max() <= 2.0 * RESOLUTION_UM
