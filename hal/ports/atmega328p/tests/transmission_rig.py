"""The program of the ATmega328P that measures a transmission error, in simavr: how fast, how well.

    python -m hal.ports.atmega328p.tests.transmission_rig build/boards/atmega328p/transmission.elf

Two trains of pulses of the simulated gear train go to the program's pins, at rising speed, until it
loses one. What it reports is held against the same firmware on this host, fed with the stamps that
the program took: the rig reads them from its memory.
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hal.ports.atmega328p.tests.emulator import CAPTURE, Events, Stimulus, run
from hal.ports.atmega328p.tests.simavr_rig import FRAME_BYTES
from skiplatch.transmission.firmware import INPUT, NAS_PER_ARCSEC, Transmission
from skiplatch.transmission.simulated import Encoder, Gear, GearStage, Machine, simulated_pulses

CLOCK_HZ = 16e6
LINES1, LINES2, RATIO = 1024, 3600, Fraction(407, 10)
"""The chain of ``main_transmission.c``."""
BEGIN_CYCLE = 20_000
FIRST_CYCLE = 1_000_000  # setting up takes 31 ms of divisions
HIGH_CYCLES = 32
END_CYCLES = 800_000  # until the last points have left
NAS_PER_UNIT = 256
SAME_SHARE = 0.99
SWAPPED_ARCSEC = 0.05
"""Where pulses of both trains have changed places, a part of a line is taken of the next line."""
INTERRUPT = 1  # INT0
EXTRA_CYCLES = 4
"""The chip takes these to enter an interrupt, and the program takes them off; simavr does not."""


@dataclass(frozen=True, eq=False)
class Trains:
    """Cycles and channels (0 input, 1 output) of n pulses, in order; shape (n,)."""

    cycles: NDArray[np.int64]
    channels: NDArray[np.int64]

    @property
    def per_s(self) -> float:
        """Pulses of both trains in a second."""
        return float((len(self.cycles) - 1) / (self.cycles[-1] - self.cycles[0]) * CLOCK_HZ)

    def first(self, count: int) -> "Trains":
        """Give the first so many."""
        return Trains(self.cycles[:count], self.channels[:count])


def trains(speed_rev_s: float, seconds: float) -> Trains:
    """Give the pulses of the chain at this speed of its input."""
    gears = GearStage(
        driver=Gear(teeth=10, eccentricity_um=3.0), driven=Gear(teeth=407, eccentricity_um=10.0)
    )
    machine = Machine(
        stages=[gears],
        input=Encoder(lines=LINES1),
        output=Encoder(lines=LINES2),
        speed_rev_s=speed_rev_s,
        turns=speed_rev_s * seconds,
        clock_hz=CLOCK_HZ,
    )
    blocks = list(simulated_pulses(machine))
    t_ns = np.concatenate([block.t_ns for block in blocks])
    channel = np.concatenate([block.channel for block in blocks])
    cycles = FIRST_CYCLE + np.rint(t_ns * (CLOCK_HZ / 1e9)).astype(np.int64)
    return Trains(cycles, channel.astype(np.int64) - 1)


def play(program: Path, given: Trains) -> Events:
    """Have the program measure these trains."""
    stimuli: list[Stimulus] = [(BEGIN_CYCLE, "u", ord("m"))]
    for cycle, channel in zip(given.cycles.tolist(), given.channels.tolist(), strict=True):
        stimuli += [(cycle, "p", channel), (cycle + HIGH_CYCLES, "l", channel)]
    stimuli.sort()
    return run(program, [*stimuli, (stimuli[-1][0] + END_CYCLES, "q", 0)])


# ---- what came of it -----------------------------------------------------------------------------


def unseen(events: Events) -> int:
    """Give how many pulses the program has not noted."""
    return len(events.pulses) - len(events.notes)


def late_cycles(events: Events, channel: int) -> NDArray[np.int64]:
    """Give stamp less edge, as on the chip, of each pulse of a channel; none may be lost."""
    edges = np.array([cycle for cycle, of in events.pulses if of == channel])
    stamps = np.array([ticks for of, ticks, _ in events.notes if of == channel])
    entry = EXTRA_CYCLES if channel == 0 else 0
    return np.asarray(stamps + events.clock_zero(1) - edges + entry)


def board_points(events: Events) -> NDArray[np.int64]:
    """Give lines and error in units of 256 nas as the program sent them; shape (n, 2)."""
    data = bytes(value for _, value in events.received)
    frames = [data[i : i + FRAME_BYTES] for i in range(0, len(data) - 7, FRAME_BYTES)]
    if any(frame[0] != 0 for frame in frames):
        raise RuntimeError("the program began a new part: it has lost pulses")
    points = [
        (
            int.from_bytes(frame[1:3], "little", signed=True),
            int.from_bytes(frame[3:8], "little", signed=True),
        )
        for frame in frames
    ]
    return np.array(points, dtype=np.int64).reshape(-1, 2)


def host_points(channels: NDArray[np.int64], ticks: NDArray[np.int64]) -> NDArray[np.int64]:
    """Give the same of this host's firmware."""
    order = np.argsort(ticks, kind="stable")
    core = Transmission(LINES1, LINES2, RATIO)
    points = core.feed((channels[order] + INPUT).astype(np.uint8), ticks[order])
    nas = np.rint(points.delta_arcsec * NAS_PER_ARCSEC).astype(np.int64)
    return np.column_stack([points.line, nas // NAS_PER_UNIT])


def noted(events: Events) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Give channels and ticks of what the program has noted, in its order."""
    notes = np.array(events.notes, dtype=np.int64)
    return notes[:, 0], notes[:, 1]


def off_arcsec(found: NDArray[np.int64], expected: NDArray[np.int64]) -> NDArray[np.float64]:
    """Give how far the errors of the same lines lie apart; as many points have to be there."""
    if not np.array_equal(found[:, 0], expected[:, 0]):
        raise RuntimeError("the points do not stand at the same lines")
    return np.asarray((found[:, 1] - expected[:, 1]) * (NAS_PER_UNIT / NAS_PER_ARCSEC))


# ---- how fast ------------------------------------------------------------------------------------


def highest(is_good: Callable[[float], bool], least: float, most: float, within: float) -> float:
    """Give the highest value that is good, to a relative `within`; `least` is, `most` is not."""
    while most / least > 1.0 + within:
        middle = (least * most) ** 0.5
        least, most = (middle, most) if is_good(middle) else (least, middle)
    return least


def sustained_rev_s(program: Path, seconds: float, within: float) -> float:
    """Give the highest speed at which nothing is lost in so long a run."""
    return highest(
        lambda speed: unseen(play(program, trains(speed, seconds))) == 0, 2.0, 50.0, within
    )


def burst_rev_s(program: Path, pulses: int, within: float) -> float:
    """Give the highest speed at which nothing is lost of a burst of so many pulses."""

    def is_good(speed: float) -> bool:
        seconds = 2.0 * pulses / (speed * LINES1)
        return unseen(play(program, trains(speed, seconds).first(pulses))) == 0

    return highest(is_good, 2.0, 500.0, within)


def report_speed(program: Path, seconds: float, bursts: list[int], within: float) -> None:
    """Print the highest rates without loss."""
    speed = sustained_rev_s(program, seconds, within)
    print(
        f"sustained, {seconds:g} s: {trains(speed, seconds).per_s:.0f} pulses/s ({speed:.2f} rev/s)"
    )
    for pulses in bursts:
        speed = burst_rev_s(program, pulses, within)
        rate = trains(speed, 1.0).per_s
        print(f"burst of {pulses}: {rate:.0f} pulses/s ({speed:.1f} rev/s)")


def report_quality(program: Path, speed_rev_s: float, seconds: float) -> bool:
    """Print how good stamps and points are; tell whether the points are those of the host."""
    given = trains(speed_rev_s, seconds)
    events = play(program, given)
    found = board_points(events)
    same = off_arcsec(found, host_points(*noted(events)))
    exact = off_arcsec(found, host_points(given.channels, given.cycles))
    for channel, vector in ((0, INTERRUPT), (1, CAPTURE)):
        late, body = late_cycles(events, channel), events.bodies[vector]
        print(
            f"channel {channel}: {len(late)} stamps, late by {late.min()} to {late.max()} cycles, "
            f"{np.mean(late > EXTRA_CYCLES):.2%} by more than {EXTRA_CYCLES}; "
            f"interrupt {body.least} to {body.most} cycles"
        )
    exact -= np.median(exact)
    print(
        f"{len(found)} points at {given.per_s:.0f} pulses/s, {events.lost} not sent; off those of "
        f'the host for the same stamps by at most {np.abs(same).max():.2g}", equal in '
        f'{np.mean(same == 0):.2%}; off those of exact stamps: rms {exact.std():.2g}", most '
        f'{np.abs(exact).max():.2g}"'
    )
    return bool(np.mean(same == 0) > SAME_SHARE and np.abs(same).max() < SWAPPED_ARCSEC)


def main() -> int:
    """Measure the program on the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("program", type=Path, help="transmission.elf of the board")
    parser.add_argument("--seconds", type=float, default=4.0, help="of a sustained run")
    parser.add_argument("--within", type=float, default=0.005, help="relative, of the rates")
    options = parser.parse_args()
    report_speed(options.program, options.seconds, [64, 128, 256, 512], options.within)
    is_same = report_quality(options.program, 5.0, options.seconds)
    print("" if is_same else "MISSED: points are not those of the host\n", end="")
    return 0 if is_same else 1


if __name__ == "__main__":
    sys.exit(main())
