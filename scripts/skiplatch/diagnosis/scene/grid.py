"""Grids of time stamps: how far stamps lie off one, and the period of one with few stamps on it."""

import math

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray

MARGIN = 0.15
"""How far the period may lie from the guess, as a share."""
APART = (1.0 + MARGIN) / (1.0 - MARGIN)
"""Factor between guesses of a period that leave none out between them."""
FIRST = 6
"""Stamps that a first, coarse search looks at."""
FEWEST_STAMPS = 16
"""From which on stamps tell a grid that they keep, or what they scatter by."""
KEPT = 40
"""Times as many periods a search leaves to the next, finer one."""
FEWEST = 2
"""Stamps that do where they are far apart; many periods are left then."""
KEPT_OF_FEW = 180_000
"""So many over the square of the stamps."""
MOST_PERIODS = 1_000_000
"""That one search tries."""
REFINEMENTS = 6
ACCIDENT = 1e-3
"""Chance of stamps anywhere to keep a grid."""
FITTED = 2
"""Stamps that the period and the place of a grid are fitted to."""
SMALLEST = 1e-9
FINER = np.linspace(-1.0, 1.0, 9)
ROUNDS = 6
"""Differences of differences that are taken before the steps of a grid are left."""
ON_GRID = 0.5
"""Mean of stamps as turns of a period, from which on they keep to its grid."""
WRITTEN_US = 1e-3
"""To which stamps are written."""
ROUNDED = 3.0
"""Standard deviations of rounding up to which two values are the same."""
ALIKE = 1.5
"""Times the smallest difference up to which differences are one step."""
SURE = 0.1
"""Of a step, by which the standard deviation of a whole number of steps may leave it open."""
REACH = 0.25
"""Turns over all stamps by which one harmonic may leave the next one off."""
FINEST_HARMONIC = 2**16


def folded(values: FloatArray, period: float) -> FloatArray:
    """Bring values to within half a period of 0 by whole periods."""
    return np.asarray((values + period / 2.0) % period - period / 2.0)


def off_grid(stamps: FloatArray, period: float) -> FloatArray:
    """Give stamps, shape (…, n), off the middle of the grid that each row keeps best; NaN stays.

    The middle is the median, about the mean turn: a few stamps that are off leave the others on it.
    """
    if not stamps.size:
        return stamps
    turn = np.angle(mean_turn(stamps, period)) / (2.0 * np.pi) * period
    off = folded(stamps - turn[..., None], period)
    is_known = ~np.isnan(stamps).all(axis=-1, keepdims=True)
    middle = np.nanmedian(np.where(is_known, off, 0.0), axis=-1)
    return folded(off - middle[..., None], period)


def mean_turn(stamps: FloatArray, period: float) -> NDArray[np.complex128]:
    """Average stamps, shape (…, n), NaN if unknown, as turns of the period; shape (…).

    Its length is 1 for all on one grid, and about 1 over the root of their number for any.
    """
    known = ~np.isnan(stamps)
    turns = np.exp(2j * np.pi * np.where(known, stamps, 0.0) / period) * known
    return np.asarray(turns.sum(axis=-1) / np.maximum(known.sum(axis=-1), 1))


def keep_grid(turn: complex) -> bool:
    """Tell by the mean of stamps as turns of a period whether they lie on its grid."""
    return bool(abs(turn) >= ON_GRID)


