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

import argparse
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from tqdm import tqdm

from hal.ports.cortex_m3.tests.emulator import COUNTS, TICK_NS, Emulator
from skiplatch.bench.latches import Latch, LatchReports
from skiplatch.campaign import (
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
    write_campaign,
)
from skiplatch.motion import S_PER_MIN, US_PER_S
from tests.boards.record import APPROACH_MM, LEAD_S, Recorded, as_touches

TICKS_PER_US = 50
US_PER_TICK = TICK_NS / 1e3
FRAME_BYTES = 8
SYST_CVR = 0xE000E018
SCB_ICSR = 0xE000ED04
PENDING = 1 << 26
COUNTER_BITS = 24
TIMER1_CTL = 0x4003100C

RESOLUTION_UM = 5.0
STEP_TICKS = 15_000_000  # over mm/min
STRAY_COUNTS = 2.0  # rounding, and a step whose interrupt waits
FEEDS_MM_MIN = {b"1": 100.0, b"2": 1000.0, b"3": 3000.0}
PATHS = {b"s": InputPath.SKIP, b"p": InputPath.PLC}
SCAN_US = 1000
ROUNDS = 10  # of all paths and feeds, so that none goes with the time
REST_US = 3 * SCAN_US  # the line is low at least so long: several scans see it
PATIENCE_US = 20 * SCAN_US
SETTLE_US = 2 * SCAN_US
SCAN_EARLY_TICKS = 100 * TICKS_PER_US
WAIT_S = 0.02

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
        # Both clocks of the campaign are zero at one tick of the device, however coarse that is.
        lead_ticks = int(LEAD_S * US_PER_S) * TICKS_PER_US
        self._zero = (self._ahead - lead_ticks) % (1 << tick_shift)

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

    def touch(self, wait_ticks: int, feed_mm_min: float) -> tuple[int, Latch | None]:
        """Inject an edge so much later; give when it came and what was latched. Stopped.

        A campaign tells the start of a move to the µs: up to 1 µs is added, so that a move at this
        feed that meets its surface at the edge starts at a whole one.
        """
        speed_mm_s = feed_mm_min / S_PER_MIN
        travel_s = APPROACH_MM / speed_mm_s + speed_mm_s / (2.0 * BELIEVED.axis.accel_mm_s2)
        due = self._emulator.now() + wait_ticks + self._zero
        wait_ticks += (round(travel_s * US_PER_S * TICKS_PER_US) - due) % TICKS_PER_US
        self._emulator.release()
        edge = self._emulator.deflect_in(wait_ticks)
        self._emulator.go()
        end = edge + PATIENCE_US * TICKS_PER_US
        latch = self._receive(WAIT_S)
        while latch is None and self._emulator.now() < end:
            latch = self._receive(WAIT_S)
        self._emulator.stop()
        latch = latch or self._receive(WAIT_S)  # what was sent before the stop has arrived by now
        if self._reports.lost + self._reports.damaged:
            raise RuntimeError("records were lost on an emulated wire")
        return edge, latch

    def _receive(self, wait_s: float) -> Latch | None:
        """Wait so long for the bytes of a record."""
        self._emulator.serial.settimeout(wait_s)
        latch = None
        while latch is None:
            try:
                self._bytes += self._emulator.serial.recv(FRAME_BYTES - len(self._bytes))
            except TimeoutError:
                break
            if len(self._bytes) == FRAME_BYTES:
                latch = self._reports.take(self._bytes)
                self._bytes = b""
        return latch

    def stamp(self, latch: Latch, edge: int) -> int:
        """Give the master clock of a latch.

        A coarse stamp may lie before the edge, and so may that of a scan, which takes the time
        first and reads the line about 1 µs later, or after an interrupt in between.
        """
        stamp = self._master(latch.ticks, edge)
        early = SCAN_EARLY_TICKS if latch.path == "plc" else 0
        if stamp < edge - early - (1 << self._tick_shift):
            raise RuntimeError(f"latched {edge - stamp} ticks before the edge")
        return stamp

    def recorded(
        self, path: bytes, feed: bytes, started: int, edge: int, latch: Latch | None
    ) -> Recorded:
        """Give the row of the campaign."""
        feed_mm_min = FEEDS_MM_MIN[feed]
        latch_us = deviation = np.nan
        if latch is not None:
            stamp = self.stamp(latch, edge)
            latch_us = (stamp + self._zero) * US_PER_TICK
            deviation = deviation_um(latch, stamp, edge, started, feed_mm_min)
        edge_us = (edge + self._zero) * US_PER_TICK
        return Recorded(PATHS[path], feed_mm_min, edge_us, latch_us, np.nan, deviation)


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


def blocks(touches: int, paths: str) -> Iterator[tuple[bytes, bytes, int]]:
    """Give path, feed and number of touches of every block; `touches` are those of one path."""
    shares = np.diff(np.linspace(0, touches, ROUNDS * len(FEEDS_MM_MIN) + 1).astype(int))
    for number, share in enumerate(shares):
        for path in (letter.encode() for letter in paths):
            yield path, list(FEEDS_MM_MIN)[number % len(FEEDS_MM_MIN)], int(share)


def play(
    program: Path, touches: int, *, tick_shift: int = 0, seed: int = 1, paths: str = "sp"
) -> list[Recorded]:
    """Inject so many edges on each path, at random instants of the scan."""
    random = np.random.default_rng(seed)
    played = []
    with (
        Emulator(program) as emulator,
        tqdm(total=len(paths) * touches, unit="touch", disable=not sys.stderr.isatty()) as bar,
    ):
        board = Board(emulator, symbols_of(program), tick_shift)
        for path, feed, count in blocks(touches, paths):
            started = board.start_block(path, feed)
            for _ in range(count):
                wait = int(random.uniform(REST_US, REST_US + SCAN_US) * TICKS_PER_US)
                edge, latch = board.touch(wait, FEEDS_MM_MIN[feed])
                played.append(board.recorded(path, feed, started, edge, latch))
                bar.update()
    return played


def symbols_of(program: Path) -> dict[str, int]:
    """Give the addresses of the program's variables."""
    command = ("arm-none-eabi-nm", str(program))
    text = subprocess.check_output(command, text=True)
    return {name: int(address, 16) for address, _, name in map(str.split, text.splitlines())}


def main() -> int:
    """Record a campaign of the program on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, help="firmware.elf of the board")
    parser.add_argument("--out", type=Path, required=True, help="folder of the campaign")
    parser.add_argument("--touches", type=int, default=3000, help="on each path")
    parser.add_argument("--tick-shift", type=int, default=0, help="the build's prescaler")
    parser.add_argument("--paths", default="sp", choices=("s", "p", "sp"), help="skip, PLC, both")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    played = play(
        options.program,
        options.touches,
        tick_shift=options.tick_shift,
        seed=options.seed,
        paths=options.paths,
    )
    write_campaign(options.out, BELIEVED, as_touches(BELIEVED, played))
    for path in dict.fromkeys(touch.path for touch in played):
        late_us = np.array([t.latch_us - t.edge_us for t in played if t.path == path])
        missed = np.isnan(late_us)
        print(
            f"{path.name.lower()}: {np.sum(~missed)} latched, {np.sum(missed)} missed; "
            f"latch - edge in µs: least {np.nanmin(late_us):.2f}, "
            f"mean {np.nanmean(late_us):.3f}, most {np.nanmax(late_us):.2f}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
