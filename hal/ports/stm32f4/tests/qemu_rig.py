"""The STM32F4 board in QEMU as a bench: injects edges, records a campaign.

    python -m hal.ports.stm32f4.tests.qemu_rig PROGRAM.elf --out build/campaign

How the times are known: the emulator is stopped somewhere, the line is raised while it stands, and
the master clock that tells the instant has ticks of 25 ns. The seed draws how long the program runs
before; where in its instructions it then stops, the host decides, and more often where the program
reads registers of the emulated timers, on which the host spends longest.

What the emulator leaves out: each instruction takes 32 ns, 5.4 cycles at 168 MHz; entering an
interrupt takes nothing (12 cycles, 0.07 µs, on the chip); GPIO, so that the level of the pin is
that of what is wired to it.
"""

import sys

from hal.ports.stm32f4.tests.emulator import TICK_NS, Emulator
from skiplatch.bench.latches import Latch
from skiplatch.campaign import (
    AxisNominal,
    BenchNominal,
    InputNominal,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
)
from tests.boards.qemu_rig import SCAN_US, Rig, record

TIM2_CNT = 0x40000024
TIM5_CNT = 0x40000C24
SYST_CSR = 0xE000E010
ENABLED = 1

TICKS_PER_US = 40
RESOLUTION_UM = 0.1
STRAY_UM = 1.0  # 20 µs at the highest feed: a latch reads time and count one after the other
UM_PER_TICK_AT_1_MM_MIN = TICK_NS / 60e6
COUNT_TICKS_AT_1_MM_MIN = round(RESOLUTION_UM / UM_PER_TICK_AT_1_MM_MIN)

SYSTICK_SHORT_US = 0.001  # a scan, in the emulator: its period is rounded down to a ns

# The data sheets: interrupt entry of 12 cycles at 160 MHz, and as many again where another
# interrupt is just being entered; ticks of TIM2; ten bits a byte and 16 bytes at 115,200 baud. Of
# the emulator, not of the board: the period of the scans. The edge is known to a tick: 25 ns/√12.
BELIEVED = Nominal(
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=0.075, jitter_us=0.075, tick_us=TICK_NS / 1e3),
    plc=PlcNominal(scan_us=SCAN_US - SYSTICK_SHORT_US),
    axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
    report=ReportNominal(latency_us=1389.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.007),
)


class Stm32F4(Rig):
    """The STM32F405; the master clock has the ticks of the device clock."""

    EMULATOR = Emulator
    _emulator: Emulator
    BELIEVED = BELIEVED
    TICKS_PER_US = TICKS_PER_US
    DEVICE_TICK = 1
    _edge_counts = 0

    def _start(self) -> None:
        self._emulator.run_until(SYST_CSR, ENABLED)
        self._emulator.start_clock()
        self._emulator.release()

    def _device_clock(self) -> int:
        """Read it finer than its ticks, which are multiples of virtual time since reset."""
        return self._emulator.read(TIM2_CNT) * self._tick + self._emulator.now() % self._tick

    def _inject(self, wait_us: float) -> int:
        self._emulator.release()
        self.run_for(wait_us)
        self._edge_counts = self._emulator.read(TIM5_CNT)
        return self._emulator.deflect()

    def deviation_um(self, latch: Latch, stamp: int, edge: int, feed_mm_min: float) -> float:
        """From where the axis is at the edge; a count is nearest to the middle of its step.

        The count is read at the edge. It steps at multiples of virtual time since reset, which the
        master clock is, so that how far the next one has come is known to a tick.
        """
        count_ticks = COUNT_TICKS_AT_1_MM_MIN // round(feed_mm_min)
        counts = latch.position_counts + 0.5 - self._edge_counts - edge % count_ticks / count_ticks
        way_um = counts * RESOLUTION_UM
        due_um = max(stamp - edge, 0) * feed_mm_min * UM_PER_TICK_AT_1_MM_MIN
        if abs(way_um - due_um) > STRAY_UM:
            raise RuntimeError(f"the axis went {way_um:.1f} µm from the edge, not {due_um:.1f}")
        return way_um


if __name__ == "__main__":
    sys.exit(record(Stm32F4, __doc__.splitlines()[0]))
