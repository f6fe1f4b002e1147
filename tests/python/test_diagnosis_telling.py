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

    chance, name = best_ranked(columns, target) or (1.0, "")

    assert name == "cause"
    ranks = stats.rankdata(columns["cause"])
    assert chance == pytest.approx(stats.pearsonr(ranks, target).pvalue)


def test_touches_without_a_value_of_a_condition_are_left_out_of_it_alone(
    target: FloatArray,
) -> None:
    known = np.arange(TOUCHES) % 3 > 0
    some = np.where(known, 2.0 * target, np.nan)
    columns = {"all": np.random.default_rng(3).normal(size=TOUCHES), "some": some}

    chance, name = best_ranked(columns, target) or (1.0, "")

    assert name == "some"
    expected = stats.pearsonr(stats.rankdata(some[known]), target[known]).pvalue
    assert chance == pytest.approx(expected)


def test_what_is_the_same_for_all_and_what_few_have_tells_nothing(target: FloatArray) -> None:
    few = np.where(np.arange(TOUCHES) < FEWEST - 1, target, np.nan)

    assert best_ranked({"few": few, "same": np.ones(TOUCHES)}, target) is None


def test_nothing_tells_values_that_are_all_the_same(target: FloatArray) -> None:
    assert best_ranked({"cause": target}, np.ones(TOUCHES)) is None
