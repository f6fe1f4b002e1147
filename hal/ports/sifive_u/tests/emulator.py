"""QEMU's sifive_u as a test bench.

Both of the chip's PWMs, which the firmware leaves alone, are the bench's instruments: PWM1 is the
master clock, and the first compare interrupt of PWM0, rewired to the trigger pin, is the stimulus,
which so comes at an exact instant of virtual time. Started at reset, PWM1 counts virtual time
itself, as the core's count of cycles does: there the two clocks are one.
"""

from tests.boards.qemu import QemuBoard

TICKS_PER_US = 500  # of a PWM
CLINT_MTIME = 0x0200BFF8  # µs
PWM0 = 0x10020000
PWM1 = 0x10021000
PWM_CFG = 0x00
PWM_COUNT = 0x08
PWM_CMP = 0x20
PWM_RUN = 1 << 12
PWM_RUN_ONCE = 1 << 13 | 1 << 9  # until the first compare, which sets the count to 0
COUNTS = 1 << 31
COMPARES = 4
COMPARE_MAX = 0xFFFF
COMPARE_BITS = 15  # of those set here, so that none is rounded up beyond that
SCALE_MAX = 15
TRIGGER_PIN = 4


class Emulator(QemuBoard):
    """One run of a program. Times are ticks of 2 ns of virtual time since reset."""

    QEMU = "qemu-system-riscv32"
    MACHINE = "sifive_u"
    MORE = ("-bios", "none", "-smp", "2")  # it has no fewer; the second waits
    NM = "riscv64-unknown-elf-nm"

    def _wire(self) -> None:
        """Wire the stimulus to the pin."""
        gpio = self.device("sifive_soc.gpio")
        pwm0 = self.device("riscv.sifive.u.soc") + "/pwm0"
        pin = f"{gpio}/unnamed-gpio-in[{TRIGGER_PIN}]"
        self.monitor("qom-set", path=pwm0, property="sysbus-irq[0]", value=pin)

    def start_clock(self) -> None:
        """Start the master clock, and let no line be driven. At reset, before anything has run.

        Compares that are reached would ask for an interrupt every ns and keep QEMU busy.
        """
        for number in range(COMPARES):
            self.write(PWM1 + PWM_CMP + 4 * number, COMPARE_MAX)
            self.write(PWM0 + PWM_CMP + 4 * number, COMPARE_MAX)
        self.write(PWM1 + PWM_CFG, PWM_RUN | SCALE_MAX)

    def now(self) -> int:
        """Read the master clock; while running, to somewhat."""
        about = self._mtime_us() * TICKS_PER_US
        count = self.read(PWM1 + PWM_COUNT)
        return about + (count - about + COUNTS // 2) % COUNTS - COUNTS // 2

    def _mtime_us(self) -> int:
        high = self.read(CLINT_MTIME + 4)
        return high << 32 | self.read(CLINT_MTIME)

    # ---- the pin ----

    def release(self) -> None:
        """Let the line go low, now."""
        self.write(PWM0 + PWM_CFG, 0)

    def deflect_in(self, ticks: int) -> int:
        """Let the line go high in so many ticks; give the master clock of that. Stopped."""
        scale = max(ticks.bit_length() - COMPARE_BITS, 0)
        compare = -(-ticks >> scale)
        ahead = (compare << scale) - ticks  # compares are coarse, counts are not
        self.write(PWM0 + PWM_COUNT, ahead)
        self.write(PWM0 + PWM_CMP, compare)
        self.write(PWM0 + PWM_CFG, PWM_RUN_ONCE | scale)
        return self.now() + ticks + 1  # the request comes a tick after the count