def grid_period(stamps: FloatArray, guess: float, first: int = FIRST) -> float:
    """Find the period whose grid holds the stamps best, coarse to fine.

    A few stamps close to each other leave many periods possible; more and more of them, over a
    longer and longer time, leave one. Where even the closest are so far apart that too many periods
    are possible, and where all are within one, the guess is given back.

    Args:
        stamps: Shape (n,), n ≥ first, sorted.
        guess: Roughly the period, in the same unit.
        first: Stamps that the first search looks at, fewer where they are far apart; stamps that
            are rounded to much of a period need more.
    """
    if np.ptp(stamps) < guess:
        return guess
    low, high = 1.0 / (guess * (1.0 + MARGIN)), 1.0 / (guess * (1.0 - MARGIN))
    for count in range(first, FEWEST - 1, -1):
        ordered = _outwards(stamps, count)
        step = 0.25 / max(float(np.ptp(ordered[:count])), guess)
        if high - low <= MOST_PERIODS * step:
            break
    else:
        return guess
    stamps, is_few = ordered, count < FIRST
    frequencies = np.arange(low, high, step)
    agreement = _even_agreement(frequencies, stamps[:count])
    while True:
        kept = max(KEPT * first, KEPT_OF_FEW // count**2 if is_few else 0)
        frequencies = _best(frequencies, agreement, kept)
        if count == len(stamps):
            break
        count = min(2 * count, len(stamps))
        finer = 0.25 / max(float(np.ptp(stamps[:count])), guess)
        around = np.arange(-step, step + finer / 2.0, finer)
        frequencies = frequencies[: max(1, MOST_PERIODS // len(around))]
        agreement = _agreement(frequencies, around, stamps[:count])
        frequencies, first_of = np.unique(frequencies[:, None] + around, return_index=True)
        agreement = agreement.ravel()[first_of]
        step = finer
    best = frequencies[:1]
    for _ in range(REFINEMENTS):
        agreement = _agreement(best, step * FINER, stamps)
        best = _best((best[:, None] + step * FINER).ravel(), agreement.ravel(), kept=1)
        step /= 4.0
    return float(1.0 / best[0])


def kept_grid(stamps: FloatArray, guess: float) -> tuple[float, float] | None:
    """Find the grid that stamps keep by no accident: its period, and where it lies, a share of it.

    None of too few, and where the best of so many periods may well agree with them so well by
    chance: by Rayleigh's test of each, or by how narrow a stretch of the period all of them lie in.

    Args:
        stamps: Shape (n,), sorted.
        guess: Roughly the period, in the same unit.
    """
    if len(stamps) < FEWEST_STAMPS:
        return None
    return _sharpened_if_kept(stamps, grid_period(stamps, guess, FEWEST_STAMPS))


def _sharpened_if_kept(
    stamps: FloatArray, period: float, fine: float = 0.0
) -> tuple[float, float] | None:
    """Tell a grid more closely if stamps, rounded to what is fine, keep it by no accident."""
    turn = mean_turn(stamps, period)
    tries = 1.0 + np.ptp(stamps) * 2.0 * MARGIN / period
    stretch = (2.0 * float(np.abs(off_grid(stamps, period)).max()) + fine) / period
    all_in_it = -(len(stamps) - FITTED) * np.log(max(stretch, SMALLEST))
    if max(len(stamps) * np.abs(turn) ** 2, all_in_it) < np.log(tries / ACCIDENT):
        return None
    return sharpened(stamps, period)


def grid_told(stamps: FloatArray, fine: float, widest: float) -> tuple[float, float] | None:
    """Find the grid of lines apart by more than rounding that stamps keep by no accident.

    No guess is needed: differences of whole steps are whole steps, as are differences of those.
    Taken between neighbours by size they get small soon, until single steps are left. That is
    Euclid's algorithm, on all of the stamps at once; each time adds to what rounding leaves open.

    Args:
        stamps: Shape (n,), sorted.
        fine: What they are rounded to, in the same unit.
        widest: No coarser grid is looked for.

    Returns:
        Its period, and where it lies, a share of it; None for none.
    """
    values, sigma = stamps, fine / math.sqrt(12.0)
    whole, sigmas = [stamps - stamps[:1]], [np.full(len(stamps), math.sqrt(2.0) * sigma)]
    for _ in range(ROUNDS):
        steps = np.diff(np.unique(values))
        sigma *= math.sqrt(2.0)
        values = steps[steps > ROUNDED * sigma]
        if len(values) < FIRST:
            return None
        whole.append(values)
        sigmas.append(np.full(len(values), sigma))
        step = float(np.median(values[values < ALIKE * values.min()]))
        if step < widest:
            period = _grown(np.concatenate(whole), np.concatenate(sigmas), step)
            found = _sharpened_if_kept(stamps, period, fine)
            if found:
                return found
    return None


def _grown(whole: FloatArray, sigmas: FloatArray, step: float) -> float:
    """Tell a step by what is a whole number of it, known to sigmas: by ever longer ones.

    Each tells the step more closely, and so how many of them a longer one is.
    """
    known, before = np.abs(whole) < ALIKE * step, 0
    while known.sum() > before:
        before = int(known.sum())
        counts = np.rint(whole[known] / step)
        weights = counts / sigmas[known] ** 2
        step = float(weights @ whole[known] / (weights @ counts))
        unsure = 1.0 / math.sqrt(float(weights @ counts))
        known |= whole * unsure < SURE * step**2
    return step


def sharpened(stamps: FloatArray, period: float) -> tuple[float, float]:
    """Tell a grid of about this period more closely: its period, and where it lies, a share of it.

    Stamps that keep it agree on its harmonics as well, up to what they scatter by, and those that
    came late, which draw the first turn along, cancel each other there.
    """
    middle = stamps.mean()
    since, span = stamps - middle, float(np.ptp(stamps))
    frequency, harmonic = 1.0 / period, 1
    turn = _turn(since * frequency)
    significant = np.log(len(FINER) / ACCIDENT) / len(stamps)
    while span > period and harmonic < FINEST_HARMONIC:
        step, harmonic = REACH / (harmonic * span), 2 * harmonic
        there = np.array([frequency])
        for _ in range(REFINEMENTS):
            agreement = _agreement(there, step * FINER, harmonic * since)
            there = _best(there + step * FINER, agreement.ravel(), kept=1)
            step /= 4.0
        turns = harmonic * since * there[0]
        if np.abs(mean_turn(turns, 1.0)) ** 2 < significant:
            break
        frequency, finer = float(there[0]), _turn(turns) / harmonic
        turn = finer + round((turn - finer) * harmonic) / harmonic
    return 1.0 / frequency, float((turn + middle * frequency) % 1.0)


def _turn(turns: FloatArray) -> float:
    """Give the middle of turns, shape (n,), as a share of one."""
    return float(np.angle(mean_turn(turns, 1.0))) / (2.0 * np.pi)


def _outwards(stamps: FloatArray, first: int) -> FloatArray:
    """Begin with the stamps that are closest together; the others follow by their distance."""
    spans = stamps[first - 1 :] - stamps[: len(stamps) - first + 1]
    middle = stamps[int(np.argmin(spans)) + first // 2]
    return stamps[np.argsort(np.abs(stamps - middle), kind="stable")]


def _even_agreement(frequencies: FloatArray, stamps: FloatArray) -> FloatArray:
    """Give how well stamps agree on a phase, shape (f,), at evenly spaced frequencies, f > 0."""
    width = math.isqrt(len(frequencies) - 1) + 1
    offsets = frequencies[:width] - frequencies[0]
    return _agreement(frequencies[::width], offsets, stamps).ravel()[: len(frequencies)]


def _agreement(frequencies: FloatArray, offsets: FloatArray, stamps: FloatArray) -> FloatArray:
    """Give how well stamps agree on a phase at each frequency plus each offset; shape (f, o).

    The turns at a sum are products of turns: sines are taken f + o times a stamp, not f · o times.
    """
    since = stamps - stamps[0]
    turns, further = (np.exp(2j * np.pi * np.outer(part, since)) for part in (frequencies, offsets))
    return np.asarray(np.abs(turns @ further.T))


def _best(frequencies: FloatArray, agreement: FloatArray, kept: int) -> FloatArray:
    """Give the frequencies at which stamps agree best on a phase, the best first; shape (kept,)."""
    best = np.argpartition(-agreement, min(kept, len(agreement) - 1))[:kept]
    return np.asarray(frequencies[best[np.argsort(-agreement[best])]])
