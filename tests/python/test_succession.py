"""Touches in a row: how many of them count as independent."""

import numpy as np
import pytest

from skiplatch.succession import FEWEST, independent_share


@pytest.mark.parametrize("touches", [0, 1, FEWEST - 1])
def test_too_few_touches_count_as_they_are(touches: int) -> None:
    assert independent_share(np.arange(float(touches))) == 1.0


def test_touches_that_go_on_as_before_count_for_less() -> None:
    walk = np.cumsum(np.random.default_rng(1).normal(size=200))

    assert independent_share(walk - walk.mean()) < 0.5
