"""The conditions of a touch, and on which of them a residual depends most."""

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Touches

BINS = 8
FEWEST = 5
"""Touches in a bin."""


@dataclass(frozen=True, slots=True, eq=False)
class Condition:
    """Something recorded that a residual may depend on; `values` has the shape (n,)."""

    title: str
    unit: str
    values: FloatArray
    rotary_unit: str | None = None
    """Of touches by a rotary axis, where that is another one."""

    def of(self, *, is_rotary: bool) -> Self:
        """Give it in the unit of linear or of rotary axes."""
        return replace(self, unit=self.rotary_unit or self.unit) if is_rotary else self

    def select(self, rows: NDArray[np.intp]) -> Self:
        """Give some of the touches."""
        return replace(self, values=self.values[rows])

    @property
    def label(self) -> str:
        """Title and unit, as on an axis."""
        return f"{self.title}, {self.unit}" if self.unit else self.title


def conditions(touches: Touches, stood_in: AbstractSet[str] = frozenset()) -> list[Condition]:
    """Give those that were recorded and that varied; touches in order of time.

    What stands in for columns that were not recorded was not.
    """
    touches = replace(touches, **{name: np.full(len(touches), np.nan) for name in stood_in})
    rest_s = np.diff(touches.time_s, prepend=np.nan)
    every = (
        Condition("feed", "mm/min", touches.feed_mm_min, "deg/min"),
        Condition("direction α", "deg", touches.alpha_deg),
        Condition("sense", "", touches.sign),
        Condition("position", "mm", touches.position_mm, "deg"),
        Condition("rotary angle", "deg", touches.rotary_deg),
        Condition("temperature", "°C", touches.temp_c),
        *(
            Condition(f"temp_{place}_c", "°C", values)
            for place, values in touches.thermometers.items()
        ),
        Condition("time", "s", touches.time_s),
        Condition("rest since the touch before", "s", rest_s),
        Condition("approach", "mm", touches.approach_mm, "deg"),
    )
    return [c for c in every if len(np.unique(c.values[np.isfinite(c.values)])) > 1]


def most_telling(found: Sequence[Condition], residuals: FloatArray, most: int) -> list[Condition]:
    """Give the conditions on which residuals, shape (n,), depend most, the strongest first."""
    scored = [(_dependence(condition.values, residuals), condition) for condition in found]
    known = [pair for pair in scored if np.isfinite(pair[0])]
    return [condition for _, condition in sorted(known, key=lambda pair: -pair[0])[:most]]


def bins_of(values: FloatArray) -> list[NDArray[np.bool_]]:
    """Cut touches into bins of like values: one a value, or equally many touches each."""
    known = np.isfinite(values)
    levels = np.unique(values[known])
    if len(levels) <= BINS:
        masks = [values == level for level in levels]
    else:
        edges = np.unique(np.quantile(values[known], np.linspace(0.0, 1.0, BINS + 1)))
        places = np.clip(np.searchsorted(edges, values, side="right"), 1, len(edges) - 1)
        masks = [known & (places == i) for i in range(1, len(edges))]
    return [mask for mask in masks if mask.sum() >= FEWEST]


def _dependence(values: FloatArray, residuals: FloatArray) -> float:
    """Kruskal and Wallis' statistic over bins, by what chance would make it; NaN if unknown."""
    present = np.isfinite(residuals)
    groups = [residuals[mask & present] for mask in bins_of(values)]
    groups = [group for group in groups if len(group) >= FEWEST]
    if len(groups) < 2 or np.ptp(np.concatenate(groups)) == 0.0:
        return np.nan
    return float(scipy.stats.kruskal(*groups).statistic) / (len(groups) - 1)
