"""The grid that recorded numbers keep, beside the one they are believed to be rounded to."""

import numpy as np
import pytest

from skiplatch.diagnosis.scene.pitches import kept_pitch

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
