"""Which limit forbids a strategy, and what would do."""

from dataclasses import dataclass

from skiplatch.planner.model import (
    ROUNDING,
    Limits,
    back_off_mm,
    feed_for_range,
    overtravel_mm,
    ramp_feed_mm_min,
    range_um,
    safe_feed_mm_min,
    speed,
)
from skiplatch.planner.rounding import rounded_down, rounded_up


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A limit that forbids a strategy, and what would have to be otherwise."""

    limit: str
    message: str
    remedy: str


def unreachable(limits: Limits, wanted_um: float) -> Obstacle | None:
    """Look for what forbids even the slowest measuring touch."""
    least = limits.least_feed_mm_min
    if wanted_um * ROUNDING < range_um(limits, least):
        return _resolution(limits, wanted_um) or _least_feed(limits, wanted_um)
    if safe_feed_mm_min(limits) < least:
        return _overtravel(limits)
    if ramp_feed_mm_min(limits) < least:
        return _ramp(limits)
    return None


def two_touch_obstacle(limits: Limits) -> Obstacle | None:
    """Look for what forbids to back off between two touches."""
    least = limits.least_feed_mm_min
    needed_mm = back_off_mm(limits, least, least)
    if needed_mm <= limits.stand_off_mm:
        return None
    return Obstacle(
        "stand-off",
        f"two touches need a back-off of {rounded_up(needed_mm):g} mm even at the least feed, "
        f"more than the stand-off of {limits.stand_off_mm:g} mm",
        f"a stand-off of {rounded_up(needed_mm):g} mm",
    )


def _resolution(limits: Limits, wanted_um: float) -> Obstacle | None:
    resolution_um = limits.nominal.axis.resolution_um
    if wanted_um > resolution_um:
        return None
    return Obstacle(
        "resolution",
        f"the axis resolves {resolution_um:g} µm, no feed gives a range of {wanted_um:g} µm",
        f"an axis that resolves less than {wanted_um:g} µm",
    )


def _least_feed(limits: Limits, wanted_um: float) -> Obstacle:
    least = limits.least_feed_mm_min
    feed = feed_for_range(limits, wanted_um)
    width_us = limits.input.width_us * feed / least
    return Obstacle(
        "least feed",
        f"a range of {wanted_um:g} µm needs a measuring feed of {rounded_down(feed):g} mm/min, "
        f"below the least feed of {least:g} mm/min",
        f"that feed, an input whose reaction varies by {rounded_down(width_us):g} µs and not by "
        f"{limits.input.width_us:g} µs, or a range of "
        f"{rounded_up(range_um(limits, least)):g} µm",
    )


def _overtravel(limits: Limits) -> Obstacle:
    least = limits.least_feed_mm_min
    needed_mm = rounded_up(overtravel_mm(limits, least))
    return Obstacle(
        "overtravel",
        f"at the least feed of {least:g} mm/min the probe overtravels by up to {needed_mm:g} mm, "
        f"more than the allowed {limits.overtravel_mm:g} mm",
        f"an overtravel of {needed_mm:g} mm, or a least feed of "
        f"{rounded_down(safe_feed_mm_min(limits)):g} mm/min",
    )


def _ramp(limits: Limits) -> Obstacle:
    least = limits.least_feed_mm_min
    needed_mm = rounded_up(speed(least) ** 2 / (2.0 * limits.accel_mm_s2))
    return Obstacle(
        "stand-off",
        f"within a stand-off of {limits.stand_off_mm:g} mm the axis does not reach the least feed "
        f"of {least:g} mm/min",
        f"a stand-off of {needed_mm:g} mm, or a least feed of "
        f"{rounded_down(ramp_feed_mm_min(limits)):g} mm/min",
    )
