"""The grid that recorded numbers keep, beside the one they are believed to be rounded to."""

import numpy as np
import pytest

from skiplatch.diagnosis.scene.pitches import kept_pitch, whole_pitches

ANYWHERE = np.random.default_rng(3).normal(0.0, 8.0, 60)


@pytest.mark.parametrize("pitch", [0.2, 0.415, 3.0])
def test_a_coarser_grid_is_found_with_its_pitch(pitch: float) -> None:
    values = np.round(np.rint(ANYWHERE / pitch) * pitch, 3)

    kept = kept_pitch(values, 0.1)

    assert kept is not None
    found, z = kept
    assert found == pytest.approx(pitch, rel=1e-3)
    assert z > 4.5


@pytest.mark.parametrize("seed", range(20))
def test_numbers_of_the_believed_grid_keep_no_coarser_one(seed: int) -> None:
    values = np.round(np.random.default_rng(seed).normal(0.0, 8.0, 60), 1)

    kept = kept_pitch(values, 0.1)

    assert kept is None or kept[1] < 3.0


def test_a_few_values_keep_many_grids() -> None:
    assert kept_pitch(np.tile([0.0, 3.0, 6.0], 20), 0.1) is None
    assert kept_pitch(np.full(5, np.nan), 0.1) is None


@pytest.mark.parametrize("pitch_us", [0.5, 12.0, 2500.0, 90_000.0])
def test_a_clock_may_tick_as_coarsely_as_it_likes(pitch_us: float) -> None:
    ticks = np.random.default_rng(4).integers(0, 10_000, 100)
    stamps_us = np.asarray(pitch_us * ticks, dtype=np.float64)
    stamps_us[50] += 0.25  # one in a hundred may be off

    assert max(whole_pitches(stamps_us, 0.25)) == pitch_us


def test_numbers_of_no_grid_lie_on_two_steps_at_best() -> None:
    steps = np.random.default_rng(5).integers(0, 10_000_000, 100)
    nowhere_us = np.asarray(0.25 * steps, dtype=np.float64)

    assert whole_pitches(nowhere_us, 0.25) == [0.5]
    assert whole_pitches(np.full(3, np.nan), 0.25) == [0.5]
    assert max(whole_pitches(np.array([104_729.0]), 1.0)) == 104_729.0
