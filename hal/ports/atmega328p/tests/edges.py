"""Edges on the trigger line of the ATmega328P: when they come, and under which conditions."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hal.ports.atmega328p.tests.emulator import CYCLES_PER_US, Stimulus
from skiplatch.campaign import InputPath

FEEDS_MM_MIN = {"1": 100.0, "2": 1000.0, "3": 3000.0}
PATHS = {"s": InputPath.SKIP, "p": InputPath.PLC}
ROUNDS = 10  # of all paths and feeds, so that none goes with the time


@dataclass(frozen=True, slots=True)
class Block:
    """Edges under one condition.

    Attributes:
        path: The input path that is on.
        feed_mm_min: The speed of the axis.
        count: How many edges.
    """

    path: InputPath
    feed_mm_min: float
    count: int


def commands(cycle: int, *letters: str) -> list[Stimulus]:
    """Send letters, a millisecond apart, from a cycle on."""
    return [(cycle + 16_000 * i, "u", ord(letter)) for i, letter in enumerate(letters)]


def plan(touches: int, seed: int) -> tuple[list[Stimulus], list[Block]]:
    """Give edges at random cycles, so many on each path, and under which conditions they come."""
    random = np.random.default_rng(seed)
    stimuli: list[Stimulus] = []
    blocks = list(_blocks(touches))
    cycle = 20_000
    for block, letters in blocks:
        stimuli += commands(cycle, "n", *letters)
        cycle += 80_000
        for _ in range(block.count):
            high_us, low_us = _touch_us(block.path, random)
            rise = cycle + int(low_us * CYCLES_PER_US)
            cycle = rise + int(high_us * CYCLES_PER_US)
            stimuli += [(rise, "e", 1), (cycle, "e", 0)]
        cycle += 80_000
    return [*stimuli, (cycle, "q", 0)], [block for block, _ in blocks]


def _blocks(touches: int) -> Iterator[tuple[Block, str]]:
    shares = np.diff(np.linspace(0, touches, ROUNDS * len(FEEDS_MM_MIN) + 1).astype(int))
    for number, share in enumerate(shares):
        feed = list(FEEDS_MM_MIN)[number % len(FEEDS_MM_MIN)]
        for letter, path in PATHS.items():
            yield Block(path, FEEDS_MM_MIN[feed], int(share)), feed + letter


def _touch_us(path: InputPath, random: np.random.Generator) -> tuple[float, float]:
    """Give how long the line is high and low.

    Low long enough for a record, even behind the longest scan; on the PLC path, each long enough
    for a scan.
    """
    if path is InputPath.SKIP:
        return random.uniform(200.0, 400.0), random.uniform(3600.0, 4600.0)
    return random.uniform(3000.0, 3500.0), random.uniform(3000.0, 5000.0)
