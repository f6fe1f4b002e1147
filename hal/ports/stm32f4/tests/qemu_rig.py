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
from skiplatch.motion import S_PER_MIN, US_PER_S
from tests.boards.qemu_rig import SCAN_US, Rig, record
from tests.boards.record import APPROACH_MM

TIM2_CNT = 0x40000024
TIM5_CNT = 0x40000C24
SYST_CSR = 0xE000E010
ENABLED = 1

TICKS_PER_US = 40
RESOLUTION_UM = 0.1
START_OFF_US = 0.08
STRAY_UM = 1.0  # 20 µs at the highest feed: a latch reads time and count one after the other
UM_PER_TICK_AT_1_MM_MIN = TICK_NS / 60e6

# The data sheets: interrupt entry of 12 cycles at 160 MHz, and as many again where another
# interrupt is just being entered; ticks of TIM2; ten bits a byte and 16 bytes at 115,200 baud. An
# edge is known to a tick, but the start of its move is a whole µs only to START_OFF_US/√3.
BELIEVED = Nominal(
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=0.075, jitter_us=0.075, tick_us=TICK_NS / 1e3),
    plc=PlcNominal(scan_us=float(SCAN_US)),
    axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
    report=ReportNominal(latency_us=1389.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.046),
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

    def _inject(self, wait_us: float, feed_mm_min: float) -> int:
        """Stop where a move at this feed that meets its surface now starts at a whole µs.

        A campaign tells starts to the µs, and approaches to the nm: 0.6 µs at 100 mm/min.
        """
        self._emulator.release()
        self._pass(wait_us)
        while abs(self._start_off_us(feed_mm_min)) > START_OFF_US:
            self._pass(0.0)
        self._edge_counts = self._emulator.read(TIM5_CNT)
        return self._emulator.deflect()

    def _start_off_us(self, feed_mm_min: float) -> float:
        """By how much such a move that ends now starts after the nearest whole µs."""
        speed_mm_s = feed_mm_min / S_PER_MIN
        travel_s = APPROACH_MM / speed_mm_s + speed_mm_s / (2.0 * BELIEVED.axis.accel_mm_s2)
        starts_us = (self._emulator.now() + self._zero) / TICKS_PER_US - travel_s * US_PER_S
        return starts_us - round(starts_us)

    def deviation_um(self, latch: Latch, stamp: int, edge: int, feed_mm_min: float) -> float:
        """From the count at the edge, which is read there."""
        way_um = (latch.position_counts - self._edge_counts) * RESOLUTION_UM
        due_um = max(stamp - edge, 0) * feed_mm_min * UM_PER_TICK_AT_1_MM_MIN
        if abs(way_um - due_um) > STRAY_UM:
            raise RuntimeError(f"the axis went {way_um:.1f} µm from the edge, not {due_um:.1f}")
        return way_um


if __name__ == "__main__":
    sys.exit(record(Stm32F4, __doc__.splitlines()[0]))
