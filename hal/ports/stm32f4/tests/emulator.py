"""QEMU's netduinoplus2 as a test bench.

The emulated STM32F405 has neither GPIO nor clocks to set; its timers can be read, but raise no
interrupts that can be relied on. Two devices that the firmware leaves alone are the bench's
instruments: TIM4 is the master clock, and the interrupt output of USART3, wired to PA0's input of
the edge interrupts, is the stimulus. That is a level: high while an empty transmitter may ask for a
byte. It is switched while the emulator stands, so that the instant of the edge is exact.

An emulated timer steps at multiples of its tick of virtual time since reset.
"""

from pathlib import Path

from tests.boards.qemu import QemuBoard

ROOT = Path(__file__).resolve().parents[4]
COUNTS = 1 << 32

STIMULUS = "usart[2]"
PIN = "syscfg/unnamed-gpio-in[0]"

TICK_NS = 25
EMULATED_TICK_NS = 1  # without a prescaler
TIM4 = 0x40000800
TIM_CNT = 0x24
TIM_PSC = 0x28
USART3_CR1 = 0x4000480C
EMPTY_IRQ = 1 << 7


class Emulator(QemuBoard):
    """One run of a program. Times are ticks of 25 ns of virtual time."""

    QEMU = str(ROOT / "build/qemu/qemu-system-arm")
    MACHINE = "netduinoplus2"
    _last_clock = 0
    _elapsed = 0

    def _wire(self) -> None:
        """Wire the stimulus to the pin."""
        soc = self.device("stm32f405-soc")
        self.monitor(
            "qom-set", path=f"{soc}/{STIMULUS}", property="sysbus-irq[0]", value=f"{soc}/{PIN}"
        )

    def start_clock(self) -> None:
        """Start the master clock: virtual time since reset. Stopped, in the first 4 s of it."""
        since_reset_ns = self.read(TIM4 + TIM_CNT) * EMULATED_TICK_NS
        self.write(TIM4 + TIM_PSC, TICK_NS // EMULATED_TICK_NS - 1)
        self.write(TIM4 + TIM_CNT, since_reset_ns // TICK_NS)
        self._last_clock = self._elapsed = self.read(TIM4 + TIM_CNT)

    def now(self) -> int:
        """Read the master clock; at least every 50 s of it."""
        value = self.read(TIM4 + TIM_CNT)
        self._elapsed += (value - self._last_clock + COUNTS // 2) % COUNTS - COUNTS // 2
        self._last_clock = value
        return self._elapsed

    def release(self) -> None:
        """Let the line go low, now. Stopped."""
        self.write(USART3_CR1, 0)

    def deflect(self) -> int:
        """Let the line go high, now; give the master clock of that. Stopped."""
        self.write(USART3_CR1, EMPTY_IRQ)
        return self.now()
