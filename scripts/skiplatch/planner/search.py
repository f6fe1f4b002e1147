"""Find the fastest strategy that is certain enough, or what stands in its way."""

from collections.abc import Callable
from dataclasses import dataclass

import scipy

from skiplatch.planner.model import (
    Limits,
    Strategy,
    back_off_mm,
    cycle_s,
    fast_feed_for_stand_off,
    feed_for_range,
    measuring_feed_for_stand_off,
    ramp_feed_mm_min,
    safe_feed_mm_min,
)
from skiplatch.planner.obstacles import Obstacle, two_touch_obstacle, unreachable
from skiplatch.planner.rounding import rounded_down, rounded_up


@dataclass(frozen=True, slots=True)
class Findings:
    """The fastest strategy of each kind, or what forbids it."""

    one: Strategy | Obstacle
    two: Strategy | Obstacle

    def best(self, limits: Limits) -> Strategy | None:
        """Give the faster one of those that are allowed."""
        allowed = [found for found in (self.one, self.two) if isinstance(found, Strategy)]
        return min(allowed, key=lambda strategy: cycle_s(limits, strategy), default=None)


def find_plan(limits: Limits, wanted_um: float) -> Findings:
    """Find the fastest strategies whose full range is no greater than wanted."""
    obstacle = unreachable(limits, wanted_um)
    if obstacle is not None:
        return Findings(obstacle, obstacle)
    return Findings(
        _one_touch(limits, wanted_um),
        two_touch_obstacle(limits) or _two_touches(limits, wanted_um),
    )


def _greatest_feed(limits: Limits) -> float:
    """Give the feed at which the axis reaches its speed before the surface and stops in time."""
    return min(limits.greatest_feed_mm_min, safe_feed_mm_min(limits), ramp_feed_mm_min(limits))


def _one_touch(limits: Limits, wanted_um: float) -> Strategy:
    def time_s(feed: float) -> float:
        return cycle_s(limits, Strategy(measuring_feed_mm_min=feed))

    least = limits.least_feed_mm_min
    greatest = min(_greatest_feed(limits), feed_for_range(limits, wanted_um))
    return Strategy(measuring_feed_mm_min=_programmed(_fastest(time_s, least, greatest), least))


def _two_touches(limits: Limits, wanted_um: float) -> Strategy:
    least = limits.least_feed_mm_min
    certain_enough = feed_for_range(limits, wanted_um)

    def best_measuring(fast: float) -> float:
        room = measuring_feed_for_stand_off(limits, fast)
        return _fastest(
            lambda measuring: cycle_s(limits, with_back_off(limits, fast, measuring)),
            least,
            min(fast, certain_enough, room),
        )

    def time_s(fast: float) -> float:
        return cycle_s(limits, with_back_off(limits, fast, best_measuring(fast)))

    greatest = min(_greatest_feed(limits), fast_feed_for_stand_off(limits))
    fast = _fastest(time_s, least, greatest)
    measuring = best_measuring(fast)
    return with_back_off(limits, _programmed(fast, least), _programmed(measuring, least))


def with_back_off(limits: Limits, fast: float, measuring: float) -> Strategy:
    """Give the two touches at these feeds, with as short a back-off as will do."""
    return Strategy(
        measuring_feed_mm_min=measuring,
        fast_feed_mm_min=fast,
        back_off_mm=rounded_up(back_off_mm(limits, fast, measuring)),
    )


def _fastest(time_s: Callable[[float], float], low: float, high: float) -> float:
    """Give the feed with the shortest cycle.

    The cycle time falls with the feed, and may rise again because of the ramps: there is one
    minimum, at an end or between.
    """
    high = max(low, high)  # they may be equal but for rounding
    inner = scipy.optimize.minimize_scalar(time_s, bounds=(low, high), method="bounded").x
    return min(low, float(inner), high, key=time_s)


def _programmed(feed: float, least: float) -> float:
    """Give the feed as an operator programs it, no faster."""
    return max(rounded_down(feed), least)
