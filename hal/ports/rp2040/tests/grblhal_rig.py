"""The skip input beside a model of grblHAL's probe input, in rp2040js: the same touches for both.

    python -m hal.ports.rp2040.tests.grblhal_rig build/boards/rp2040/beside_grblhal.elf

The program is `main_beside_grblhal.c`. The rig reads in its memory what each of the two latched of
an edge, and takes the pulses that had begun at the edge from the program as it stands there.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hal.ports.rp2040.tests.emulator import Emulator
from tests.boards.qemu_rig import FEEDS_MM_MIN, symbols_of

START_UP_NS = 1_000_000
REST_NS = 500_000
"""The line is low at least so long; after an edge it is high as long, and a tick is over."""
STEP_NS = 3_000_000
"""The longest step: edges come anywhere in it."""
NS_PER_US = 1000
COUNTS = 1 << 32
WHO = ("skip", "stepper")
NAMES = {"skip": "skip input", "stepper": "model of grblHAL"}


class Bench:
    """The program in its emulator; times are ns of virtual time."""

    def __init__(self, emulator: Emulator, program: Path) -> None:
        """Let it start up."""
        self._emulator = emulator
        self._symbols = symbols_of(program, Emulator.NM)
        emulator.run(START_UP_NS)

    def _read(self, name: str) -> int:
        return self._emulator.read(self._symbols[name])

    def _touches(self) -> list[int]:
        return [self._read(f"{who}_touches") for who in WHO]

    def _stamps_us(self) -> list[int]:
        """Give both in whole µs since reset; the device clock has an offset to that."""
        skip_us = (self._read("skip_ticks") - self._read("clock_offset_ticks")) % COUNTS
        return [skip_us, self._read("stepper_us")]

    def run_axis(self, feed: bytes) -> None:
        """Let the axis run from 0 at one of the feeds."""
        self._emulator.serial.sendall(feed)
        self._emulator.run(STEP_NS)

    def touch(self, wait_ns: int) -> list[tuple[float, int]]:
        """Inject an edge; give µs after it and steps after it of what each of WHO latched.

        Raises:
            RuntimeError: One of the two has not latched it just once.
        """
        before = self._touches()
        edge_ns = self._emulator.deflect_in(wait_ns)
        self._emulator.run(wait_ns)
        pulses = self._read("axis_pulses")
        self._emulator.run(REST_NS)
        if self._touches() != [count + 1 for count in before]:
            raise RuntimeError("an edge was lost, or latched twice")
        return [
            (stamp_us - edge_ns / NS_PER_US, self._read(f"{who}_counts") - pulses)
            for who, stamp_us in zip(WHO, self._stamps_us(), strict=True)
        ]


def play(program: Path, touches: int, seed: int) -> dict[float, NDArray[np.float64]]:
    """Give for each feed in mm/min how late both latched, in µs and in steps; shape (n, 2, 2)."""
    random = np.random.default_rng(seed)
    played = {}
    with Emulator(program) as emulator:
        bench = Bench(emulator, program)
        for letter, feed_mm_min in FEEDS_MM_MIN.items():
            bench.run_axis(letter)
            waits = random.integers(REST_NS, REST_NS + STEP_NS, touches)
            played[feed_mm_min] = np.array([bench.touch(int(wait)) for wait in waits])
    return played


def main() -> int:
    """Measure the program of the command line; give the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, help="beside_grblhal.elf of the board")
    parser.add_argument("--touches", type=int, default=500, help="at each feed")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    for feed_mm_min, late in play(options.program, options.touches, options.seed).items():
        for at, who in enumerate(WHO):
            us, steps = late[:, at, 0], late[:, at, 1]
            print(
                f"{feed_mm_min:g} mm/min, {NAMES[who]}: {len(us)} latched; latch - edge in µs: "
                f"mean {us.mean():.2f}, 99 % {np.percentile(us, 99):.2f}, most {us.max():.2f}; "
                f"steps late: {steps.min():.0f} to {steps.max():.0f}, {np.mean(steps > 0):.1%} late"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
