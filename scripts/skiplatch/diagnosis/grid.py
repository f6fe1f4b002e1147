"""The period of a grid of time stamps that are many periods apart."""

import numpy as np

from skiplatch.diagnosis.law import FloatArray

MARGIN = 0.15
"""How far the period may lie from the guess, as a share."""
FIRST = 6
"""Stamps that a first, coarse search looks at."""
KEPT = 200
FINER = np.linspace(-1.0, 1.0, 9)


def grid_period(stamps: FloatArray, guess: float) -> float:
    """Find the period whose grid holds the stamps best, coarse to fine.

    A few stamps close to each other leave many periods possible; more and more of them, over a
    longer and longer time, leave one.

    Args:
        stamps: Shape (n,), n ≥ FIRST, sorted.
        guess: Roughly the period, in the same unit.
    """
    count = FIRST
    span = float(np.ptp(stamps[:count]))
    step = 0.25 / span
    low, high = 1.0 / (guess * (1.0 + MARGIN)), 1.0 / (guess * (1.0 - MARGIN))
    frequencies = np.arange(low, high, step)
    while True:
        frequencies = _best(frequencies, stamps[:count])
        if count == len(stamps):
            break
        count = min(2 * count, len(stamps))
        finer = 0.25 / float(np.ptp(stamps[:count]))
        around = np.arange(-step, step + finer / 2.0, finer)
        frequencies = np.unique((frequencies[:, None] + around).ravel())
        step = finer
    for _ in range(FIRST):
        frequencies = _best((frequencies[:1, None] + step * FINER).ravel(), stamps)
        step /= 4.0
    return float(1.0 / frequencies[0])


def _best(frequencies: FloatArray, stamps: FloatArray) -> FloatArray:
    """Give the frequencies at which the stamps agree best on a phase, the best first."""
    since = stamps - stamps[0]
    turns = np.exp(2j * np.pi * np.outer(frequencies, since))
    order = np.argsort(-np.abs(turns.sum(axis=1)))[:KEPT]
    return np.asarray(frequencies[order])
