"""The port with grbl's pins and timers in simavr: injects edges, records a campaign.

    python -m hal.ports.atmega328p_grbl.tests.grbl_rig PROGRAM.elf --out build/campaign

The steps are those of grbl at 80 a mm: 12.5 µm, at 100, 1000 and 3000 mm/min every 120,000, 12,000
and 4,000 cycles. Where the axis is at an edge is taken from the pulses on the step pin before and
after it, so that the firmware's own sums confirm nothing. What simavr leaves out: see the rig of
the ATmega328P, whose program runs here.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hal.ports.atmega328p.tests.edges import FEEDS_MM_MIN, ROUNDS, commands
from hal.ports.atmega328p.tests.emulator import CYCLES_PER_US, Events, Stimulus, run
from hal.ports.atmega328p.tests.simavr_rig import believed, latches
from skiplatch.bench.latches import Latch
from skiplatch.campaign import (
    AxisNominal,
    InputPath,
    PlcNominal,
    ReportNominal,
    SkipNominal,
    write_campaign,
)
from tests.boards.record import Recorded, as_touches

PIN = "C5"
PIN_CHANGE = 4
STEP_UM = 12.5
COUNTS_PER_STEP = 256
REST_CYCLES = 40_000  # between two compares at rest
CLOCK_TICKS = 1 << 32
HALF_STEP = 0.5  # a pulse lets the axis pass half a step

# The data sheets: a pin change takes 4 cycles to enter, 3 to jump, up to 3 more for the instruction
# that runs; a record is 16 bytes of ten bits at 250 kBd.
BELIEVED = replace(
    believed(
        SkipNominal(latency_us=0.4375, jitter_us=0.1875, tick_us=0.0625),
        ReportNominal(latency_us=640.0, jitter_us=0.0),
    ),
    plc=PlcNominal(scan_us=1000.0),
    axis=AxisNominal(resolution_um=STEP_UM / COUNTS_PER_STEP, accel_mm_s2=10_000.0),
)


def plan(touches: int, seed: int) -> tuple[list[Stimulus], list[float]]:
    """Give edges at random cycles, and the feed of each."""
    random = np.random.default_rng(seed)
    stimuli: list[Stimulus] = []
    feeds: list[float] = []
    cycle = 20_000
    shares = np.diff(np.linspace(0, touches, ROUNDS * len(FEEDS_MM_MIN) + 1).astype(int))
    for number, share in enumerate(shares):
        letter = list(FEEDS_MM_MIN)[number % len(FEEDS_MM_MIN)]
        stimuli += commands(cycle, letter, "s")
        cycle += 800_000  # the axis runs by then
        for _ in range(int(share)):
            rise = cycle + int(random.uniform(3600.0, 4600.0) * CYCLES_PER_US)
            cycle = rise + int(random.uniform(200.0, 400.0) * CYCLES_PER_US)
            stimuli += [(rise, "e", 1), (cycle, "e", 0)]
            feeds.append(FEEDS_MM_MIN[letter])
        cycle += 400_000
    return [*stimuli, (cycle, "q", 0)], feeds


@dataclass(frozen=True, slots=True)
class Touch:
    """One edge, in cycles, and what was latched of it.

    Attributes:
        feed_mm_min: The speed of the axis.
        edge: When the line rose.
        place: Where the axis was then, in steps.
        latch: What the firmware has latched, or None.
        stamp: When, by its own clock.
        report: When the last byte of the record had come.
    """

    feed_mm_min: float
    edge: int
    place: float
    latch: Latch | None = None
    stamp: int = 0
    report: int = 0

    @property
    def late_us(self) -> float:
        """Latch less edge; NaN if it was missed."""
        return (self.stamp - self.edge) / CYCLES_PER_US if self.latch else float("nan")

    @property
    def off_um(self) -> float:
        """Latched place less the true one; NaN if it was missed."""
        if self.latch is None:
            return float("nan")
        return (self.latch.position_counts / COUNTS_PER_STEP - self.place) * STEP_UM

    def recorded(self) -> Recorded:
        """Give the row of the campaign."""
        report_us = self.report / CYCLES_PER_US if self.latch else float("nan")
        edge_us = self.edge / CYCLES_PER_US
        return Recorded(
            path=InputPath.SKIP,
            feed_mm_min=self.feed_mm_min,
            edge_us=edge_us,
            latch_us=edge_us + self.late_us,
            report_us=report_us,
            deviation_um=self.off_um,
        )


def touches_of(events: Events, feeds: Sequence[float]) -> list[Touch]:
    """Put each edge and its latch together: the first latch whose record comes after it."""
    zero = events.ticks[0] - REST_CYCLES
    waiting = latches(events)
    played = []
    ends = [cycle for cycle, _ in events.rises[1:]] + [events.end]
    for (edge, pulses), (before, after), feed, end in zip(
        events.rises, events.arounds, feeds, ends, strict=True
    ):
        place = pulses - HALF_STEP + (edge - before) / (after - before)
        mine = [(latch, report) for latch, report in waiting if edge <= report < end]
        if len(mine) > 1:
            raise RuntimeError(f"{len(mine)} latches of one edge")
        if not mine:
            played.append(Touch(feed, edge, place))
            continue
        latch, report = mine[0]
        waiting = waiting[1:]
        passed = (latch.ticks - (edge - zero) + CLOCK_TICKS // 2) % CLOCK_TICKS - CLOCK_TICKS // 2
        played.append(Touch(feed, edge, place, latch, edge + passed, report))
    return played


def play(program: Path, touches: int, seed: int = 1) -> tuple[Events, list[Touch]]:
    """Inject so many edges."""
    stimuli, feeds = plan(touches, seed)
    events = run(program, stimuli, PIN)
    return events, touches_of(events, feeds)


def summary(events: Events, played: Sequence[Touch]) -> str:
    """Say what was measured, for each feed."""
    lines = []
    for feed in FEEDS_MM_MIN.values():
        late = np.array([touch.late_us for touch in played if touch.feed_mm_min == feed])
        off = np.array([touch.off_um for touch in played if touch.feed_mm_min == feed])
        missed = np.isnan(late).sum()
        lines.append(
            f"{feed:4.0f} mm/min: {len(late) - missed} latched, {missed} missed; "
            f"latch - edge in µs: mean {np.nanmean(late):.2f}, "
            f"99 % {np.nanquantile(late, 0.99):.2f}, most {np.nanmax(late):.2f}; "
            f"place in µm: least {np.nanmin(off):.2f}, mean {np.nanmean(off):.2f}, "
            f"most {np.nanmax(off):.2f}"
        )
    body = events.bodies[PIN_CHANGE]
    lines.append(f"edge interrupt: {body.least} to {body.most} cycles, mean {body.mean:.1f}")
    wrong = sum(pulses != steps for pulses, steps in events.checks)
    lines.append(f"pulses on the pin and in the firmware: {len(events.checks)} checks, {wrong} off")
    return "\n".join(lines)


def main() -> int:
    """Record a campaign of the program on the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("program", type=Path, help="firmware.elf of the board")
    parser.add_argument("--out", type=Path, required=True, help="folder of the campaign")
    parser.add_argument("--touches", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    events, played = play(options.program, options.touches, options.seed)
    write_campaign(options.out, BELIEVED, as_touches([touch.recorded() for touch in played]))
    print(summary(events, played))
    is_wrong = any(pulses != steps for pulses, steps in events.checks)
    print("MISSED: pulses on the pin are not those in the firmware\n" if is_wrong else "", end="")
    return 1 if is_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
