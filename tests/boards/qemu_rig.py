"""A board in QEMU, or the like, as a bench: injects edges, records a campaign.

The latch is the firmware's own stamp. Edge and latch come from one virtual time: no drift between
the two clocks can show here. The emulated UARTs take no time for a byte, so reports are not timed:
`report_us` is empty. How an edge is injected and how its instant is known, each board's rig says.
"""

import argparse
import subprocess
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import numpy as np
from tqdm import tqdm

from skiplatch.bench.latches import Latch, LatchReports
from skiplatch.campaign import InputPath, Nominal, write_campaign
from tests.boards.emulated import EmulatedBoard
from tests.boards.record import Recorded, as_touches

COUNTS = 1 << 32
FRAME_BYTES = 8
FEEDS_MM_MIN = {b"1": 100.0, b"2": 1000.0, b"3": 3000.0}
PATHS = {b"s": InputPath.SKIP, b"p": InputPath.PLC}
SCAN_US = 1000
ROUNDS = 10  # of all paths and feeds, so that none goes with the time
REST_US = 3 * SCAN_US  # the line is low at least so long: several scans see it
PATIENCE_US = 20 * SCAN_US
SETTLE_US = 2 * SCAN_US
SCAN_EARLY_US = 100
WAIT_S = 0.02


