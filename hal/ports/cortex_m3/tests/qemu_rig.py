"""The Cortex-M3 board in QEMU as a bench: injects edges, records a campaign.

    python -m hal.ports.cortex_m3.tests.qemu_rig PROGRAM.elf --out build/campaign

How the times are known: an edge is programmed on the bench's timer while the emulator stands, so
that its instant of virtual time is exact; the master clock that tells it has ticks of 20 ns. The
chip sees it at the next instruction, at most 32 ns later. The latch is the firmware's own stamp.
Edge and latch come from one virtual time: no drift between the two clocks can show here. The
emulated UART takes no time for a byte, so reports are not timed: `report_us` is empty.

What the emulator leaves out: each instruction takes 32 ns, whatever it is; entering an interrupt
takes nothing (12 cycles, 0.24 µs, on the chip); a general-purpose timer with reload value n has a
period of n ticks, not n + 1. The last is why scans and steps come 1 tick early here.
"""

import sys

from hal.ports.cortex_m3.tests.emulator import TICK_NS, Emulator
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

TICKS_PER_US = 50
US_PER_TICK = TICK_NS / 1e3
SYST_CVR = 0xE000E018
SCB_ICSR = 0xE000ED04
PENDING = 1 << 26
COUNTER_BITS = 24
TIMER1_CTL = 0x4003100C

RESOLUTION_UM = 5.0
STEP_TICKS = 15_000_000  # over mm/min
STRAY_COUNTS = 2.0  # rounding, and a step whose interrupt waits

# The data sheets: interrupt entry of 12 cycles at 50 MHz, and as many again where another interrupt
# is just being entered; ticks of the core; ten bits a byte and 16 bytes at 115,200 baud. Of the
# emulator, not of the board: a period that is a tick short. The edge is known to a tick: 20 ns/√12.
BELIEVED = Nominal(
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=0.24, jitter_us=0.24, tick_us=US_PER_TICK),
    plc=PlcNominal(scan_us=SCAN_US - US_PER_TICK),
    axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
    report=ReportNominal(latency_us=1389.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.006),
)


class CortexM3(Rig):
    """The LM3S6965; the master clock has the ticks of its core."""

    EMULATOR = Emulator
    _emulator: Emulator
    BELIEVED = BELIEVED
    TICKS_PER_US = TICKS_PER_US
    DEVICE_TICK = 1
    _started = 0

    def _start(self) -> None:
        self._emulator.run_until(TIMER1_CTL, 1)
        self._emulator.start_clock()
        self._emulator.start_stimulus()

    def _device_clock(self) -> int:
        """Read SysTick and its wraps."""
        wraps = self._emulator.read(self._symbols["clock_wraps"])
        wraps += bool(self._emulator.read(SCB_ICSR) & PENDING)
        return wraps << COUNTER_BITS | -self._emulator.read(SYST_CVR) % (1 << COUNTER_BITS)

    def start_block(self, path: bytes, feed: bytes) -> None:
        """Note when the axis starts as well."""
        super().start_block(path, feed)
        started = self._emulator.read(self._symbols["axis_started_ticks"])
        self._started = self._master(started, self._emulator.now())

    def _inject(self, wait_us: float) -> int:
        self._emulator.release()
        return self._emulator.deflect_in(int(wait_us * TICKS_PER_US))

    def deviation_um(self, latch: Latch, stamp: int, edge: int, feed_mm_min: float) -> float:
        """From the steps, and where the axis is between two of them."""
        return deviation_um(latch, stamp, edge, self._started, feed_mm_min)


def deviation_um(latch: Latch, stamp: int, edge: int, started: int, feed_mm_min: float) -> float:
    """Take the way of the axis from where it is at the edge, exactly, to the latched count.

    A step counts once it is whole, so that a count is nearest to the middle of the next one. The
    period of the steps is a tick short: see above.

    Raises:
        RuntimeError: Steps were lost, or counted twice.
    """
    step_ticks = STEP_TICKS / feed_mm_min - 1.0
    counts = latch.position_counts + 0.5
    stray = counts - (stamp - started) / step_ticks
    if abs(stray) > STRAY_COUNTS:
        raise RuntimeError(f"the axis is {stray:.1f} counts from where its steps have it")
    return (counts - (edge - started) / step_ticks) * RESOLUTION_UM


if __name__ == "__main__":
    sys.exit(record(CortexM3, __doc__.splitlines()[0]))
