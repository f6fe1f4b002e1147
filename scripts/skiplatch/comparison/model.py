"""What a comparison consists of."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath
from skiplatch.comparison.observables import Observable
from skiplatch.statistics import Interval

DEFAULT_ALPHA = 0.01


def feed_words(feed_mm_min: float, *, is_known: bool, unit: str = "mm/min") -> str:
    """Name a feed, or say that nobody recorded it."""
    return f"{feed_mm_min:g} {unit}" if is_known else "feed not recorded"


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """The touches of one path and feed in which an observable was recorded."""

    observable: Observable
    path: InputPath
    feed_mm_min: float
    rows: NDArray[np.intp]
    """Which touches of the campaign; shape (n,)."""
    recorded: FloatArray
    """Residuals, shape (n,)."""
    reference: FloatArray
    """Residuals of the simulation, shape (r, n)."""
    expected: FloatArray
    """Mean of the simulated values of each touch, shape (n,)."""
    is_feed_known: bool = True
    """Whether the feed was recorded, or merely stands in."""


@dataclass(frozen=True, slots=True)
class CellGap:
    """Recorded against simulated in one cell, in the observable's unit."""

    observable: Observable
    path: InputPath
    feed_mm_min: float
    """Of a rotary axis deg/min, as in touches.csv."""
    is_feed_known: bool
    touches: int
    recorded_mean: float
    simulated_mean: float
    recorded_spread: float
    """Standard deviation of what the conditions do not explain, as for `simulated_spread`."""
    simulated_spread: float
    mean_difference: Interval
    spread_difference: Interval
    distance: float
    """Wasserstein distance of the recorded touches from the simulation."""
    noise_floor: float
    """The same for replicates of the simulation: one in twenty lies beyond."""
    p_value: float
    """Corrected for the number of cells."""

    @property
    def feed_words(self) -> str:
        """Name the feed, or say that nobody recorded it."""
        return feed_words(
            self.feed_mm_min, is_known=self.is_feed_known, unit=self.observable.feed_unit
        )


@dataclass(frozen=True, slots=True)
class Missed:
    """Touches of a path that were not latched; the nominal simulation misses none."""

    path: InputPath
    missed: int
    touches: int
    share: Interval


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """The whole of it."""

    cells: Sequence[Cell]
    gaps: Sequence[CellGap]
    """One for each cell."""
    missed: Sequence[Missed]
    replicates: int
    alpha: float
    """Accepted rate of false alarms over all cells together."""
    is_datum_free: bool
    """Nobody knows where the surfaces are; the simulation has them where they are believed."""

    def of(self, observable: Observable) -> list[tuple[Cell, CellGap]]:
        """Give the cells of an observable, each with its gap."""
        pairs = zip(self.cells, self.gaps, strict=True)
        return [(cell, gap) for cell, gap in pairs if cell.observable is observable]

    @property
    def differing(self) -> Sequence[CellGap]:
        """The cells that differ by more than chance."""
        return [gap for gap in self.gaps if gap.p_value <= self.alpha]

    @property
    def agrees(self) -> bool:
        """Whether there was something to compare, and nothing was found beyond the noise."""
        missed = any(missed.missed for missed in self.missed)
        return bool(self.gaps) and not self.differing and not missed