class Rig(ABC):
    """The program in its emulator: its clock, its commands, its records.

    Times are ticks of the master clock. Between calls the emulator stands.

    Attributes:
        EMULATOR: What runs the program.
        BELIEVED: The nominal side of the campaign.
        TICKS_PER_US: Of the master clock.
        DEVICE_TICK: A tick of the device clock, in those.
    """

    EMULATOR: ClassVar[type[EmulatedBoard]]
    BELIEVED: ClassVar[Nominal]
    TICKS_PER_US: ClassVar[int]
    DEVICE_TICK: ClassVar[int]

    def __init__(self, emulator: EmulatedBoard, symbols: dict[str, int], tick_shift: int) -> None:
        """Let it start up.

        Args:
            emulator: Runs the program, stopped at reset.
            symbols: Where the program's variables are.
            tick_shift: The build's prescaler; its power of two.
        """
        self._emulator = emulator
        self._symbols = symbols
        self._tick = self.DEVICE_TICK << tick_shift
        self._reports = LatchReports()
        self._bytes = b""
        self._start()
        self._ahead = self._device_clock() - emulator.now()
        # Both clocks of the campaign are zero at one tick of the device, however coarse that is.
        self._zero = self._ahead % self._tick

    @abstractmethod
    def _start(self) -> None:
        """Let the program start, and the bench's instruments, the line low."""

    @abstractmethod
    def _device_clock(self) -> int:
        """Read the device clock, as hal_clock_now_ticks() does."""

    @abstractmethod
    def _inject(self, wait_us: float) -> int:
        """Let the line fall, and rise so much later; give when. The emulator may run afterwards."""

    @abstractmethod
    def deviation_um(self, latch: Latch, stamp: int, edge: int, feed_mm_min: float) -> float:
        """Take the way of the axis from where it is at the edge to the latched count.

        Raises:
            RuntimeError: Counts were lost, or counted twice.
        """

    def _master(self, device_ticks: int, about: int) -> int:
        """Give the master clock for a stamp of the device clock that was taken about then."""
        span = COUNTS * self._tick
        stamp = device_ticks * self._tick - self._ahead
        return about + (stamp - about + span // 2) % span - span // 2

    def run_for(self, us: float) -> None:
        """Let the program run for at least so long, and stop."""
        end = self._emulator.now() + us * self.TICKS_PER_US
        self._emulator.go()
        while self._emulator.now() < end:
            time.sleep(0.0002)
        self._emulator.stop()

    def start_block(self, path: bytes, feed: bytes) -> None:
        """Set the board to a path and a feed."""
        for command in (b"n", feed, path):
            self._emulator.serial.sendall(command)
            self.run_for(SETTLE_US)

    def touch(self, path: bytes, feed: bytes, wait_us: float) -> Recorded:
        """Inject an edge so much later; give what came of it."""
        edge = self._inject(wait_us)
        self._emulator.go()
        end = edge + PATIENCE_US * self.TICKS_PER_US
        latch = self._receive(WAIT_S)
        while latch is None and self._emulator.now() < end:
            latch = self._receive(WAIT_S)
        self._emulator.stop()
        latch = latch or self._receive(WAIT_S)  # what was sent before the stop has arrived by now
        if self._reports.lost + self._reports.damaged:
            raise RuntimeError("records were lost on an emulated wire")
        return self._recorded(PATHS[path], FEEDS_MM_MIN[feed], edge, latch)

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
        early = SCAN_EARLY_US * self.TICKS_PER_US if latch.path == "plc" else 0
        if stamp < edge - early - self._tick:
            raise RuntimeError(f"latched {edge - stamp} ticks before the edge")
        return stamp

    def _recorded(
        self, path: InputPath, feed_mm_min: float, edge: int, latch: Latch | None
    ) -> Recorded:
        """Give the row of the campaign."""
        latch_us = deviation = np.nan
        if latch is not None:
            stamp = self.stamp(latch, edge)
            latch_us = (stamp + self._zero) / self.TICKS_PER_US
            deviation = self.deviation_um(latch, stamp, edge, feed_mm_min)
        edge_us = (edge + self._zero) / self.TICKS_PER_US
        return Recorded(path, feed_mm_min, edge_us, latch_us, np.nan, deviation)


def blocks(touches: int, paths: str) -> Iterator[tuple[bytes, bytes, int]]:
    """Give path, feed and number of touches of every block; `touches` are those of one path."""
    shares = np.diff(np.linspace(0, touches, ROUNDS * len(FEEDS_MM_MIN) + 1).astype(int))
    for number, share in enumerate(shares):
        for path in (letter.encode() for letter in paths):
            yield path, list(FEEDS_MM_MIN)[number % len(FEEDS_MM_MIN)], int(share)


def play(
    rig: type[Rig],
    program: Path,
    touches: int,
    *,
    tick_shift: int = 0,
    seed: int = 1,
    paths: str = "sp",
) -> list[Recorded]:
    """Inject so many edges on each path, at random instants of the scan."""
    random = np.random.default_rng(seed)
    played = []
    with (
        rig.EMULATOR(program) as emulator,
        tqdm(total=len(paths) * touches, unit="touch", disable=not sys.stderr.isatty()) as bar,
    ):
        board = rig(emulator, symbols_of(program, rig.EMULATOR.NM), tick_shift)
        for path, feed, count in blocks(touches, paths):
            board.start_block(path, feed)
            for _ in range(count):
                wait_us = random.uniform(REST_US, REST_US + SCAN_US)
                played.append(board.touch(path, feed, wait_us))
                bar.update()
    return played


def symbols_of(program: Path, nm: str) -> dict[str, int]:
    """Give the addresses of the program's variables."""
    text = subprocess.check_output((nm, str(program)), text=True)
    return {name: int(address, 16) for address, _, name in map(str.split, text.splitlines())}


def record(rig: type[Rig], description: str) -> int:
    """Record a campaign of the program on the command line; give the exit status."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("program", type=Path, help="firmware.elf of the board")
    parser.add_argument("--out", type=Path, required=True, help="folder of the campaign")
    parser.add_argument("--touches", type=int, default=3000, help="on each path")
    parser.add_argument("--tick-shift", type=int, default=0, help="the build's prescaler")
    parser.add_argument("--paths", default="sp", choices=("s", "p", "sp"), help="skip, PLC, both")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    played = play(
        rig,
        options.program,
        options.touches,
        tick_shift=options.tick_shift,
        seed=options.seed,
        paths=options.paths,
    )
    write_campaign(options.out, rig.BELIEVED, as_touches(played))
    lost = 0
    for path in dict.fromkeys(touch.path for touch in played):
        late_us = np.array([t.latch_us - t.edge_us for t in played if t.path == path])
        missed = np.isnan(late_us)
        print(
            f"{path.name.lower()}: {np.sum(~missed)} latched, {np.sum(missed)} missed; "
            f"latch - edge in µs: least {np.nanmin(late_us):.2f}, "
            f"mean {np.nanmean(late_us):.3f}, most {np.nanmax(late_us):.2f}"
        )
        lost += int(np.sum(missed)) if path is InputPath.SKIP else 0
    if lost:
        print(f"MISSED: {lost} edges of the skip input")
    return 1 if lost else 0
