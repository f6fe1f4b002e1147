"""Parameters sampled from the likelihood with weights: what each may be, all others free."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.fit.surface import A_STEP, Surface

LONGEST = 1e6  # steps along a ridge
DEGREES_OF_FREEDOM = 5  # of the sampled distribution, whose tails reach beyond those sought
ACROSS = 2e-9
"""Share of the largest variance by which every parameter varies at least, whatever others do: some
ten times what scipy takes for 0, by the largest eigenvalue."""
ROUNDS = (60, 60, 60, 240)
MORE_ROUNDS = 4
"""Of the size of the last one, at most, until enough samples count."""
ENOUGH = 60.0
BATCHES, BATCH = 50, 20
"""Tries, and draws a sample in each, to find samples within all ranges."""
FEW = 3
"""Parameters that as many samples are enough for; for more they are multiplied."""
LEAST_SAMPLES = 4.0  # a parameter, that have to count in effect
TEMPERS = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)
INFLATION = 1.5
RIDGE = 1e-8  # of all variances, so that no direction is quite without one
OFF_THE_TOP = 1.0  # nats that the mean may lie below the peak
SEED = 1


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Points of parameters that were sampled, and how much each counts."""

    points: FloatArray
    """Shape (m, p)."""
    weights: FloatArray
    """Sum to 1; shape (m,)."""
    sampled: frozenset[int]
    """Columns that differ from point to point."""


def sampled(
    surface: Surface, free: IndexArray, steps: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, Cloud]:
    """Sample the free parameters, nearer to the likelihood each time.

    Gives values, what each may be from and to, of shape (p,), and the last points.
    """
    values, lower, higher = surface.values.copy(), surface.values.copy(), surface.values.copy()
    if not len(free):
        return values, lower, higher, Cloud(values[np.newaxis], np.ones(1), frozenset())
    rng = np.random.default_rng(SEED)
    slots = [surface.slots[i] for i in free]
    low, high = ((end - surface.values)[free] / steps for end in (surface.low, surface.high))

    def are_within(points: FloatArray) -> BoolArray:
        return np.asarray(np.all((points >= low) & (points <= high), axis=1))

    middle = np.zeros(len(free))
    spread = _covariance(surface, free, steps)
    points, weights = np.zeros((1, len(free))), np.ones(1)
    more = int(np.ceil(len(free) / FEW))
    for i, count in enumerate(ROUNDS + MORE_ROUNDS * ROUNDS[-1:]):
        if i >= len(ROUNDS) and _counting(weights) >= ENOUGH:
            break
        size = more * count
        proposal = scipy.stats.multivariate_t(middle, _firm(spread), DEGREES_OF_FREEDOM, seed=rng)
        drawn = _drawn(proposal.rvs, size, are_within)
        if not len(drawn):
            break
        points = drawn
        moved = np.tile(surface.values, (len(points), 1))
        moved[:, free] += steps * points
        heights = surface.at_each(moved)
        logs = heights - surface.peak - proposal.logpdf(points).reshape(len(points))
        weights = _weights(logs)
        calm = _weights(logs, LEAST_SAMPLES * (1 + len(free)))
        middle = calm @ points
        spread = _spread(points, calm)
    best = weights @ points  # on a plateau the middle is nearer to the truth than any peak
    if surface.peak - surface.along(free, steps * best) > OFF_THE_TOP:
        best = np.zeros(len(free))
    shares = np.array([slot.shares for slot in slots])
    first, last = (_quantiles(points, weights, share) for share in shares.T)
    values[free] += steps * best
    lower[free] += steps * np.minimum(first, best)
    higher[free] += steps * np.maximum(last, best)
    moved = np.tile(surface.values, (len(points), 1))
    moved[:, free] += steps * points
    return values, lower, higher, Cloud(moved, weights, frozenset(free.tolist()))


def _drawn(
    draw: Callable[[int], FloatArray], size: int, are_within: Callable[[FloatArray], BoolArray]
) -> FloatArray:
    """Draw points within all ranges, shape (size, p), or fewer where there are next to none."""
    tried = (draw(BATCH * size).reshape(BATCH * size, -1) for _ in range(BATCHES))
    kept: list[FloatArray] = []
    while sum(map(len, kept)) < size and (points := next(tried, None)) is not None:
        kept.append(points[are_within(points)])
    return np.vstack(kept)[:size]


def _firm(spread: FloatArray) -> FloatArray:
    """Leave some variance across a ridge along which parameters make up for each other.

    A range may be a hundred thousand times as long as a parameter is known to beside the others.
    """
    return spread + ACROSS * float(np.diag(spread).max()) * np.eye(len(spread))


def _spread(points: FloatArray, weights: FloatArray) -> FloatArray:
    """Give the covariance for the next samples, somewhat larger than of these; shape (p, p)."""
    count = points.shape[1]
    spread = INFLATION * np.cov(points.T, aweights=weights, ddof=0).reshape(count, count)
    return np.asarray(spread + RIDGE * max(1.0, float(np.trace(spread))) * np.eye(count))


def _counting(weights: FloatArray) -> float:
    """Give how many samples count in effect."""
    return 1.0 / float(np.sum(weights**2))


def _covariance(surface: Surface, free: IndexArray, steps: FloatArray) -> FloatArray:
    """Give a first guess, in units of the steps: how far each parameter goes, and pairs together.

    Where one parameter makes up for another, a step of the one undoes a step of the other, and the
    likelihood may be level for many of both.
    """
    units = np.eye(len(free))
    moves = [one + sense * other for one, other in combinations(units, 2) for sense in (1.0, -1.0)]
    parts = [np.outer(move, move) * _stretch(surface, free, steps * move) ** 2 for move in moves]
    return np.asarray(sum(parts, units))


def _stretch(surface: Surface, free: IndexArray, moved: FloatArray) -> float:
    """Give how often parameters may be moved before that is worth `A_STEP`: a power of 2, or 0."""

    def fall(times: float) -> float:
        return surface.peak - max(surface.along(free, sense * times * moved) for sense in (-1, 1))

    times = 1.0
    while times < LONGEST and fall(times) < A_STEP:
        times *= 2.0
    return times / 2.0 if times > 1.0 else 0.0


def _weights(logs: FloatArray, least: float = 0.0) -> FloatArray:
    """Normalise weights, evened out until so many of them count."""
    weights = np.ones_like(logs)
    for temper in TEMPERS:
        weights = np.exp(temper * (logs - logs.max()))
        weights /= weights.sum()
        if _counting(weights) >= least:
            break
    return weights


def _quantiles(points: FloatArray, weights: FloatArray, shares: FloatArray) -> FloatArray:
    """Give a weighted quantile of each column; shape (p,)."""
    return np.array(
        [
            np.quantile(column, share, weights=weights, method="inverted_cdf")
            for column, share in zip(points.T, shares, strict=True)
        ]
    )
