"""Climbing to the most likely parameters from a start, where that promises anything."""

from typing import Protocol

import numpy as np
from scipy import optimize

from skiplatch.arrays import FloatArray

WORST = 1e300
STEP = 0.3
"""First step, as a share of the parameters, where it is not said."""
EVALUATIONS = 60  # a parameter
COARSE_EVALUATIONS = 25
CLOSE, COARSELY_CLOSE = 0.01, 0.1
"""Of its first step, by which a climb's last points may differ, if they are as likely."""
NATS, COARSE_NATS = 0.02, 0.2
"""By which the likelihoods of a climb's last points may differ."""
SLOPE_OVER = 0.003
"""Share of a parameter over which its slope is taken."""


class Target(Protocol):
    """What is climbed."""

    def by_touch(self, values: FloatArray, widening: float) -> FloatArray:
        """Give the log-likelihood of each of n touches, in nats, shape (n,)."""

    def __call__(self, values: FloatArray, widening: float) -> float:
        """Give minus their sum."""


def climb(target: Target, start: FloatArray, widening: float, step: float = STEP) -> FloatArray:
    """Climb from a start, in shares of its parameters; what is 0 in it stays so.

    Args:
        target: To be made least.
        start: Shape (p,).
        widening: Of the target.
        step: The first one, as a share of the parameters.
    """
    if _promise(target, start, widening) < NATS:
        return start
    free, is_fine = np.flatnonzero(start), widening == 0.0
    ones = np.ones(len(free))

    def whole(shares: FloatArray) -> FloatArray:
        point = start.copy()
        point[free] *= shares
        return point

    def minus(shares: FloatArray) -> float:
        return target(whole(shares), widening)

    found = optimize.minimize(
        minus,
        ones,
        method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([ones, ones + step * np.eye(len(free))]),
            "maxfev": (EVALUATIONS if is_fine else COARSE_EVALUATIONS) * len(free),
            "xatol": step * (CLOSE if is_fine else COARSELY_CLOSE),
            "fatol": NATS if is_fine else COARSE_NATS,
        },
    )
    return whole(found.x)


def _promise(target: Target, start: FloatArray, widening: float) -> float:
    """Give the nats that a climb gains, as far as the touches' slopes at its start can tell.

    It is half of the score statistic (Rao), with the curvature that the slopes of single touches
    tell (Berndt, Hall, Hall and Hausman, Annals of Economic and Social Measurement 3 (1974) 653).
    Parameters that change nothing there tell nothing; where none does, any gain is open.
    """
    here = target.by_touch(start, widening)
    steps = SLOPE_OVER * np.diag(start)[np.flatnonzero(start)]
    there = np.array([target.by_touch(start + step, widening) for step in steps])
    slopes = np.nan_to_num((there - here).T / SLOPE_OVER)
    slopes = slopes[:, slopes.any(axis=0)]
    if not slopes.size:
        return np.inf
    slope = slopes.sum(axis=0)
    return float(slope @ np.linalg.pinv(slopes.T @ slopes) @ slope) / 2.0
