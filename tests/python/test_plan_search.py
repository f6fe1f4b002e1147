"""The planner finds the fastest strategy, and says what to change where there is none."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from skiplatch.campaign import AxisNominal, InputPath
from skiplatch.latch.effort import Effort
from skiplatch.latch.probing import DEFAULT_RIG
from skiplatch.planner import Limits, Plan, Strategy, as_text, make_plan
from skiplatch.planner.document import DOCUMENT_LIMITS
from skiplatch.planner.model import (
    cycle_s,
    overtravel_mm,
    ramp_feed_mm_min,
    range_um,
    safe_feed_mm_min,
)
from skiplatch.planner.obstacles import Obstacle
from skiplatch.planner.rounding import rounded_down, rounded_up
from skiplatch.planner.search import find_plan, with_back_off

LIMITS = replace(DOCUMENT_LIMITS, nominal=DEFAULT_RIG)
QUICK = Effort(2000, seed=1, jobs=2)
limits_of_all_kinds = st.builds(
    replace,
    st.just(LIMITS),
    path=st.sampled_from(InputPath),
    stand_off_mm=st.floats(0.1, 50.0),
    reaction_us=st.floats(0.0, 10_000.0),
    overtravel_mm=st.floats(0.01, 5.0),
    greatest_feed_mm_min=st.floats(100.0, 20_000.0),
    least_back_off_mm=st.floats(0.01, 1.0),
)


def allowed(limits: Limits, strategy: Strategy, wanted_um: float) -> bool:
    """Whether a strategy keeps to everything, told independently of the search."""
    measuring = strategy.measuring_feed_mm_min
    fastest = strategy.fast_feed_mm_min or measuring
    return (
        range_um(limits, measuring) <= wanted_um
        and limits.least_feed_mm_min <= measuring <= fastest <= limits.greatest_feed_mm_min
        and overtravel_mm(limits, fastest) <= limits.overtravel_mm * (1.0 + 1e-9)
        and (fastest / 60.0) ** 2 / (2.0 * limits.accel_mm_s2) <= limits.stand_off_mm * (1.0 + 1e-9)
        and (strategy.back_off_mm or 0.0) <= limits.stand_off_mm * 1.01
    )


def grid_of(limits: Limits, wanted_um: float) -> list[Strategy]:
    """All allowed strategies of a grid."""
    feeds = np.geomspace(limits.least_feed_mm_min, limits.greatest_feed_mm_min, 60)
    one = [Strategy(measuring_feed_mm_min=feed) for feed in feeds]
    two = [with_back_off(limits, fast, slow) for fast, slow in product(feeds, feeds)]
    return [strategy for strategy in (*one, *two) if allowed(limits, strategy, wanted_um)]


@pytest.mark.long
@settings(max_examples=30)
@given(limits=limits_of_all_kinds, wanted_um=st.floats(0.05, 500.0))
def test_no_strategy_of_a_grid_is_faster(limits: Limits, wanted_um: float) -> None:
    best = find_plan(limits, wanted_um).best(limits)
    grid = grid_of(limits, wanted_um)

    if best is None:
        assert grid == []
        return
    assert allowed(limits, best, wanted_um)
    if grid:  # feeds are rounded down by up to 1 %, which is programmed
        assert cycle_s(limits, best) <= 1.011 * min(cycle_s(limits, s) for s in grid)


def test_cycle_time_has_a_minimum_inside_where_the_ramps_outweigh_the_feed() -> None:
    limits = replace(LIMITS, path=InputPath.SKIP, greatest_feed_mm_min=50_000.0)
    limits = replace(limits, stand_off_mm=20.0, overtravel_mm=50.0, reaction_us=0.0)
    found = find_plan(limits, 1000.0).one

    assert isinstance(found, Strategy)
    # dT/dv = 0 at v = √(2·D·a/3)
    assert found.measuring_feed_mm_min == pytest.approx(60.0 * (40_000.0) ** 0.5, rel=0.01)
    assert found.measuring_feed_mm_min < min(safe_feed_mm_min(limits), ramp_feed_mm_min(limits))


def test_document_s_wish_takes_two_touches() -> None:
    plan = make_plan(LIMITS, 2.0, QUICK)

    assert plan.best == plan.findings.two
    assert plan.best is not None
    assert plan.best.measuring_feed_mm_min == 29.8
    assert plan.trial is not None
    assert plan.trial.confirms(LIMITS, 2.0)
    assert plan.trial.cycle_s.value < 0.6
    assert "one touch would have to crawl at 29.8 mm/min: 20.1 s; two touches need 0.5" in as_text(
        plan
    )


def test_coarse_wish_takes_one_touch_at_the_greatest_feed() -> None:
    plan = make_plan(LIMITS, 250.0, QUICK)

    assert plan.best == Strategy(measuring_feed_mm_min=3000.0)
    assert "one touch at 3000 mm/min needs" in as_text(plan)
    assert "two touches would need" in as_text(plan)


@settings(max_examples=20)
@given(limits=limits_of_all_kinds, wanted_um=st.floats(0.05, 500.0))
def test_simulation_confirms_every_plan(limits: Limits, wanted_um: float) -> None:
    plan = make_plan(limits, wanted_um, QUICK)

    assert plan.trial is None or plan.trial.confirms(limits, wanted_um)


def test_overtravel_bounds_the_feed() -> None:
    found = find_plan(replace(LIMITS, overtravel_mm=0.1), 1000.0).one

    assert isinstance(found, Strategy)
    assert found.measuring_feed_mm_min == rounded_down(
        safe_feed_mm_min(replace(LIMITS, overtravel_mm=0.1))
    )


def test_back_off_stays_within_a_short_stand_off() -> None:
    limits = replace(LIMITS, path=InputPath.SKIP, stand_off_mm=2.6, margin_mm=2.5)
    found = find_plan(limits, 1000.0).two

    assert isinstance(found, Strategy)
    assert found.back_off_mm is not None
    assert found.back_off_mm <= limits.stand_off_mm * 1.01  # rounded up


def obstacle_of(limits: Limits, wanted_um: float) -> Obstacle:
    found = find_plan(limits, wanted_um)
    assert found.best(limits) is None
    assert isinstance(found.one, Obstacle)
    return found.one


def test_least_feed_in_the_way_is_named_and_each_remedy_works() -> None:
    obstacle = obstacle_of(LIMITS, 0.1)

    assert obstacle.limit == "least feed"
    assert "needs a measuring feed of 1.35 mm/min" in obstacle.message
    assert "varies by 1800 µs" in obstacle.remedy
    assert "a range of 0.211 µm" in obstacle.remedy
    faster = replace(DEFAULT_RIG, plc=replace(DEFAULT_RIG.plc, scan_us=1800.0))
    assert find_plan(replace(LIMITS, least_feed_mm_min=1.35), 0.1).best(LIMITS)
    assert find_plan(replace(LIMITS, nominal=faster), 0.1).best(LIMITS)
    assert find_plan(LIMITS, 0.211).best(LIMITS)


def test_resolution_in_the_way_is_named_and_the_remedy_works() -> None:
    obstacle = obstacle_of(replace(LIMITS, path=InputPath.SKIP), 0.005)

    assert obstacle.limit == "resolution"
    finer = replace(DEFAULT_RIG, axis=AxisNominal(resolution_um=0.001, accel_mm_s2=3000.0))
    assert find_plan(replace(LIMITS, nominal=finer, path=InputPath.SKIP), 0.005).best(LIMITS)


def test_overtravel_in_the_way_is_named_and_each_remedy_works() -> None:
    limits = replace(LIMITS, overtravel_mm=0.05, least_feed_mm_min=3000.0)
    obstacle = obstacle_of(limits, 300.0)

    assert obstacle.limit == "overtravel"
    assert "0.717 mm" in obstacle.remedy
    assert "418 mm/min" in obstacle.remedy
    assert find_plan(replace(limits, overtravel_mm=0.717), 300.0).best(limits)
    assert find_plan(replace(limits, least_feed_mm_min=418.0), 300.0).best(limits)


def test_stand_off_in_the_way_is_named_and_each_remedy_works() -> None:
    limits = replace(LIMITS, stand_off_mm=0.05, least_feed_mm_min=3000.0)
    obstacle = obstacle_of(limits, 300.0)

    assert obstacle.limit == "stand-off"
    assert "0.417 mm" in obstacle.remedy
    assert "1030 mm/min" in obstacle.remedy
    assert find_plan(replace(limits, stand_off_mm=0.417), 300.0).best(limits)
    assert find_plan(replace(limits, least_feed_mm_min=1030.0), 300.0).best(limits)


def test_short_stand_off_leaves_one_touch_and_says_why() -> None:
    plan = make_plan(replace(LIMITS, stand_off_mm=0.04), 2.0, QUICK)

    assert plan.best == plan.findings.one
    assert "more than the stand-off of 0.04 mm" in as_text(plan)


def test_refused_plan_has_words_but_no_trial() -> None:
    plan = make_plan(LIMITS, 0.1, QUICK)

    assert plan.best is None
    assert plan.trial is None
    assert "not possible, least feed:" in as_text(plan)
    assert as_text(plan).count("what would do:") == 1


def test_plan_that_the_simulation_does_not_confirm_is_told() -> None:
    plan = make_plan(LIMITS, 2.0, QUICK)
    stricter = Plan(LIMITS, 1.0, plan.findings, plan.best, plan.trial)

    assert "NOT CONFIRMED" in as_text(stricter)


def test_result_does_not_depend_on_the_number_of_threads() -> None:
    assert make_plan(LIMITS, 2.0, Effort(10_000, 1, jobs=1)) == make_plan(
        LIMITS, 2.0, Effort(10_000, 1, jobs=3)
    )


@pytest.mark.parametrize(
    ("value", "down", "up"), [(29.85, 29.8, 29.9), (0.12345, 0.123, 0.124), (2e4, 2e4, 2e4)]
)
def test_figures_are_rounded_to_the_safe_side(value: float, down: float, up: float) -> None:
    assert (rounded_down(value), rounded_up(value)) == (down, up)
