"""Which touches serve what: fitting, checking, and the shrink."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray

FOLDS = 4
"""Parts of the touches, each of which judges what the others were fitted to."""


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """Which touches serve what; masks of shape (n,) that do not overlap."""

    fitting: BoolArray
    checking: BoolArray
    shrinking: BoolArray

    @property
    def naming(self) -> BoolArray:
        """Fitting and checking together."""
        return self.fitting | self.checking


def split(touches: int, seed: int) -> Split:
    """Draw half of the touches for fitting, a fifth for checking, the rest for the shrink."""
    lot = np.random.default_rng(seed).permutation(touches) / touches
    return Split(lot < 0.5, (lot >= 0.5) & (lot < 0.7), lot >= 0.7)


def folds(touches: int, seed: int) -> NDArray[np.intp]:
    """Draw which of a few folds each touch belongs to; shape (n,)."""
    return np.random.default_rng(seed).permutation(touches) % FOLDS
