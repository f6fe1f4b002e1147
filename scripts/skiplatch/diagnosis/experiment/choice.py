"""Choosing among touches that could be made."""

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray

LEAST = 0.01
"""Exponent of the best touch below which a pair of models counts as the same, in nats."""
REPETITION = 0.25
"""How much less each repetition says: what is uncertain of the rivals' parameters stays."""


def choose(exponents: FloatArray, count: int) -> NDArray[np.intp]:
    """Pick touches, the most telling first, such that no pair of models is left mistaken.

    Greedy on the bound of the error, the sum over pairs of exp(-total exponent).

    Args:
        exponents: Of each pair of models in each touch; shape (pairs, n).
        count: How many to pick; a touch may be picked again.
    """
    useful = exponents[exponents.max(axis=1) > LEAST]
    if not useful.size:
        return np.asarray(np.arange(count) % exponents.shape[1])
    total = np.zeros(len(useful))
    times = np.zeros(exponents.shape[1])
    picked = []
    for _ in range(count):
        says = useful / (1.0 + REPETITION * times)
        open_still = np.exp(total.min() - total)
        best = int(np.argmax(open_still @ -np.expm1(-says)))
        total += says[:, best]
        times[best] += 1.0
        picked.append(best)
    return np.array(picked, dtype=np.intp)
