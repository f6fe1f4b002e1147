"""A grid that stamps keep is found without a guess of how coarse it is."""

import numpy as np
import pytest

from skiplatch.diagnosis.scene.grid import grid_told, kept_grid

WIDEST = 10_000.0


def stamps(period: float, fine: float, count: int, seed: int) -> np.ndarray:
    """Give moments of a campaign of hours, on a grid and then rounded."""
    rng = np.random.default_rng(seed)
    times = np.sort(rng.uniform(0.0, 6e9, count))
    return np.asarray(np.rint((np.floor(times / period) * period + 3.7) / fine) * fine)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("period", "fine", "count"),
    [
        (54.742174, 0.25, 300),
        (9.87, 0.25, 300),
        (20.0, 1.0, 200),
        (1234.567, 0.0625, 40),
        (6.13, 0.25, 400),
    ],
)
def test_a_coarse_clock_is_told_to_a_part_of_its_tick(
    period: float, fine: float, count: int, seed: int
) -> None:
    """Over hours, a period that is off by a millionth puts the stamps anywhere."""
    found = grid_told(stamps(period, fine, count, seed), fine, WIDEST)

    assert found is not None
    assert found[0] == pytest.approx(period, rel=fine / period * 1e-5)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("fine", [0.25, 1.0])
def test_stamps_that_keep_no_coarser_grid_tell_none(fine: float, seed: int) -> None:
    assert grid_told(stamps(fine, fine, 300, seed), fine, WIDEST) is None


def test_no_grid_is_coarser_than_the_widest_and_none_is_told_by_a_few() -> None:
    assert grid_told(stamps(54.7, 0.25, 300, 1), 0.25, 50.0) is None
    assert grid_told(stamps(54.7, 0.25, 5, 1), 0.25, WIDEST) is None
    assert grid_told(np.full(300, 54.7), 0.25, WIDEST) is None
    assert grid_told(np.empty(0), 0.25, WIDEST) is None


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("late", [0.0, 0.3])
def test_stamps_that_come_late_do_not_draw_a_grid_along(late: float, seed: int) -> None:
    """As a contact that bounces behind a link's slots: the others keep the grid to 2 µs."""
    rng = np.random.default_rng(seed)
    period, place = 2008.1024, 0.37
    slots = np.sort(rng.integers(0, 4_000_000, 250))
    after = rng.uniform(0.0, 2.0, 250) + rng.exponential(740.0, 250) * (rng.random(250) < late)
    in_order = np.sort((slots + place) * period + after)

    found = kept_grid(in_order, 1.1 * period)

    assert found is not None
    off = (in_order / found[0] - found[1] + 0.5) % 1.0 - 0.5
    assert np.median(np.abs(off)) * period < 2.0
