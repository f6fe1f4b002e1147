"""Touches that come every so many: told by their scores, and by what happened to them."""

from collections.abc import Callable

import numpy as np
import pytest

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.plays.scores import normal_scores
from skiplatch.diagnosis.plays.turns import FEWEST, Turn, happens_in_turn, in_turn

TOUCHES, PLAYS = 90, 60
CAMPAIGNS = 1000
OFTEN = 9
"""From one touch that is late to the next."""


def numbers(rng: np.random.Generator) -> IndexArray:
    """Number the touches of one path, some of all."""
    return np.sort(rng.choice(2 * TOUCHES, TOUCHES, replace=False))


def scores(_: IndexArray, rng: np.random.Generator) -> FloatArray:
    """Score touches with heavy tails among plays that have them, too."""
    return normal_scores(rng.standard_t(3, TOUCHES), rng.standard_t(3, (PLAYS, TOUCHES)))


def by_scores(serial: IndexArray, rng: np.random.Generator) -> Turn | None:
    return in_turn(serial, scores(serial, rng))


def by_what_happened(serial: IndexArray, rng: np.random.Generator) -> Turn | None:
    return happens_in_turn(serial, rng.random(TOUCHES) < 1.0 / OFTEN)


def late(serial: IndexArray) -> BoolArray:
    return np.asarray(serial % OFTEN == 4)


@pytest.mark.parametrize("look", [by_scores, by_what_happened])
def test_chance_is_told_no_more_often_than_it_says(
    look: Callable[[IndexArray, np.random.Generator], Turn | None],
) -> None:
    rng = np.random.default_rng(1)
    found = [look(numbers(rng), rng) for _ in range(CAMPAIGNS)]

    z = np.array([one.z for one in found if one])

    assert len(z) == CAMPAIGNS
    # One in 44 is beyond two standard errors; of a thousand campaigns four more by luck, at most.
    assert np.sum(z > 2.0) < CAMPAIGNS / 44 + 4.0 * np.sqrt(CAMPAIGNS / 44)
    assert np.sum(z > 4.0) == 0


def test_touches_that_are_late_in_turn_are_found_where_plays_are_as_often_late() -> None:
    rng = np.random.default_rng(2)
    serial = numbers(rng)
    plays = rng.normal(size=(PLAYS, TOUCHES)) + 15.0 * (rng.random((PLAYS, TOUCHES)) < 1.0 / OFTEN)
    recorded = rng.normal(size=TOUCHES) + 15.0 * late(serial)

    found = in_turn(serial, normal_scores(recorded, plays))

    assert found is not None
    assert (found.apart, found.rows.tolist()) == (OFTEN, late(serial).tolist())
    assert found.z > 4.0


def test_six_of_sixty_to_which_something_happens_in_turn_are_no_accident() -> None:
    serial = np.arange(60)

    found = happens_in_turn(serial, serial % 10 == 3)

    assert found is not None
    assert (found.apart, found.rows.tolist()) == (10, (serial % 10 == 3).tolist())
    assert found.z > 4.0


def test_too_few_touches_have_no_turn() -> None:
    few = np.arange(2 * FEWEST - 1)

    assert in_turn(few, few.astype(float)) is None
    assert happens_in_turn(few, few > FEWEST) is None


def test_scores_that_are_all_the_same_tell_nothing() -> None:
    assert in_turn(np.arange(TOUCHES), np.full(TOUCHES, 0.1)) is None


def test_nothing_that_happened_is_no_news() -> None:
    found = happens_in_turn(np.arange(TOUCHES), np.zeros(TOUCHES, dtype=bool))

    assert found is not None
    assert found.z == 0.0
