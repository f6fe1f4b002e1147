"""How much is simulated."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np


@dataclass(frozen=True, slots=True)
class Effort:
    """How many touches a figure is simulated from, with which random numbers and threads."""

    touches: int
    seed: int
    jobs: int = 1

    def at_most(self, touches: int) -> Self:
        """Give no more touches than that."""
        return replace(self, touches=min(self.touches, touches))

    def split(self, count: int) -> list[Self]:
        """Give so many that are independent of each other."""
        seeds = np.random.SeedSequence(self.seed).generate_state(count)
        return [replace(self, seed=int(seed)) for seed in seeds]
