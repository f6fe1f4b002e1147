"""Climbing to the most likely parameters from a start."""

from collections.abc import Callable

import numpy as np
import scipy

from skiplatch.arrays import FloatArray

Target = Callable[[FloatArray, float], float]
"""Gives minus the log-likelihood of parameters, in nats, with a widening of the laws."""
WORST = 1e300
STEP = 0.3
"""First step, as a share of the parameters, where it is not said."""
EVALUATIONS = 60  # a parameter
COARSE_EVALUATIONS = 25
CLOSE, COARSELY_CLOSE = 0.01, 0.1
"""Of its first step, by which a climb's last points may differ, if they are as likely."""
NATS, COARSE_NATS = 0.02, 0.2
"""By which the likelihoods of a climb's last points may differ."""


def climb(target: Target, start: FloatArray, widening: float, step: float = STEP) -> FloatArray:
    """Climb from a start, in shares of its parameters; what is 0 in it stays so.

    Args:
        target: To be made least.
        start: Shape (p,).
        widening: Of the target.
        step: The first one, as a share of the parameters.
    """
    free, is_fine = np.flatnonzero(start), widening == 0.0
    ones = np.ones(len(free))

    def whole(shares: FloatArray) -> FloatArray:
        point = start.copy()
        point[free] *= shares
        return point

    def minus(shares: FloatArray) -> float:
        return target(whole(shares), widening)

    found = scipy.optimize.minimize(
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
