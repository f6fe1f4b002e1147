"""What tells values of touches: the condition whose ranks go with them most."""

import numpy as np
import pytest
from scipy import stats

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.plays.telling import FEWEST, best_ranked

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
