"""The Cortex-M3 board in QEMU as a bench: injects edges, records a campaign.

    python -m tests.boards.qemu_rig build/boards/cortex_m3/firmware.elf --out build/campaign

How the times are known: an edge is programmed on the bench's timer while the emulator stands, so
that its instant of virtual time is exact; the master clock that tells it has ticks of 20 ns. The
chip sees it at the next instruction, at most 32 ns later. The latch is the firmware's own stamp.
Edge and latch come from one virtual time: no drift between the two clocks can show here. The
emulated UART takes no time for a byte, so reports are not timed: `report_us` is empty.

What the emulator leaves out: each instruction takes 32 ns, whatever it is; entering an interrupt
takes nothing (12 cycles, 0.24 µs, on the chip); a general-purpose timer with reload value n has a
period of n ticks, not n + 1. The last is why scans and steps come 1 tick early here.
"""

import argparse
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from tqdm import tqdm

from skiplatch.bench.latches import Latch, LatchReports
from skiplatch.campaign import (
    Axis,
    AxisNominal,
    BenchNominal,
    InputNominal,
    InputPath,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
    Status,
    Touches,
    write_campaign,
)
from skiplatch.motion import US_PER_S, expected_contact
from tests.boards.qemu import COUNTS, TICK_NS, Emulator

TICKS_PER_US = 50
US_PER_TICK = TICK_NS / 1e3
FRAME_BYTES = 8
SYST_CVR = 0xE000E018
SCB_ICSR = 0xE000ED04
PENDING = 1 << 26
COUNTER_BITS = 24
TIMER1_CTL = 0x4003100C

RESOLUTION_UM = 1.0
APPROACH_MM = 5.0
STEP_TICKS = 3_000_000  # over mm/min
FEEDS_MM_MIN = {b"1": 100.0, b"2": 1000.0, b"3": 3000.0}
PATHS = {b"s": InputPath.SKIP, b"p": InputPath.PLC}
SCAN_US = 1000
LEAD_S = 5.0  # the master clock of the campaign runs that long before the first edge
ROUNDS = 10  # of all paths and feeds, so that none goes with the time
REST_US = 3 * SCAN_US  # the line is low at least so long: several scans see it
PATIENCE_US = 20 * SCAN_US
SETTLE_US = 2 * SCAN_US
SCAN_EARLY_TICKS = 100

# The data sheets: interrupt entry of 12 cycles at 50 MHz, and as many again where another interrupt
# is just being entered; ticks of the core, the period as set; ten bits a byte and 16 bytes at
# 115,200 baud. Edges are known to a tick: 20 ns/√12.
BELIEVED = Nominal(
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=0.24, jitter_us=0.24, tick_us=US_PER_TICK),
    plc=PlcNominal(scan_us=float(SCAN_US)),
    axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
    report=ReportNominal(latency_us=1389.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.006),
)


@dataclass(frozen=True, slots=True)
class Touch:
    """One injected edge and what came of it; times are ticks of the master clock."""

    path: InputPath
    feed_mm_min: float
    edge: int
    latch: int | None
    deviation_um: float


