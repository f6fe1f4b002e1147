"""Waves in values of touches, and how likely the best of many frequencies comes by chance."""

import numpy as np
import pytest
from scipy import signal

from skiplatch.diagnosis.candidates.waves import _tops
from skiplatch.diagnosis.plays.left import CHANCE
from skiplatch.diagnosis.plays.setting import Place
from skiplatch.diagnosis.plays.waves import FEWEST_FOR_FAST, best_wave, waves_along

SPAN_S = 900.0
TOUCHES = 300


def irregular(rng: np.random.Generator) -> np.ndarray:
    return np.sort(rng.uniform(0.0, SPAN_S, TOUCHES))


@pytest.mark.parametrize("period_s", [0.02, 0.0101, 1.7])
def test_irregular_touches_tell_waves_of_which_thousands_lie_between_two(period_s: float) -> None:
    rng = np.random.default_rng(1)
    time_s = irregular(rng)
    hum = 1.2 * np.sin(2.0 * np.pi * time_s / period_s + 0.3) + rng.normal(size=TOUCHES)

    _, _, slow_z = best_wave(time_s, hum, 0.0) or (0.0, 0.0, 0.0)
    found, share, z = best_wave(time_s, hum, 0.0, is_fast=True) or (0.0, 0.0, 0.0)

    assert slow_z < 3.0
    assert found == pytest.approx(period_s, rel=1e-4)
    assert share == pytest.approx(1.2**2 / 2.0 / (1.2**2 / 2.0 + 1.0), abs=0.12)
    assert z > 6.0


@pytest.mark.parametrize("is_fast", [False, True])
def test_noise_has_a_wave_no_more_often_than_its_errors_say(is_fast: bool) -> None:
    rng = np.random.default_rng(2)
    shortest_s = 0.5 if is_fast else 0.0
    errors = [
        found[2]
        for _ in range(400)
        if (
            found := best_wave(
                irregular(rng), rng.normal(size=TOUCHES), shortest_s, is_fast=is_fast
            )
        )
    ]

    assert len(errors) == 400
    assert np.mean(np.array(errors) > 1.645) == pytest.approx(0.05, abs=0.03)


def test_no_wave_is_faster_than_the_places_tell() -> None:
    time_s = irregular(np.random.default_rng(3))
    hum = np.sin(2.0 * np.pi * time_s / 0.5)

    period_s, share, _ = best_wave(time_s, hum, 0.6, is_fast=True) or (0.0, 1.0, 0.0)

    assert period_s >= 0.6
    assert share < 0.3


def test_a_wave_along_a_line_is_told_in_its_unit_for_the_rows_that_have_values() -> None:
    rng = np.random.default_rng(4)
    where_mm = rng.uniform(-200.0, 200.0, TOUCHES)
    sense = rng.choice([-1.0, 1.0], TOUCHES)
    rows = rng.random(TOUCHES) < 0.8
    values = (sense * np.cos(2.0 * np.pi * where_mm / 2.0) + rng.normal(0, 0.5, TOUCHES))[rows]

    (found,) = waves_along(
        [Place("position", "mm", where_mm, sense, 0.1)], rows, values, is_fast=True
    )

    assert found.words == ("position, in waves of 2 mm",)
    assert found.z > 6.0


def test_few_touches_tell_no_wave_of_so_many() -> None:
    rng = np.random.default_rng(5)
    time_s = np.sort(rng.uniform(0.0, SPAN_S, FEWEST_FOR_FAST - 1))
    hum = np.sin(2.0 * np.pi * time_s / 0.02)

    assert best_wave(time_s, hum, 0.0, is_fast=True) is None
    assert best_wave(time_s, hum, 0.0) is not None


@pytest.mark.parametrize("kind", ["even", "two values"])
def test_so_few_touches_are_enough_whatever_the_law_of_their_noise(kind: str) -> None:
    """Twenty were not: a wave of 27 ms in what was rounded refused a drift that was there."""
    rng = np.random.default_rng(9)
    errors = []
    for _ in range(40):
        noise = rng.uniform(-1.0, 1.0, FEWEST_FOR_FAST)
        values = noise if kind == "even" else np.sign(noise)
        places = rng.uniform(0.0, SPAN_S, FEWEST_FOR_FAST)
        errors.append((best_wave(places, values, 0.02, is_fast=True) or (0.0, 0.0, np.inf))[2])

    assert max(errors) < CHANCE


def test_tops_are_those_that_scipy_finds_flat_ones_too() -> None:
    rng = np.random.default_rng(1)
    for n in range(60):
        for values in (rng.random(n), rng.integers(0, 4, n).astype(float)):
            padded = np.pad(values, 1)
            np.testing.assert_array_equal(_tops(padded), signal.find_peaks(padded)[0])
