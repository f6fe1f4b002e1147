"""The RP2040 board in rp2040js as a bench: injects edges, records a campaign.

    python -m hal.ports.rp2040.tests.rig PROGRAM.elf --out build/campaign

How the times are known: the emulator counts the cycles of the core, 8 ns each, and an edge comes at
an instant of that count, whatever instruction is on.

What the emulator leaves out: entering an interrupt takes nothing (15 cycles, 0.12 µs, on the chip),
nor does the pin's synchroniser (two cycles); SysTick with reload value n has a period of n cycles,
not n + 1, so that scans come 8 ns early here. The second core is this rig's: `second_core.js`.
"""

import sys

from hal.ports.rp2040.tests.emulator import Emulator
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
from tests.boards.qemu_rig import FEEDS_MM_MIN, SCAN_US, Rig, record

CYCLE_US = 0.008
TICKS_PER_US = 1000  # of the master clock: ns
DEVICE_TICK = 1000
START_UP_NS = 1_000_000

RESOLUTION_UM = 5.0
STEP_NS_AT_1_MM_MIN = 300_000_000
STRAY_COUNTS = 2.0  # rounding, and a step whose interrupt waits

# The data sheets: interrupt entry of 15 cycles at 125 MHz, and as many again where another
# interrupt is just being entered; ticks of the timer; ten bits a byte and 16 bytes at 115,200 baud.
# Of the emulator, not of the board: a period that is a cycle short. The edge is known to a ns.
BELIEVED = Nominal(
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=15 * CYCLE_US, jitter_us=15 * CYCLE_US, tick_us=1.0),
    plc=PlcNominal(scan_us=SCAN_US - CYCLE_US),
    axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
    report=ReportNominal(latency_us=1389.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.001),
)


class Rp2040(Rig):
    """The RP2040; the master clock is virtual time since reset."""

    EMULATOR = Emulator
    _emulator: Emulator
    BELIEVED = BELIEVED
    TICKS_PER_US = TICKS_PER_US
    DEVICE_TICK = DEVICE_TICK
    _started = 0

    def _start(self) -> None:
        self._emulator.run(START_UP_NS)

    def _device_clock(self) -> int:
        """Read it finer than its ticks: ns since reset, and its offset."""
        offset_ticks = self._emulator.read(self._symbols["clock_offset_ticks"])
        return self._emulator.now() + offset_ticks * self._tick

    def run_for(self, us: float) -> None:
        self._emulator.run(int(us * TICKS_PER_US))

    def start_block(self, path: bytes, feed: bytes) -> None:
        """Note when the axis starts as well, as a whole number of steps before the last one."""
        super().start_block(path, feed)
        ticks = self._emulator.read(self._symbols["axis_started_ticks"])
        about = self._master(ticks, self._emulator.now())
        step_ns = STEP_NS_AT_1_MM_MIN // round(FEEDS_MM_MIN[feed])
        last = self._emulator.last_step()
        self._started = last - round((last - about) / step_ns) * step_ns

    def _inject(self, wait_us: float) -> int:
        return self._emulator.deflect_in(int(wait_us * TICKS_PER_US))

    def deviation_um(self, latch: Latch, stamp: int, edge: int, feed_mm_min: float) -> float:
        """From the steps, and where the axis is between two of them.

        A step counts once it is whole, so that a count is nearest to the middle of the next one.
        """
        step_ns = STEP_NS_AT_1_MM_MIN / feed_mm_min
        counts = latch.position_counts + 0.5
        stray = counts - (stamp - self._started) / step_ns
        if abs(stray) > STRAY_COUNTS:
            raise RuntimeError(f"the axis is {stray:.1f} counts from where its steps have it")
        return (counts - (edge - self._started) / step_ns) * RESOLUTION_UM


if __name__ == "__main__":
    sys.exit(record(Rp2040, __doc__.splitlines()[0]))