class Board:
    """The program in its emulator: its clock, its commands, its records."""

    def __init__(self, emulator: Emulator, symbols: dict[str, int], tick_shift: int) -> None:
        """Let it start up; it stands afterwards."""
        self._emulator = emulator
        self._symbols = symbols
        self._tick_shift = tick_shift
        self._reports = LatchReports()
        self._bytes = b""
        emulator.run_until(TIMER1_CTL, 1)
        emulator.start_clock()
        emulator.start_stimulus()
        self._ahead = self._device_clock() - emulator.now()

    def _device_clock(self) -> int:
        """Read SysTick and its wraps, as hal_clock_now_ticks() does. Stopped."""
        wraps = self._emulator.read(self._symbols["clock_wraps"])
        wraps += bool(self._emulator.read(SCB_ICSR) & PENDING)
        return wraps << COUNTER_BITS | -self._emulator.read(SYST_CVR) % (1 << COUNTER_BITS)

    def _master(self, device_ticks: int, about: int) -> int:
        """Give the master clock for a stamp of the device clock that was taken about then."""
        span = COUNTS << self._tick_shift
        stamp = (device_ticks << self._tick_shift) - self._ahead
        return about + (stamp - about + span // 2) % span - span // 2

    def _pass(self, us: float) -> None:
        """Let the program run for at least so long, and stop."""
        end = self._emulator.now() + us * TICKS_PER_US
        self._emulator.go()
        while self._emulator.now() < end:
            time.sleep(0.0002)
        self._emulator.stop()

    def start_block(self, path: bytes, feed: bytes) -> int:
        """Set the board to a path and a feed; give when the axis started. Stopped."""
        for command in (b"n", feed, path):
            self._emulator.serial.sendall(command)
            self._pass(SETTLE_US)
        started = self._emulator.read(self._symbols["axis_started_ticks"])
        return self._master(started, self._emulator.now())

    def touch(self, wait_ticks: int) -> tuple[int, Latch | None]:
        """Inject an edge so much later; give when it came and what was latched. Stopped."""
        self._emulator.release()
        edge = self._emulator.deflect_in(wait_ticks)
        self._emulator.go()
        latch = self._await_latch(edge + PATIENCE_US * TICKS_PER_US)
        self._emulator.stop()
        if latch is not None and self._reports.lost + self._reports.damaged:
            raise RuntimeError("records were lost on an emulated wire")
        return edge, latch

    def _await_latch(self, end: int) -> Latch | None:
        self._emulator.serial.settimeout(0.02)
        while True:
            try:
                self._bytes += self._emulator.serial.recv(2 * FRAME_BYTES)
            except TimeoutError:
                if self._emulator.now() > end:
                    return None
            while len(self._bytes) >= FRAME_BYTES:
                frame, self._bytes = self._bytes[:FRAME_BYTES], self._bytes[FRAME_BYTES:]
                latch = self._reports.take(frame)
                if latch is not None:
                    return latch

    def stamp(self, latch: Latch, edge: int) -> int:
        """Give the master clock of a latch.

        A coarse stamp may lie before the edge, and so may that of a scan, which takes the time
        first and reads the line about 1 µs later.
        """
        stamp = self._master(latch.ticks, edge)
        early = SCAN_EARLY_TICKS if latch.path == "plc" else 0
        if stamp < edge - early - (1 << self._tick_shift):
            raise RuntimeError(f"latched {edge - stamp} ticks before the edge")
        return stamp


def deviation_um(latch: Latch, edge: int, started: int, feed_mm_min: float) -> float:
    """Take the way of the axis from the edge to the latched count, to the resolution.

    A count stands for the middle of its step. The period of the steps is a tick short: see above.
    """
    step_ticks = STEP_TICKS / feed_mm_min - 1.0
    way = latch.position_counts + 0.5 - (edge - started) / step_ticks
    return float(np.round(way)) * RESOLUTION_UM


def blocks(touches: int) -> Iterator[tuple[bytes, bytes, int]]:
    """Give path, feed and number of touches of every block; `touches` are those of one path."""
    shares = np.diff(np.linspace(0, touches, ROUNDS * len(FEEDS_MM_MIN) + 1).astype(int))
    for number, share in enumerate(shares):
        for path in PATHS:
            yield path, list(FEEDS_MM_MIN)[number % len(FEEDS_MM_MIN)], int(share)


def play(program: Path, touches: int, tick_shift: int, seed: int) -> list[Touch]:
    """Inject so many edges on each path, at random instants of the scan."""
    random = np.random.default_rng(seed)
    played = []
    with (
        Emulator(program) as emulator,
        tqdm(total=2 * touches, unit="touch", disable=not sys.stderr.isatty()) as bar,
    ):
        board = Board(emulator, symbols_of(program), tick_shift)
        for path, feed, count in blocks(touches):
            started = board.start_block(path, feed)
            for _ in range(count):
                wait = int(random.uniform(REST_US, REST_US + SCAN_US) * TICKS_PER_US)
                edge, latch = board.touch(wait)
                played.append(
                    Touch(
                        path=PATHS[path],
                        feed_mm_min=FEEDS_MM_MIN[feed],
                        edge=edge,
                        latch=None if latch is None else board.stamp(latch, edge),
                        deviation_um=np.nan
                        if latch is None
                        else deviation_um(latch, edge, started, FEEDS_MM_MIN[feed]),
                    )
                )
                bar.update()
    return played


def symbols_of(program: Path) -> dict[str, int]:
    """Give the addresses of the program's variables."""
    command = ("arm-none-eabi-nm", str(program))
    text = subprocess.check_output(command, text=True)
    return {name: int(address, 16) for address, _, name in map(str.split, text.splitlines())}


def as_touches(played: list[Touch]) -> Touches:
    """Give the rows of the campaign: each move starts so that it meets the surface at its edge."""
    count = len(played)
    edge_us = LEAD_S * US_PER_S + np.array([touch.edge for touch in played]) * US_PER_TICK
    latch = np.array([np.nan if t.latch is None else float(t.latch) for t in played])
    touches = Touches.from_columns(
        touch=np.arange(count),
        time_s=edge_us / US_PER_S,
        path=np.array([touch.path for touch in played]),
        axis=np.full(count, Axis.X),
        sign=np.ones(count),
        alpha_deg=np.zeros(count),
        beta_deg=np.zeros(count),
        feed_mm_min=np.array([touch.feed_mm_min for touch in played]),
        approach_mm=np.full(count, APPROACH_MM),
        position_mm=np.zeros(count),
        edge_us=edge_us,
        latch_us=LEAD_S * US_PER_S + latch * US_PER_TICK,
        deviation_um=np.array([touch.deviation_um for touch in played]),
        status=np.array([Status.MISSED if t.latch is None else Status.OK for t in played]),
    )
    travel_us = expected_contact(BELIEVED, touches).time_us - edge_us
    return replace(touches, time_s=(edge_us - travel_us) / US_PER_S)


def main() -> int:
    """Record a campaign of the program on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, help="firmware.elf of the board")
    parser.add_argument("--out", type=Path, required=True, help="folder of the campaign")
    parser.add_argument("--touches", type=int, default=3000, help="on each path")
    parser.add_argument("--tick-shift", type=int, default=0, help="the build's prescaler")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    played = play(options.program, options.touches, options.tick_shift, options.seed)
    write_campaign(options.out, BELIEVED, as_touches(played))
    for path in InputPath:
        late = [(t.latch - t.edge) * US_PER_TICK for t in played if t.path == path and t.latch]
        missed = sum(t.latch is None for t in played if t.path == path)
        print(
            f"{path.name.lower()}: {len(late)} latched, {missed} missed; latch - edge in µs: "
            f"least {min(late):.2f}, mean {np.mean(late):.3f}, most {max(late):.2f}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
