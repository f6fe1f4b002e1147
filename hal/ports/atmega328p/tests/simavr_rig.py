"""The ATmega328P in simavr as a bench: injects edges at exact cycles, records a campaign.

    python -m hal.ports.atmega328p.tests.simavr_rig PROGRAM.elf --out build/campaign

`emulator` says how the times are known.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hal.ports.atmega328p.tests.edges import Block, plan
from hal.ports.atmega328p.tests.emulator import CAPTURE, CYCLES_PER_US, PIN_CHANGE, Events, run
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
from tests.boards.record import Recorded, as_touches

RESOLUTION_UM = 2.0
SCAN_US = 2000
CLOCK_TICKS = 1 << 32
FRAME_BYTES = 8
EARLY_CYCLES = 300 * CYCLES_PER_US  # by so much at most a stamp may lie before its edge


def believed(skip: SkipNominal, report: ReportNominal) -> Nominal:
    """Give what is believed of the board, beside what is sure."""
    return Nominal(
        kind=Kind.BENCH,
        probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
        input=InputNominal(filter_us=0.0),
        skip=skip,
        plc=PlcNominal(scan_us=float(SCAN_US)),
        axis=AxisNominal(resolution_um=RESOLUTION_UM, accel_mm_s2=10_000.0),
        report=report,
        bench=BenchNominal(reference_jitter_us=0.018),
    )


CAPTURED = SkipNominal(latency_us=0.0, jitter_us=0.0, tick_us=0.0625)

# By the data sheet: a record is 16 bytes of ten bits at 250 kBd; a pin change takes 4 cycles to
# enter, 3 to jump, up to 3 more for the instruction that runs.
_SHEET_REPORT = ReportNominal(latency_us=640.0, jitter_us=0.0)
_SHEET_CHANGE = SkipNominal(latency_us=0.4375, jitter_us=0.1875, tick_us=0.0625)

# As the undisturbed board does it: the task's round, 44 µs a byte, the prologue of the interrupt.
_FOUND_REPORT = ReportNominal(latency_us=882.0, jitter_us=70.0)
_FOUND_CHANGE = SkipNominal(latency_us=2.4375, jitter_us=5.5, tick_us=0.0625)


def nominal_of(*, pin_change: bool, corrected: bool) -> Nominal:
    """Give nominal.toml of a build: by the data sheet, or corrected by the undisturbed board."""
    change = _FOUND_CHANGE if corrected else _SHEET_CHANGE
    report = _FOUND_REPORT if corrected else _SHEET_REPORT
    return believed(change if pin_change else CAPTURED, report)


def frames_of(events: Events) -> list[bytes]:
    """Give the frames that have left the board whole."""
    sent = bytes(value for _, value in events.received)
    return [sent[i : i + FRAME_BYTES] for i in range(0, len(sent) - FRAME_BYTES + 1, FRAME_BYTES)]


def latches(events: Events) -> list[tuple[Latch, int]]:
    """Give the records, and the cycle at which the last byte of each had come."""
    reports = LatchReports()
    found = []
    for number, frame in enumerate(frames_of(events), start=1):
        latch = reports.take(frame)
        if latch is not None:
            found.append((latch, events.received[FRAME_BYTES * number - 1][0]))
    if reports.lost or reports.damaged or reports.unpaired:
        raise RuntimeError("a record was lost on an emulated wire")
    return found


def recorded(events: Events, blocks: Sequence[Block], prescaler: int) -> list[Recorded]:
    """Put each edge and its latch together: the latch with a stamp between it and the next one.

    A stamp may lie before its edge: a coarse one does, and a scan takes the time before it reads
    the line.
    """
    zero = events.clock_zero(prescaler)
    conditions = [block for block in blocks for _ in range(block.count)]
    edges = np.array([cycle for cycle, _ in events.rises])
    of_edge: dict[int, tuple[Latch, int, int]] = {}
    for latch, report in latches(events):
        stamp = _stamp(latch, report - zero, prescaler) + zero
        number = int(np.searchsorted(edges, stamp + EARLY_CYCLES, side="right")) - 1
        if number in of_edge or number < 0:
            raise RuntimeError("a latch belongs to no edge")
        of_edge[number] = latch, stamp, report
    return [
        _recorded(block, rise, of_edge.get(number))
        for number, (block, rise) in enumerate(zip(conditions, events.rises, strict=True))
    ]


def _recorded(
    block: Block, rise: tuple[int, int], latched: tuple[Latch, int, int] | None
) -> Recorded:
    edge, pulses = rise
    latch_us = report_us = deviation_um = float("nan")
    if latched is not None:
        latch, stamp, report = latched
        latch_us, report_us = stamp / CYCLES_PER_US, report / CYCLES_PER_US
        deviation_um = (latch.position_counts - pulses) * RESOLUTION_UM
    return Recorded(
        path=block.path,
        feed_mm_min=block.feed_mm_min,
        edge_us=edge / CYCLES_PER_US,
        latch_us=latch_us,
        report_us=report_us,
        deviation_um=deviation_um,
    )


def _stamp(latch: Latch, about: int, prescaler: int) -> int:
    """Give the cycle of a stamp of the clock that wraps, nearest to another one."""
    span = CLOCK_TICKS * prescaler
    return about + (latch.ticks * prescaler - about + span // 2) % span - span // 2


def main() -> int:
    """Record a campaign of the program on the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("program", type=Path, help="firmware.elf of the board")
    parser.add_argument("--out", type=Path, required=True, help="folder of the campaign")
    parser.add_argument("--touches", type=int, default=10_000, help="on each path")
    parser.add_argument("--prescaler", type=int, default=1, help="CLOCK_PRESCALER of the build")
    parser.add_argument("--pin-change", action="store_true", help="believe in that build")
    parser.add_argument(
        "--corrected", action="store_true", help="believe the undisturbed board, not its data sheet"
    )
    parser.add_argument("--stamp-ticks", type=int, help="fail if a skip stamp is off by more")
    parser.add_argument("--body-cycles", type=int, help="fail if the edge interrupt takes more")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    stimuli, blocks = plan(options.touches, options.seed)
    events = run(options.program, stimuli)
    touches = recorded(events, blocks, options.prescaler)
    nominal = nominal_of(pin_change=options.pin_change, corrected=options.corrected)
    write_campaign(options.out, nominal, as_touches(touches))
    print(summary(events, touches))
    missed = faults(events, touches, options.stamp_ticks, options.body_cycles)
    print("".join(f"MISSED: {fault}\n" for fault in missed), end="")
    return 1 if missed else 0


