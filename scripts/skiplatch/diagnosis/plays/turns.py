"""Touches that come every so many, as if something happened at each of them.

A wave of so short a period has but part of what such pulses have, and a forest does not count.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.statistics import errors_of

FEWEST = 5
"""Touches that come every so many, from which on they are held against the others."""
MOST_APART = 30
"""Touches from one of them to the next, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """The touches of a turn that differ most from the others.

    Attributes:
        apart: From one of them to the next, in touches.
        rows: Which they are; shape (m,).
        z: How many standard errors they are off, for the best of all turns that were tried: its
            chance is at most the sum of theirs (Bonferroni).
    """

    apart: int
    rows: BoolArray
    z: float


def in_turn(serial: IndexArray, scores: FloatArray) -> Turn | None:
    """Find the turn whose scores differ most from the others, each by Student's law.

    Args:
        serial: Numbers of the touches, shape (m,), from 0.
        scores: Normal ones, shape (m,).
    """
    off, m = scores - scores.mean(), len(scores)
    if np.ptp(scores) == 0.0:  # the mean of what is all the same may be rounded
        return None
    turns = _counted(serial, off)
    _, _, count, total = turns
    explained = np.minimum(total**2 / (count * (1.0 - count / m) * float(off @ off)), 1.0)
    return _best(serial, turns, np.asarray(scipy.stats.beta.sf(explained, 0.5, 0.5 * (m - 2.0))))


def happens_in_turn(serial: IndexArray, happened: BoolArray) -> Turn | None:
    """Find the turn to which it happened most, each by the law of draws without putting back.

    Args:
        serial: Numbers of the touches, shape (m,), from 0.
        happened: To which it did; shape (m,).
    """
    turns = _counted(serial, happened.astype(float))
    _, _, count, met = turns
    chance = scipy.stats.hypergeom.sf(met - 1.0, len(serial), happened.sum(), count)
    return _best(serial, turns, np.asarray(chance))


def _counted(serial: IndexArray, values: FloatArray) -> FloatArray:
    """Count the turns: touches apart, first number, touches, and sum of values; shape (4, t)."""
    m, found = len(serial), [np.empty((4, 0))]
    for apart in range(2, min(m // FEWEST, MOST_APART) + 1):
        turn = serial % apart
        count, total = np.bincount(turn), np.bincount(turn, values)
        first = np.flatnonzero((count >= FEWEST) & (count <= m - FEWEST))
        found.append(np.array([np.full(len(first), apart), first, count[first], total[first]]))
    return np.hstack(found)


def _best(serial: IndexArray, turns: FloatArray, chance: FloatArray) -> Turn | None:
    if not len(chance):
        return None
    best = int(np.argmin(chance))
    apart, first = int(turns[0, best]), int(turns[1, best])
    z = errors_of(min(1.0, len(chance) * float(chance[best])))
    return Turn(apart, serial % apart == first, z)
