"""The grid that recorded numbers lie on, where it is coarser than what they are rounded to."""

import math
from collections.abc import Sequence
from itertools import islice, pairwise

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.scene.grid import FIRST, grid_period
from skiplatch.statistics import errors_of

MANY_STEPS = 1.5
"""Fine steps from which on a coarser one is a news."""
MOST_OFF = 0.02
"""Share of the numbers that may lie off."""
A_PART = 8
"""Numbers whose common divisor is a pitch, if none of them lies off."""
PARTS_OF_A_PITCH = range(1, 10)
"""What the coarsest pitch is divided by: few numbers may lie on twice the true one."""
MOST_PITCHES = 3
NEAREST = 0.501
"""Fine steps within which a number lies on a line."""


def whole_pitches(values: FloatArray, fine: float) -> Sequence[float]:
    """Give the coarsest pitches, of whole numbers of fine steps, whose grid holds nearly all.

    They are the coarsest and large parts of it. Two fine steps, if none does.
    """
    steps = np.rint(values[~np.isnan(values)] / fine).astype(np.int64)
    parts = np.array_split(steps, max(len(steps) // A_PART, 1))
    # Numbers that lie off spoil the parts that they are in.
    divisors = [int(np.gcd.reduce(part)) for part in parts if len(part)]
    divisors += [math.gcd(*pair) for pair in pairwise(divisors)]
    kept = [k for k in {*divisors, 2} if k > 1 and _holds(k, steps)]
    coarsest = max(kept, default=2)
    wholes = (coarsest // k for k in PARTS_OF_A_PITCH if coarsest % k == 0 and coarsest > k)
    return [k * fine for k in sorted(islice(wholes, MOST_PITCHES))]


def _holds(pitch: int, steps: NDArray[np.int64]) -> bool:
    return int(np.count_nonzero(steps % pitch)) < max(MOST_OFF * len(steps), 1.0)


def odd_pitch(values: FloatArray, fine: float) -> list[float]:
    """Give the pitch, of no whole number of fine steps, whose grid holds all; none for none."""
    sizes = np.unique(np.abs(values[~np.isnan(values)]))
    both_ways = np.unique([-sizes, sizes])  # a line of the grid is at 0
    gaps = np.diff(sizes)
    gaps = gaps[gaps > 0.5 * fine]
    if len(both_ways) < FIRST or not len(gaps) or gaps.min() < MANY_STEPS * fine:
        return []
    pitch = grid_period(both_ways, float(gaps.min()))
    off = np.abs(sizes - np.rint(sizes / pitch) * pitch)
    return [pitch] if np.all(off < fine) else []


def is_on_grid(values: FloatArray, pitch: float, fine: float) -> bool:
    """Tell whether nearly all numbers lie within rounding on a grid with a line at 0."""
    off = np.abs(values - np.rint(values / pitch) * pitch)
    return float(np.mean(off <= NEAREST * fine)) >= 1.0 - MOST_OFF


def kept_pitch(values: FloatArray, fine: float) -> tuple[float, float] | None:
    """Give the coarsest pitch that numbers keep, and how many standard errors that is from luck.

    None where they keep no grid but that of the fine steps.

    Args:
        values: Shape (n,).
        fine: What they are believed to be rounded to.
    """
    known = values[~np.isnan(values)]
    different = np.unique(np.rint(known / fine))
    if len(different) < FIRST:
        return None
    pitch = max([*whole_pitches(known, fine), *odd_pitch(known, fine)])
    if pitch <= MANY_STEPS * fine or not is_on_grid(known, pitch, fine):
        return None
    # Any pitch up to this one may have come about so.
    log_chance = (1.0 - len(different)) * np.log(pitch / fine)
    return pitch, errors_of(float(np.exp(min(log_chance, 0.0))))
