"""What a diagnosis computes by a shorter way is what the long way gives."""

from copy import copy

import numpy as np
import pytest
from scipy import stats

from played_campaigns import MACHINE, played
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.law import Extra, Law
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.likelihood.scan_wait import LEAST_PART, _wrapped
from skiplatch.diagnosis.scene.grid import _agreement, _even_agreement, mean_turn
from skiplatch.diagnosis.scene.scene import Scene

PHASES = [(0.0, 0.2), (0.02, 0.1), (0.5, 0.4), (0.97, 0.05), (0.5, 0.01)]


@pytest.mark.parametrize(("centre", "spread"), PHASES)
def test_parts_of_a_wrapped_law_are_truncated_normal_laws(centre: float, spread: float) -> None:
    means = centre + np.array([-1.0, 0.0, 1.0])
    low, high = ((end - means) / spread for end in (0.0, 1.0))
    shares = np.asarray(stats.norm.cdf(high) - stats.norm.cdf(low))
    known = shares > LEAST_PART
    cut = stats.truncnorm(low[known], high[known], means[known], spread)

    found = np.array(_wrapped(centre, spread)).T

    expected = np.array([shares[known], cut.mean(), cut.std()])
    # A law that is nearly all within the turn is taken as it is.
    assert found == pytest.approx(expected, rel=1e-9 if found.shape[1] > 1 else 0.02)


@pytest.mark.parametrize("count", [1, 2, 16, 17, 1000])
def test_products_of_turns_agree_as_the_turns_themselves_do(count: int) -> None:
    stamps = np.sort(np.random.default_rng(1).uniform(0.0, 1e7, 30))
    frequencies = 1e-3 + 1e-8 * np.arange(count, dtype=np.float64)
    expected = [30.0 * abs(mean_turn(stamps, 1.0 / frequency)) for frequency in frequencies]

    even = _even_agreement(frequencies, stamps)
    apart = _agreement(frequencies[:1], frequencies - frequencies[0], stamps)

    assert even == pytest.approx(np.array(expected), abs=1e-6)
    assert apart[0] == pytest.approx(np.array(expected), abs=1e-6)


def test_a_law_of_some_rows_is_the_same_by_mask_and_by_numbers() -> None:
    values = np.arange(4.0)
    law = Law(values, values + 1.0, values + 2.0, values + 3.0, (Extra(0.1, width=values),))
    mask = np.array([True, False, True, True])

    by_mask, by_numbers = law.select(mask), law.select(np.flatnonzero(mask))

    assert by_mask.variance.tolist() == law.variance[mask].tolist()
    assert by_numbers.variance.tolist() == law.variance[mask].tolist()


def test_a_scene_that_travels_again_is_the_one_that_arrived() -> None:
    whole = Scene.of(played(MACHINE))
    part = whole.select(np.arange(0, len(whole), 2))

    first, again = (copy(part) for _ in range(2))

    assert again is first
    assert first.whole is copy(whole)
    change = CANDIDATES["backlash"].change(part, np.array([3.0, 0.0, 0.0, 0.0, 0.0]))
    assert likelihood(first, change).total == likelihood(part, change).total
