"""Touches that go with those before them: found where they do, and no more often than stated."""

from functools import cache

import numpy as np
import pytest
from scipy import stats

from skiplatch.diagnosis.plays.memory import WINDOWS, Memory, remembered
from skiplatch.diagnosis.plays.telling import told_by_forest
from skiplatch.diagnosis.scene.covariates import Order, before

DRAWS = 2000
CONFIDENCE = 0.999


def look(scores: np.ndarray, serial: np.ndarray | None = None) -> Memory | None:
    order = Order(np.arange(len(scores)) if serial is None else serial)
    return remembered(order, np.ones(len(scores), dtype=bool), scores)


def states(n: int, seed: int) -> np.ndarray:
    """Two that take turns now and then, a standard deviation apart."""
    rng = np.random.default_rng(seed)
    changes = rng.random(n) < 1.0 / 25.0
    return rng.normal(size=n) + np.cumsum(changes) % 2


@cache
def of_noise(n: int) -> list[Memory | None]:
    rng = np.random.default_rng(3)
    return [look(rng.normal(size=n)) for _ in range(DRAWS)]


@pytest.mark.long
@pytest.mark.parametrize("n", [25, 100, 300])
@pytest.mark.parametrize("z", [2.0, 3.0])
def test_noise_is_no_memory_more_often_than_stated(n: int, z: float) -> None:
    often = sum(one is not None and one.z > z for one in of_noise(n))

    assert often <= stats.binom.ppf(CONFIDENCE, DRAWS, stats.norm.sf(z))


@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param(range(100), marks=pytest.mark.long),
        pytest.param(range(300), marks=pytest.mark.nightly),
    ],
)
def test_what_a_forest_learns_of_touches_before_is_no_news_of_noise(seeds: range) -> None:
    """Of scores on both sides it knew the answer: one look in a hundred was beyond four errors."""
    rng, n = np.random.default_rng(4), 250
    order, beyond = Order(np.arange(n)), 0
    for seed in seeds:
        scores = rng.normal(size=n)
        told, _ = told_by_forest(before(order, scores), scores[:, None], seed)
        beyond += np.corrcoef(told[:, 0], scores)[0, 1] * np.sqrt(n) > 3.0

    assert beyond <= len(seeds) // 100


def test_states_that_come_and_go_are_told() -> None:
    found = [look(states(400, seed)) for seed in range(40)]

    assert np.median([one.z for one in found if one]) > 5.0


def test_the_touches_that_are_told_are_those_of_one_state() -> None:
    state = np.repeat([0.0, 3.0, 0.0, 3.0], 50)

    found = look(state + np.random.default_rng(1).normal(size=200))

    assert found is not None
    assert np.mean(found.rows == (state > 0.0)) > 0.9


def test_touches_that_are_not_in_the_record_part_those_beside_them() -> None:
    pairs = np.random.default_rng(2).normal(size=200)
    scores = np.repeat(pairs, 2)  # each is as far off as its neighbour
    together, apart = look(scores), look(scores, 40 * np.arange(400))

    assert together is not None
    assert together.z > 5.0
    assert apart is not None
    assert apart.z == 0.0


def test_what_is_all_the_same_or_too_short_tells_nothing() -> None:
    assert look(np.full(100, 0.1)) is None
    assert look(np.arange(4.0 * WINDOWS[0] - 1.0)) is None
