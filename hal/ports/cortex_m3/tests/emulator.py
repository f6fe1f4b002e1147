"""QEMU's lm3s6965evb as a test bench.

Two devices of the chip that the firmware leaves alone are the bench's instruments, in the same
virtual time: the watchdog is the master clock, and the interrupt output of timer 3, which the bench
rewires to the pin C4, is the stimulus. An edge therefore comes at an exact instant of virtual time,
whatever the host is doing; `set_irq_in` on the pin would come when the host gets round to it.
"""

from tests.boards.qemu import QemuBoard

TICK_NS = 20  # of core, timers and watchdog
COUNTS = 1 << 32

PORT_C = ("pl061_luminary", 2)  # the third of that type
TRIGGER_PIN = "unnamed-gpio-in[4]"
STIMULUS = ("stellaris-gptm", 3)  # timer 3

WATCHDOG_LOAD = 0x40000000
WATCHDOG_VALUE = 0x40000004
WATCHDOG_CTL = 0x40000008
TIMER3 = 0x40033000
TIMER_TAMR = 0x04
TIMER_CTL = 0x0C
TIMER_IMR = 0x18
TIMER_ICR = 0x24
TIMER_TAILR = 0x28
ONE_SHOT = 1


class Emulator(QemuBoard):
    """One run of a program. Times are ticks of 20 ns of virtual time."""

    MACHINE = "lm3s6965evb"
    _last_clock = 0
    _elapsed = 0

    def _wire(self) -> None:
        """Rewire timer 3's interrupt to the pin."""
        pin = f"{self.device(*PORT_C)}/{TRIGGER_PIN}"
        stimulus = self.device(*STIMULUS)
        self.monitor("qom-set", path=stimulus, property="sysbus-irq[0]", value=pin)

    def start_clock(self) -> None:
        """Start the master clock from 0. Stopped, after the program has set the core's clock."""
        self.write(WATCHDOG_LOAD, COUNTS - 1)
        self.write(WATCHDOG_CTL, 1)
        self._last_clock = self.read(WATCHDOG_VALUE)
        self._elapsed = 0

    def now(self) -> int:
        """Read the master clock; at least every 42 s. While running, it may lag somewhat."""
        value = self.read(WATCHDOG_VALUE)
        passed = (self._last_clock - value + COUNTS // 2) % COUNTS - COUNTS // 2
        self._elapsed += passed
        self._last_clock = value
        return self._elapsed

    # ---- the pin ----

    def start_stimulus(self) -> None:
        """Set the stimulus up, the line low. Stopped or running."""
        self.write(TIMER3 + TIMER_TAMR, ONE_SHOT)
        self.write(TIMER3 + TIMER_IMR, 1)
        self.release()

    def release(self) -> None:
        """Let the line go low, now."""
        self.write(TIMER3 + TIMER_ICR, 1)

    def deflect_in(self, ticks: int) -> int:
        """Let the line go high in so many ticks; give the master clock of that. Stopped."""
        self.write(TIMER3 + TIMER_CTL, 0)
        self.write(TIMER3 + TIMER_TAILR, ticks)
        self.write(TIMER3 + TIMER_CTL, 1)
        return self.now() + ticks
