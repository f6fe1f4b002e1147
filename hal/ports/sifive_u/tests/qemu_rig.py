"""The FU540 board in QEMU as a bench: injects edges, records a campaign.

    python -m hal.ports.sifive_u.tests.qemu_rig PROGRAM.elf --out build/campaign

How the times are known: an edge is programmed on a PWM while the emulator stands, so that its
instant of virtual time is exact, to 2 ns. The chip sees it at the next instruction, at most 32 ns
later.

What the emulator leaves out: each instruction takes 32 ns, 32 cycles at 1 GHz; entering an
interrupt takes nothing.
"""

import sys

from hal.ports.sifive_u.tests.emulator import TICKS_PER_US, Emulator
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

INSTRUCTION_US = 0.032
RESOLUTION_UM = 0.1
DEVICE_TICK = 4  # of 8 ns
CYCLES_PER_TICK = 2  # of the master clock
UM_PER_TICK_AT_1_MM_MIN = 1000.0 / (60e6 * TICKS_PER_US)
STRAY_UM = 1.0  # 20 µs at the highest feed: a latch reads time and count one after the other

# No manual gives a time for entering an interrupt by way of the PLIC: it is believed to take none.
# From there to the clock are 33 instructions, and an edge comes within one. Ticks of 8 cycles; ten
# bits a byte and 16 bytes at 115,200 baud; the edge is known to 2 ns.
BELIEVED = Nominal(
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=33 * INSTRUCTION_US, jitter_us=INSTRUCTION_US, tick_us=0.008),
    plc=PlcNominal(scan_us=float(SCAN_US)),
    axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
    report=ReportNominal(latency_us=1389.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.001),
)


class SifiveU(Rig):
    """The FU540; the master clock is virtual time since reset."""

    EMULATOR = Emulator
    _emulator: Emulator
    BELIEVED = BELIEVED
    TICKS_PER_US = TICKS_PER_US
    DEVICE_TICK = DEVICE_TICK
    _started = 0.0

    def _start(self) -> None:
        self._emulator.start_clock()
        self._emulator.release()
        self._emulator.run_until(self._symbols["scan_period_us"], SCAN_US)

    def _device_clock(self) -> int:
        """Read it finer than its ticks: cycles since reset, and its offset."""
        offset_ticks = self._emulator.read(self._symbols["clock_offset_ticks"])
        return self._emulator.now() + offset_ticks * self._tick

    def start_block(self, path: bytes, feed: bytes) -> None:
        """Note when the axis starts as well."""
        super().start_block(path, feed)
        started = self._symbols["axis_started_cycles"]
        cycles = self._emulator.read(started + 4) << 32 | self._emulator.read(started)
        self._started = cycles / CYCLES_PER_TICK

    def _inject(self, wait_us: float) -> int:
        self._emulator.release()
        return self._emulator.deflect_in(int(wait_us * TICKS_PER_US))

    def deviation_um(self, latch: Latch, stamp: int, edge: int, feed_mm_min: float) -> float:
        """From where the axis is at the edge; a count is nearest to the middle of its step."""
        um_per_tick = feed_mm_min * UM_PER_TICK_AT_1_MM_MIN
        way_um = (latch.position_counts + 0.5) * RESOLUTION_UM - (
            edge - self._started
        ) * um_per_tick
        due_um = max(stamp - edge, 0) * um_per_tick
        if abs(way_um - due_um) > STRAY_UM:
            raise RuntimeError(f"the axis went {way_um:.1f} µm from the edge, not {due_um:.1f}")
        return way_um


if __name__ == "__main__":
    sys.exit(record(SifiveU, __doc__.splitlines()[0]))
