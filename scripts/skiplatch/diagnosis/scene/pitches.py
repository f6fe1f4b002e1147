"""The grid that recorded numbers lie on, where it is coarser than what they are rounded to."""

from collections.abc import Sequence

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.scene.grid import FIRST, grid_period
from skiplatch.statistics import errors_of

MANY_STEPS = 1.5
"""Fine steps from which on a coarser one is a news."""
MOST_STEPS = 4096
"""Fine steps of the coarsest grid that is looked for."""
MOST_OFF = 0.02
"""Share of the numbers that may lie off."""
FEW = 32
"""Numbers, beyond those that may lie off, that a pitch is first tried on."""
NEAREST = 0.501
"""Fine steps within which a number lies on a line."""


def whole_pitches(values: FloatArray, fine: float) -> Sequence[float]:
    """Give the coarsest pitches, of whole numbers of fine steps, whose grid holds nearly all.

    Two fine steps, if none does.
    """
    steps = np.rint(values[~np.isnan(values)] / fine).astype(np.int64)
    if not len(steps):
        return [2.0 * fine]
    most_off = MOST_OFF * len(steps)
    # A few numbers rule out nearly all pitches: more of them lie off than may of all.
    few = steps[: int(most_off) + FEW, None]
    ways = np.arange(2, MOST_STEPS + 1)
    ways = ways[np.count_nonzero(few % ways, axis=0) < most_off]
    kept = [k for k in ways.tolist() if np.count_nonzero(steps % k) < most_off]
    return [k * fine for k in (kept or [2])[-3:]]


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
    log_chance = np.log(MOST_STEPS) - len(different) * np.log(pitch / fine)
    return pitch, errors_of(float(np.exp(min(log_chance, 0.0))))
