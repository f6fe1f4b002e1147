"""Speeds that make the pretravel the same in every direction."""

import math
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.compensation import firmware
from skiplatch.compensation.delay import Delay
from skiplatch.compensation.formats import rounded
from skiplatch.compensation.probe_map import ProbeMap
from skiplatch.units import UM_PER_MM, US_PER_MS

HINTS = {"TOO_SLOW": "; map the probe at a higher feed, or give --target max"}
"""What to do about an error of the firmware, by its name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What the machine can do; infinity is no limit.

    Attributes:
        max_feed_mm_min: Fastest measuring feed.
        overtravel_mm: How far the tip may go on past the surface.
        accel_mm_s2: Acceleration of the axes.
        approach_mm: From where the feed is set to the surface.
        reaction_ms: From the latch to the start of the deceleration.
    """

    max_feed_mm_min: float = math.inf
    overtravel_mm: float = math.inf
    accel_mm_s2: float = math.inf
    approach_mm: float = math.inf
    reaction_ms: float = 0.0


@dataclass(frozen=True, slots=True)
class Target:
    """The radius that every direction shall have.

    Attributes:
        rule: How it follows from the pretravels of the map.
        radius_um: Where it is given: as it was measured, also outside of an artefact.
    """

    rule: firmware.Target
    radius_um: float = 0.0


@dataclass(frozen=True, slots=True)
class Times:
    """How long approaches take, without the table (before) and with it.

    Attributes:
        touch_before_s: t_s of one approach.
        touch_least_s: The same of the fastest one with the table.
        touch_greatest_s: The same of the slowest one.
        total_before_s: t_M of an approach in each direction of the table.
        total_s: The same with the table.
    """

    touch_before_s: float
    touch_least_s: float
    touch_greatest_s: float
    total_before_s: float
    total_s: float


@dataclass(frozen=True, slots=True, eq=False)
class Compensation:
    """A speed table and what it is made of; arrays of shape (n,), in the order of the map.

    Attributes:
        probe_map: The radii.
        delay: The delay.
        base_mm_min: The feed without compensation, for the increase of time.
        before_mm_min: The feeds at which the map was measured.
        feed_mm_min: The table, rounded as it is written.
        target_um: The radius that all directions shall have, with the sign of the map.
        predicted_um: Radii at these feeds, were there no random error.
        vr_before_um: Greatest less least mean radius.
        vr_systematic_um: The same of `predicted_um`: what rounding leaves.
        time_increase: Of the approaches of the table, as a fraction of the time at `base_mm_min`.
        times: Of the approaches of the table; None where their length is not known.
    """

    probe_map: ProbeMap
    delay: Delay
    base_mm_min: float
    before_mm_min: FloatArray
    feed_mm_min: FloatArray
    target_um: float
    predicted_um: FloatArray
    vr_before_um: float
    vr_systematic_um: float
    time_increase: float
    times: Times | None


def compensate(
    probe_map: ProbeMap,
    delay: Delay,
    *,
    base_mm_min: float,
    before_mm_min: FloatArray,
    target: Target,
    limits: Limits,
) -> Compensation:
    """Compute the table through the firmware.

    Raises:
        InputError: A feed would have to be 0 or less, or beyond what the machine can do.
    """
    plan = plan_of(delay.tau_ms, target, probe_map, limits)
    try:
        table = firmware.speed_table(probe_map.mean_um, before_mm_min, plan)
    except firmware.PretravelError as error:
        hint = HINTS.get(error.name, "")
        raise probe_map.fault(error.index or 0, "radius_um", f"{error}{hint}") from error
    feed_mm_min = rounded(table.speed_mm_min)
    predicted_um = firmware.predict_um(probe_map.mean_um, before_mm_min, feed_mm_min, delay.tau_ms)
    written = feed_mm_min[probe_map.cell_of[probe_map.listed]]  # the pole may stand there often
    return Compensation(
        probe_map=probe_map,
        delay=delay,
        base_mm_min=base_mm_min,
        before_mm_min=before_mm_min,
        feed_mm_min=feed_mm_min,
        target_um=table.target_um,
        predicted_um=predicted_um,
        vr_before_um=firmware.range_um(probe_map.mean_um),
        vr_systematic_um=firmware.range_um(predicted_um),
        time_increase=firmware.time_increase(base_mm_min, written),
        times=_times(base_mm_min, written, limits.approach_mm),
    )


def _times(base_mm_min: float, written: FloatArray, approach_mm: float) -> Times | None:
    if not math.isfinite(approach_mm):
        return None
    before = np.full(len(written), base_mm_min)
    return Times(
        firmware.time_s(before[:1], approach_mm),
        firmware.time_s(written.max(keepdims=True), approach_mm),
        firmware.time_s(written.min(keepdims=True), approach_mm),
        firmware.time_s(before, approach_mm),
        firmware.time_s(written, approach_mm),
    )


def plan_of(tau_ms: float, target: Target, probe_map: ProbeMap, limits: Limits) -> firmware.Plan:
    """Put together what the firmware wants to know.

    The axis goes on at full feed for tau and the reaction after the contact, and then brakes.
    """
    overtravel_feed = math.inf
    if math.isfinite(limits.overtravel_mm):
        overtravel_feed = firmware.safe_speed_mm_min(
            limits.overtravel_mm * UM_PER_MM,
            reaction_us=(tau_ms + limits.reaction_ms) * US_PER_MS,
            accel_mm_s2=limits.accel_mm_s2,
        )
    return firmware.Plan(
        tau_ms=tau_ms,
        target=target.rule,
        target_um=probe_map.sign * target.radius_um,
        speed_max_mm_min=limits.max_feed_mm_min,
        overtravel_speed_mm_min=overtravel_feed,
        accel_mm_s2=limits.accel_mm_s2,
        approach_mm=limits.approach_mm,
    )
