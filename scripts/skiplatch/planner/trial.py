"""Play a strategy through the firmware, to see whether it keeps what the model promises."""

from dataclasses import dataclass

import numpy as np

from skiplatch import statistics
from skiplatch.latch.effort import Effort
from skiplatch.planner.model import ROUNDING, Limits, Strategy
from skiplatch.statistics import Interval
from skiplatch.units import UM_PER_MM


@dataclass(frozen=True, slots=True)
class Trial:
    """What came of so many cycles."""

    cycles: int
    range_um: float
    """Greatest minus least measured position."""
    standard_uncertainty_um: Interval
    cycle_s: Interval
    """Mean time of a cycle."""
    overtravel_mm: float
    """The farthest that the probe was driven past the surface in the measuring touch."""
    fast_overtravel_mm: float | None
    """The same in the fast touch before it; None for one touch."""

    def confirms(self, limits: Limits, wanted_um: float) -> bool:
        """Whether all of them were within what was wanted and, to a count, allowed."""
        count_mm = limits.nominal.axis.resolution_um / UM_PER_MM
        is_certain = self.range_um <= wanted_um * ROUNDING
        farthest_mm = max(self.overtravel_mm, self.fast_overtravel_mm or 0.0)
        return is_certain and farthest_mm <= limits.overtravel_mm + count_mm


def try_out(limits: Limits, strategy: Strategy, effort: Effort) -> Trial:
    """Play the strategy.

    Raises:
        SimulationError: A cycle of it failed.
    """
    played = strategy.probing(limits).latched(effort)
    columns = [(o.deviation_um[0], o.overtravel_um[0], o.cycle_s[0]) for o in played]
    deviation_um, overtravel_um, cycle_s = np.concatenate(columns, axis=1)
    return Trial(
        cycles=effort.touches,
        range_um=float(np.ptp(deviation_um)),
        standard_uncertainty_um=statistics.standard_deviation(
            float(deviation_um.std()),
            float(np.mean((deviation_um - deviation_um.mean()) ** 4)),
            effort.touches,
        ),
        cycle_s=statistics.mean(float(cycle_s.mean()), float(cycle_s.std()), effort.touches),
        overtravel_mm=float(np.max(deviation_um + overtravel_um)) / UM_PER_MM,
        fast_overtravel_mm=_fast_overtravel_mm(limits, strategy, effort),
    )


def _fast_overtravel_mm(limits: Limits, strategy: Strategy, effort: Effort) -> float | None:
    """Play the fast touch by itself: it starts as far off, and stops alike."""
    if strategy.fast_feed_mm_min is None:
        return None
    alone = Strategy(measuring_feed_mm_min=strategy.fast_feed_mm_min)
    played = alone.probing(limits).latched(effort)
    return max(float(np.max(o.deviation_um[0] + o.overtravel_um[0])) for o in played) / UM_PER_MM
