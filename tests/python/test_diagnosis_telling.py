"""What tells values of touches: the condition whose ranks go with them most."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from scipy import stats

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.plays.telling import (
    FEWEST,
    Ranked,
    best_levelled,
    best_paired,
    best_ranked,
    told_by_one,
)
from skiplatch.diagnosis.scene.covariates import PAIRED

TOUCHES = 60


@pytest.fixture
def target() -> FloatArray:
    return np.random.default_rng(1).normal(size=TOUCHES)


def test_the_condition_that_tells_most_is_named_with_its_chance(target: FloatArray) -> None:
    rng = np.random.default_rng(2)
    columns = {
        "noise": rng.normal(size=TOUCHES),
        "cause": np.exp(target + rng.normal(size=TOUCHES)),
    }

    best = best_ranked(columns, target)

    assert best is not None
    assert best.names == ("cause",)
    ranks = stats.rankdata(columns["cause"])
    tried = 2 * len(columns)  # straight and bent
    assert best.chance == pytest.approx(tried * stats.pearsonr(ranks, target).pvalue)
    np.testing.assert_array_equal(best.values, ranks)


def test_touches_without_a_value_of_a_condition_are_left_out_of_it_alone(
    target: FloatArray,
) -> None:
    known = np.arange(TOUCHES) % 3 > 0
    some = np.where(known, 2.0 * target, np.nan)
    columns = {"all": np.random.default_rng(3).normal(size=TOUCHES), "some": some}

    best = best_ranked(columns, target)

    assert best is not None
    assert best.names == ("some",)
    expected = stats.pearsonr(stats.rankdata(some[known]), target[known]).pvalue
    assert best.chance == pytest.approx(4 * expected)
    assert np.array_equal(np.isnan(best.values), ~known)


def test_what_is_off_at_the_middle_of_a_condition_alone_goes_with_it_as_well() -> None:
    """A straight line through three feeds may miss the one between by as much as the outer ones."""
    rng = np.random.default_rng(4)
    feed = rng.choice([100.0, 400.0, 1600.0], TOUCHES)
    target = np.where(feed == 400.0, 1.4, -0.7) + rng.normal(size=TOUCHES)

    best = best_ranked({"feed": feed, "noise": rng.normal(size=TOUCHES)}, target)

    assert best is not None
    assert best.names == ("feed",)
    assert best.chance < 1e-4
    assert best.values[feed == 400.0].max() < best.values[feed != 400.0].min()


def test_noise_goes_with_some_condition_no_more_often_than_its_chance_says() -> None:
    rng = np.random.default_rng(5)
    columns = {str(k): rng.normal(size=TOUCHES) for k in range(9)}
    columns["feed"] = rng.choice([1.0, 2.0, 3.0], TOUCHES)

    found = [best_ranked(columns, rng.normal(size=TOUCHES)) for _ in range(400)]

    assert np.mean([one is not None and one.chance < 0.1 for one in found]) == pytest.approx(
        0.095, abs=0.04
    )


def test_what_is_the_same_for_all_and_what_few_have_tells_nothing(target: FloatArray) -> None:
    few = np.where(np.arange(TOUCHES) < FEWEST - 1, target, np.nan)

    assert best_ranked({"few": few, "same": np.ones(TOUCHES)}, target) is None


def test_nothing_tells_values_that_are_all_the_same(target: FloatArray) -> None:
    assert best_ranked({"cause": target}, np.ones(TOUCHES)) is None


def test_what_is_off_at_one_value_of_a_condition_alone_goes_with_it() -> None:
    """Neither straight nor bent: the third of seven feeds."""
    rng = np.random.default_rng(5)
    feed = rng.choice([60.0, 100.0, 200.0, 400.0, 800.0, 1600.0, 3000.0], 2 * TOUCHES)
    target = np.where(feed == 200.0, 2.5, 0.0) + rng.normal(size=2 * TOUCHES)
    columns = {"feed": feed, "noise": rng.normal(size=2 * TOUCHES)}

    ordered, levelled = best_ranked(columns, target), best_levelled(columns, target)

    assert ordered is not None
    assert levelled is not None
    assert levelled.names == ("feed",)
    assert levelled.chance < 1e-6 < ordered.chance
    assert set(feed[levelled.values > 1.0]) == {200.0}


def test_conditions_act_together_that_do_nothing_alone() -> None:
    rng = np.random.default_rng(6)
    feed, temperature = rng.normal(size=(2, TOUCHES))
    target = feed * temperature + 0.5 * rng.normal(size=TOUCHES)
    columns = {"feed": feed, "temperature": temperature, "approach": rng.normal(size=TOUCHES)}

    found = min(told_by_one(columns, target), key=lambda one: one.chance)

    assert found.names == ("feed", "temperature")
    assert found.chance < 1e-5


@pytest.mark.parametrize("way", [best_levelled, best_paired])
def test_chance_tells_no_more_often_than_it_says(
    way: Callable[[Mapping[str, FloatArray], FloatArray], Ranked | None],
) -> None:
    """At a level of 5 %; more than 32 of 400 are one in a hundred campaigns of such tests."""
    rng = np.random.default_rng(7)
    told = 0
    for _ in range(400):
        columns = {name: rng.choice(np.arange(6.0), TOUCHES) for name in PAIRED[:4]}
        best = way(columns, rng.normal(size=TOUCHES))
        told += best is not None and best.chance < 0.05

    assert told <= 32


def test_a_condition_of_too_many_values_or_of_two_has_no_levels(target: FloatArray) -> None:
    two = {"sense": np.resize([-1.0, 1.0], TOUCHES), "many": np.arange(TOUCHES) * 1.0}

    assert best_levelled(two, target) is None
    assert best_paired({"sense": two["sense"]}, target) is None