def faults(
    events: Events,
    touches: Sequence[Recorded],
    stamp_ticks: int | None,
    body_cycles: int | None,
) -> list[str]:
    """Say which goals were missed; the pulses have to be right in every run."""
    late = [abs(t.latch_us - t.edge_us) for t in touches if t.path is InputPath.SKIP]
    found = []
    if any(pulses != counts for pulses, counts in events.checks):
        found.append("pulses on the pin are not those in the firmware")
    if stamp_ticks is not None and not max(late) * CYCLES_PER_US <= stamp_ticks:
        found.append(f"a skip stamp is off by more than {stamp_ticks} ticks")
    if body_cycles is not None and events.bodies[CAPTURE].most > body_cycles:
        found.append(f"the edge interrupt takes more than {body_cycles} cycles")
    return found


def summary(events: Events, touches: Sequence[Recorded]) -> str:
    """Say what was measured."""
    lines = []
    for path in InputPath:
        of_path = [touch for touch in touches if touch.path == path]
        late = np.array([touch.latch_us - touch.edge_us for touch in of_path])
        late = late[~np.isnan(late)]
        lines.append(
            f"{path.name.lower()}: {len(late)} latched, {len(of_path) - len(late)} missed; "
            f"latch - edge in µs: least {late.min():.4f}, mean {late.mean():.4f}, "
            f"most {late.max():.4f}"
        )
    for vector in (CAPTURE, PIN_CHANGE):
        if vector in events.bodies:
            body, wait = events.bodies[vector], events.waits[vector]
            lines.append(
                f"edge interrupt: {body.least} to {body.most} cycles, mean {body.mean:.1f}; "
                f"begins {wait.mean:.1f} cycles after the edge, at most {wait.most}"
            )
    wrong = sum(pulses != counts for pulses, counts in events.checks)
    lines.append(f"pulses on the pin and in the firmware: {len(events.checks)} checks, {wrong} off")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
