"""The planner's model of a cycle agrees with the firmware in the simulation."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from skiplatch.campaign import AxisNominal, InputPath
from skiplatch.latch.effort import Effort
from skiplatch.latch.probing import DEFAULT_RIG
from skiplatch.latch.reference_figures.cycles import FITTED_BACK_OFF_MM
from skiplatch.latch.reference_figures.model import IDEAL
from skiplatch.planner.document import DOCUMENT_LIMITS
from skiplatch.planner.model import (
    Strategy,
    back_off_mm,
    cycle_s,
    fast_feed_for_stand_off,
    feed_for_range,
    legs,
    measuring_feed_for_stand_off,
    overtravel_mm,
    ramp_feed_mm_min,
    range_um,
    safe_feed_mm_min,
    standard_uncertainty_um,
)
from skiplatch.planner.search import with_back_off
from skiplatch.planner.trial import try_out

LIMITS = replace(DOCUMENT_LIMITS, nominal=DEFAULT_RIG)
DOCUMENT = replace(LIMITS, nominal=IDEAL, path=InputPath.SKIP)
SCAN_S = 0.004
feeds = st.floats(20.0, 5000.0)
paths = st.sampled_from(InputPath)


@pytest.mark.parametrize(
    ("strategy", "document_s"),
    [
        (Strategy(measuring_feed_mm_min=3000.0), 0.254),
        (
            Strategy(
                measuring_feed_mm_min=30.0,
                fast_feed_mm_min=3000.0,
                back_off_mm=FITTED_BACK_OFF_MM,
            ),
            0.444,
        ),
        (
            Strategy(measuring_feed_mm_min=30.0, fast_feed_mm_min=3000.0, back_off_mm=0.25),
            0.778,
        ),
    ],
)
def test_model_gives_the_cycle_times_of_the_document(strategy: Strategy, document_s: float) -> None:
    assert round(cycle_s(DOCUMENT, strategy), 3) == document_s


def test_legs_go_to_the_surface_and_back_to_the_start() -> None:
    """Areas under the trapezoids: what goes forward comes back, and each contact is at 5 mm."""
    two = Strategy(
        measuring_feed_mm_min=30.0, fast_feed_mm_min=3000.0, back_off_mm=FITTED_BACK_OFF_MM
    )
    place_mm, met_mm = 0.0, []
    for leg in legs(DOCUMENT, two):
        v, ramp_s = leg.feed_mm_min / 60.0, abs(leg.feed_mm_min) / 60.0 / 3000.0
        if leg.contact_s is not None:
            met_mm.append(place_mm + v * (leg.contact_s - ramp_s / 2.0))
        place_mm += v * (leg.time_s - ramp_s)

    assert met_mm == pytest.approx([5.0, 5.0], abs=1e-9)
    assert place_mm == pytest.approx(0.0, abs=1e-9)


def test_one_touch_takes_what_the_closed_formula_says() -> None:
    v, accel, late_s = 50.0, 3000.0, 0.002

    assert cycle_s(DOCUMENT, Strategy(measuring_feed_mm_min=3000.0)) == pytest.approx(
        2 * 5.0 / v + 2 * late_s + 3 * v / accel, rel=1e-12
    )


@settings(max_examples=40)
@given(path=paths, feed=feeds, accel=st.floats(500.0, 20_000.0), stand_off=st.floats(2.0, 20.0))
def test_one_touch_in_the_simulation_takes_what_the_model_says(
    path: InputPath, feed: float, accel: float, stand_off: float
) -> None:
    rig = replace(DEFAULT_RIG, axis=AxisNominal(resolution_um=0.01, accel_mm_s2=accel))
    limits = replace(LIMITS, nominal=rig, path=path, stand_off_mm=stand_off)
    feed = min(feed, safe_feed_mm_min(limits), ramp_feed_mm_min(limits))
    strategy = Strategy(measuring_feed_mm_min=feed)

    trial = try_out(limits, strategy, Effort(500, seed=1))

    # Each of the two steps may wait for a scan by up to half a scan more or less than its mean.
    allowed_s = SCAN_S if path == InputPath.PLC else 1e-5
    assert trial.cycle_s.value == pytest.approx(cycle_s(limits, strategy), abs=allowed_s)
    assert trial.overtravel_mm <= overtravel_mm(limits, feed) + 1e-5
    assert trial.overtravel_mm == pytest.approx(overtravel_mm(limits, feed), rel=0.05, abs=1e-5)
    assert trial.range_um <= range_um(limits, feed)


@settings(max_examples=40)
@given(path=paths, fast=feeds, measuring=st.floats(20.0, 1000.0))
def test_two_touches_in_the_simulation_take_what_the_model_says(
    path: InputPath, fast: float, measuring: float
) -> None:
    limits = replace(LIMITS, path=path)
    strategy = with_back_off(limits, max(fast, measuring), measuring)

    trial = try_out(limits, strategy, Effort(500, seed=1))

    # Three steps wait for a scan; and of 500 first latches the mean lateness is not quite T/2.
    lateness_s = 6.0 * SCAN_S / math.sqrt(12.0 * 500) * strategy_ratio(strategy)
    allowed_s = 1.5 * SCAN_S + lateness_s if path == InputPath.PLC else 5e-5
    assert trial.cycle_s.value == pytest.approx(cycle_s(limits, strategy), abs=allowed_s)
    assert trial.range_um <= range_um(limits, measuring)


def strategy_ratio(strategy: Strategy) -> float:
    """How much slow time a bit of fast lateness saves."""
    assert strategy.fast_feed_mm_min is not None
    return strategy.fast_feed_mm_min / strategy.measuring_feed_mm_min


@given(path=paths, wanted_um=st.floats(0.02, 1000.0))
def test_feed_for_a_range_has_that_range(path: InputPath, wanted_um: float) -> None:
    limits = replace(LIMITS, path=path)

    assert range_um(limits, feed_for_range(limits, wanted_um)) == pytest.approx(wanted_um)


def test_range_finer_than_the_resolution_needs_a_feed_below_zero() -> None:
    assert feed_for_range(LIMITS, 0.005) < 0.0


def test_input_without_jitter_allows_any_feed() -> None:
    sharp = replace(DEFAULT_RIG, skip=replace(DEFAULT_RIG.skip, jitter_us=0.0))

    limits = replace(LIMITS, nominal=sharp, path=InputPath.SKIP)

    assert feed_for_range(limits, 0.02) == math.inf
    assert feed_for_range(limits, 0.005) == -math.inf


def test_standard_uncertainty_is_that_of_reaction_and_rounding() -> None:
    assert standard_uncertainty_um(LIMITS, 3000.0) == pytest.approx(
        math.hypot(200.0, 0.01) / math.sqrt(12.0)
    )


@given(allowed_mm=st.floats(0.01, 50.0), reaction_us=st.floats(0.0, 1e5))
def test_safe_feed_overtravels_by_just_what_is_allowed(
    allowed_mm: float, reaction_us: float
) -> None:
    limits = replace(LIMITS, overtravel_mm=allowed_mm, reaction_us=reaction_us)

    assert overtravel_mm(limits, safe_feed_mm_min(limits)) == pytest.approx(allowed_mm)


@given(fast=feeds, measuring=feeds)
def test_back_off_clears_the_latest_latch_and_leaves_room_for_the_ramp(
    fast: float, measuring: float
) -> None:
    left_mm = back_off_mm(LIMITS, fast, measuring) - fast / 60.0 * LIMITS.input.latest_us / 1e6

    assert left_mm >= (measuring / 60.0) ** 2 / (2.0 * 3000.0) + LIMITS.margin_mm - 1e-12


def test_feeds_for_a_stand_off_have_back_offs_that_just_fit() -> None:
    short = replace(LIMITS, stand_off_mm=0.3)
    fast = fast_feed_for_stand_off(short)
    measuring = measuring_feed_for_stand_off(short, 1000.0)

    assert back_off_mm(short, fast, short.least_feed_mm_min) <= 0.3 + 1e-12
    assert back_off_mm(short, 1000.0, measuring) == pytest.approx(0.3)
