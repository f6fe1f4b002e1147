"""An experiment tried out in simulation: how far it tells models apart."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray

SURE = 0.95
FEWEST = 5
"""Touches that are needed at least, lest a single odd one decide."""
MARGIN = 0.02
"""For the noise of the estimate: so much surer than `SURE` a number of touches must make."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """What became of simulated experiments whose truth is known.

    Attributes:
        groups: For each of m models, the number of the group that is told apart from the others;
            shape (m,).
        touches_needed: After how many touches the group is right with a probability of `SURE`,
            whichever model is true; None if there is one group.
        bits: Expected information on the model in all touches, in all at most log2(m).
        bits_per_touch: The mean of that of each touch alone.
    """

    groups: NDArray[np.intp]
    touches_needed: int | None
    bits: float
    bits_per_touch: float

    @classmethod
    def of(cls, log_likelihoods: FloatArray, groups: NDArray[np.intp]) -> Self:
        """Judge r experiments of n touches by each of m models; shape (m, m, r, n).

        The first index is the model that judges, the second the one that is true.
        """
        so_far = np.cumsum(log_likelihoods, axis=3)
        per_touch = float(_bits(log_likelihoods).mean())
        return cls(
            groups=groups,
            touches_needed=_needed(so_far, groups),
            # All touches tell no less than one of them, which the bound of the sum may not show.
            bits=max(float(_bits(so_far[..., -1:])[0]), per_touch),
            bits_per_touch=per_touch,
        )

    @property
    def count(self) -> int:
        """Number of groups."""
        return int(self.groups.max()) + 1


def _needed(so_far: FloatArray, groups: NDArray[np.intp]) -> int | None:
    if not groups.any():
        return None
    right = np.min([_right(so_far, groups, truth) for truth in range(len(groups))], axis=0)
    unsure = np.flatnonzero(right < SURE + MARGIN)
    needed = int(unsure[-1]) + 2 if unsure.size else 1
    return int(np.clip(needed, min(FEWEST, so_far.shape[3]), so_far.shape[3]))


def _right(so_far: FloatArray, groups: NDArray[np.intp], truth: int) -> FloatArray:
    """How often the group of the truth leads after each touch; shape (n,)."""
    own = groups == groups[truth]
    lead = so_far[own, truth].max(axis=0) - so_far[~own, truth].max(axis=0)
    return np.asarray((lead > 0.0).mean(axis=0))


def _bits(log_likelihoods: FloatArray) -> FloatArray:
    """Give the expected information on the model, shape (n,), of shape (m, m, r, n).

    A lower bound, since the densities are estimates: log2(m) plus the mean of the logarithm that
    the truth is left with.
    """
    models = np.arange(len(log_likelihoods))
    left = scipy.special.log_softmax(log_likelihoods, axis=0)[models, models]
    gained = (np.log(len(models)) + left.mean(axis=(0, 1))) / np.log(2.0)
    return np.asarray(np.maximum(gained, 0.0))
