"""The RP2040 port in rp2040js: a short run of what `make boards` measures at length."""

from hal.ports.rp2040.tests.rig import RESOLUTION_UM, Rp2040
from tests.boards.qemu_checks import Checks, astray_um, speeds_um_us
from tests.boards.record import Recorded

TICK_US = 1.0
SKIP_LATE_US = 3.0


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
