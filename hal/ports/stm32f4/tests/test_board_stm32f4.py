"""The STM32F4 port in QEMU: a short run of what `make boards` measures at length."""

from hal.ports.stm32f4.tests.qemu_rig import RESOLUTION_UM, Stm32F4
from tests.boards.qemu_checks import Checks, astray_um, speeds_um_us
from tests.boards.record import Recorded
from tests.boards.train_checks import TrainChecks

COUNT_LATE_US = 2.0  # a scan reads time, line and count one after the other


class TestStm32F4(Checks):
    """The line waits for the firmware's own critical sections at most."""

    RIG = Stm32F4
    TOUCHES = 30
    SKIP_LATE_US = 1.2
    SCAN_LATE_US = 2.5  # a byte leaves meanwhile
    SCAN_WAVERS_US = 2.5

    def test_positions_are_those_of_their_stamps_to_half_a_count(
        self, recorded: list[Recorded]
    ) -> None:
        count_late_um = speeds_um_us(recorded) * COUNT_LATE_US

        assert (astray_um(recorded) <= RESOLUTION_UM / 2.0 + count_late_um).all()


class TestTrain(TrainChecks):
    """The program whose edges come at each interrupt of SysTick."""

    RIG = Stm32F4
    ARMED_BY = 0x40013C00  # EXTI_IMR
