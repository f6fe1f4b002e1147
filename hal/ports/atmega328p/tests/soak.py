"""The ATmega328P in simavr under random edges, power cuts and a bad bus, for as long as it is let.

    python -m hal.ports.atmega328p.tests.soak SECONDS SEED

Each run is a board that is switched on, on a build of its own, and loses its power at a random
cycle. Every edge but those just before is latched once, and on the skip path stamped within a tick;
a PLC task whose scans are late may miss one.
The bus loses, damages and repeats frames and whole records. One recorder hears all runs: what it
puts together is what was sent, comes once and in order, and what it does not is counted as lost.
Exit status 0, or 1 with what fell.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from hal.ports.atmega328p.tests.edges import Block, plan
from hal.ports.atmega328p.tests.emulator import CYCLES_PER_US, Events, Stimulus, run
from hal.ports.atmega328p.tests.simavr_rig import FRAME_BYTES, frames_of, latches, recorded
from skiplatch.bench.latches import FRAMES_PER_RECORD, Latch, LatchReports
from skiplatch.campaign import InputPath

PROGRAMS = Path("build/boards/atmega328p")
PRESCALERS = {
    "nominal": 1,
    "other_interrupt": 1,
    "critical_section": 1,
    "scan_body": 1,
    "prescaler": 64,
}
"""Of the builds whose stamps are proof against what they are disturbed by."""
LATE_SCANS = "scan_body"
"""Build whose PLC task misses some edges: the line changes twice within its longest scan."""
FEWEST, MOST = 60, 1_000
"""Touches of a run on each path."""
EARLIEST = 0.7
"""Share of a run after which the power may fail."""
ON_ITS_WAY_US = 12_000.0
"""Before the power fails, in which an edge need not have come to a record: scans and bytes."""
ODDS = 200
"""One frame in so many is lost, as many are damaged, as many repeated; and records repeated."""
QUIET = 2
"""Records after and before a restart that nothing happens to."""


class FallError(Exception):
    """Something that may not happen did."""


@dataclass(slots=True)
class Soak:
    """What was played so far, and the recorder at the far end of the bus."""

    rng: np.random.Generator
    most: int = MOST
    reports: LatchReports = field(default_factory=LatchReports)
    runs: int = 0
    edges: int = 0
    sent: int = 0
    received: int = 0
    disturbed: int = 0

    def play(self) -> None:
        """Play one run, from power-on to the cut."""
        build = str(self.rng.choice(list(PRESCALERS)))
        touches, seed = int(self.rng.integers(FEWEST, self.most)), int(self.rng.integers(1 << 31))
        stimuli, blocks = cut_off(*plan(touches, seed), self.rng)
        events = run(PROGRAMS / f"firmware-{build}.elf", stimuli)
        check_edges(events, blocks, PRESCALERS[build], may_miss_scans=build == LATE_SCANS)
        self.edges += len(events.rises)
        self.pass_on([latch for latch, _ in latches(events)], frames_of(events))
        self.runs += 1
        self.check_sums()

    def pass_on(self, sent: Sequence[Latch], frames: Sequence[bytes]) -> None:
        """Send the frames of a run, two for each record, over the bad bus."""
        for number, latch in enumerate(sent):
            pair = frames[FRAMES_PER_RECORD * number : FRAMES_PER_RECORD * (number + 1)]
            is_quiet = number < QUIET or number >= len(sent) - QUIET
            heard = pair if is_quiet else list(self._disturbed(pair))
            taken = [one for one in map(self.reports.take, heard) if one is not None]
            if taken not in ([], [latch]):
                raise FallError(f"run {self.runs}: record {latch} came as {taken}")
            self.received += len(taken)
        for half in frames[FRAMES_PER_RECORD * len(sent) :]:  # the power failed after it
            self.reports.take(half)
        self.sent += len(sent)

    def _disturbed(self, pair: Sequence[bytes]) -> Iterator[bytes]:
        heard = [again for frame in pair for again in self._fate(frame)]
        yield from heard
        if self.rng.integers(ODDS) == 0:  # the whole record once more
            self.disturbed += 1
            yield from heard

    def _fate(self, frame: bytes) -> list[bytes]:
        """Give what comes of a frame: nothing, another one, or it itself, once or twice."""
        kind = int(self.rng.integers(ODDS))
        self.disturbed += kind < 3
        if kind == 0:
            return []
        if kind == 1:
            bit = int(self.rng.integers(8 * FRAME_BYTES))
            damaged = bytearray(frame)
            damaged[bit // 8] ^= 1 << bit % 8
            return [bytes(damaged)]
        return [frame, frame] if kind == 2 else [frame]

    def check_sums(self) -> None:
        """Hold what came against what was sent."""
        if self.received + self.reports.lost != self.sent:
            raise FallError(
                f"run {self.runs}: {self.sent} records, {self.received} came, "
                f"{self.reports.lost} counted as lost"
            )
        if self.reports.restarts != self.runs - 1:
            raise FallError(f"{self.runs} runs, {self.reports.restarts} restarts seen")

    def __str__(self) -> str:
        return (
            f"soak on the ATmega328P: {self.edges} edges in {self.runs} runs, {self.disturbed} "
            f"frames disturbed; {self.received} records received, {self.reports.lost} lost and "
            "counted, none double or torn"
        )


def cut_off(
    stimuli: Sequence[Stimulus], blocks: Sequence[Block], rng: np.random.Generator
) -> tuple[list[Stimulus], list[Block]]:
    """Let the power fail at a random cycle; give what comes before."""
    end = int(rng.uniform(EARLIEST, 1.0) * stimuli[-1][0])
    before = [one for one in stimuli if one[0] < end]
    left, kept = sum(1 for _, kind, value in before if (kind, value) == ("e", 1)), []
    for block in blocks:
        kept.append(replace(block, count=min(block.count, left)))
        left -= kept[-1].count
    return [*before, (end, "q", 0)], kept


def check_edges(
    events: Events, blocks: Sequence[Block], prescaler: int, *, may_miss_scans: bool = False
) -> None:
    """Hold each edge against its latch; on the PLC path one may be missed where scans are late."""
    tick_us = prescaler / CYCLES_PER_US
    last_us = events.end / CYCLES_PER_US - ON_ITS_WAY_US
    for touch in recorded(events, blocks, prescaler):
        late_us, is_skip = touch.latch_us - touch.edge_us, touch.path is InputPath.SKIP
        if np.isnan(late_us):
            if touch.edge_us < last_us and (is_skip or not may_miss_scans):
                raise FallError(f"the edge at {touch.edge_us:.4f} µs was not latched")
        elif is_skip and not -tick_us <= late_us <= 1.0 / CYCLES_PER_US:
            raise FallError(f"the edge at {touch.edge_us:.4f} µs is stamped {late_us:.4f} µs late")


def main() -> int:
    """Play runs until the time is over."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("seconds", type=float)
    parser.add_argument("seed", type=int)
    given = parser.parse_args()
    soak, end = Soak(np.random.default_rng(given.seed)), time.monotonic() + given.seconds
    try:
        while soak.runs == 0 or time.monotonic() < end:
            soak.play()
    except (FallError, RuntimeError) as error:
        print(f"soak: seed {given.seed}: {error}")
        return 1
    print(f"seed {given.seed}: {soak}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
