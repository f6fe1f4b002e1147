"""``skiplatch repeat``: what goes with a thermometer, and how sure that is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Touches, read_campaign
from skiplatch.commands.repeat import as_json
from skiplatch.repeatability import Repeatability, repeatability
from skiplatch.repeatability_words import sentence

DRAWS = 25
MOST_BY_CHANCE = 2  # of the draws, of what has a chance of 1 %: more come once in 500
MOST_BESIDE = 5  # of the draws, of intervals of 95 %: more come once in 800


def of(folder: Path, off_um: FloatArray, **thermometers: FloatArray) -> Repeatability:
    touches = Touches.from_columns(
        touch=np.arange(len(off_um)), deviation_um=off_um, thermometers=thermometers
    )
    return repeatability(replace(read_campaign(folder), touches=touches))


def test_sentence_says_the_scatter_without_the_temperature(machine_sample: Path) -> None:
    rng = np.random.default_rng(1)
    warm_c = 21.0 + np.sin(np.arange(120) / 9.0)

    found = of(machine_sample, rng.normal(0.0, 1.0, 120) + 4.0 * warm_c, frame=warm_c)

    assert "they go with the temperature (frame), by 3.9" in sentence(found)
    assert "and without that σ = 0.8" in sentence(found)
    document = as_json(found)
    assert document["thermometer"] == "frame"
    assert document["sigma_without_temperature_um"] == pytest.approx(1.0, abs=0.2)
    assert document["sigma_um"] > 2.0


def test_a_drift_and_a_temperature_that_rise_together_are_not_told_both(
    machine_sample: Path,
) -> None:
    rng = np.random.default_rng(4)
    warm_c = 25.0 + 0.5 * np.arange(80.0) + np.sin(np.arange(80) / 9.0)

    found = of(machine_sample, rng.normal(0.0, 1.0, 80) + 4.0 * warm_c, bed=warm_c)

    assert "; in place of that drift, the temperature (bed) tells more: by 4." in sentence(found)
    assert "they go with" not in sentence(found)


def test_scatter_of_each_surface_about_its_own_middle_counts(machine_sample: Path) -> None:
    rng, warm_c = np.random.default_rng(2), np.repeat(21.0 + np.sin(np.arange(40.0)), 3)
    places = np.tile([0.0, 100.0, 200.0], 40)
    off_um = rng.normal(0.0, 1.0, 120) + 4.0 * warm_c + places

    touches = Touches.from_columns(
        touch=np.arange(120), deviation_um=off_um, position_mm=places, temp_c=warm_c
    )
    found = repeatability(replace(read_campaign(machine_sample), touches=touches))

    (warmth,) = found.warmth.values()
    assert warmth.is_told
    assert warmth.slope.low < 4.0 < warmth.slope.high
    assert warmth.sigma.low < 1.0 < warmth.sigma.high


def test_touches_of_one_reading_count_as_one(machine_sample: Path) -> None:
    """Each dozen touches has a reading, and an offset, of its own; neither knows of the other."""
    told = beside = 0
    rng = np.random.default_rng(3)
    for _ in range(DRAWS):
        warm_c, off_um = (np.repeat(rng.normal(size=12), 10) for _ in range(2))
        found = of(machine_sample, 3.0 * off_um + rng.normal(size=120), bed=60.0 + warm_c)
        told += found.warmth["bed"].is_told
        beside += not found.per_kelvin["bed"].low < 0.0 < found.per_kelvin["bed"].high

    assert told <= MOST_BY_CHANCE
    assert beside <= MOST_BESIDE


def test_best_of_several_thermometers_is_no_better_than_stated(machine_sample: Path) -> None:
    beside = 0
    rng = np.random.default_rng(4)
    for _ in range(DRAWS):
        names = [f"t{i}" for i in range(8)]
        found = of(
            machine_sample, rng.normal(size=40), **{name: rng.normal(size=40) for name in names}
        )
        beside += any(not s.low < 0.0 < s.high for s in found.per_kelvin.values())

    assert beside <= MOST_BESIDE


def test_two_drifts_that_know_nothing_of_each_other_are_seldom_told(machine_sample: Path) -> None:
    told = 0
    rng = np.random.default_rng(5)
    for _ in range(DRAWS):
        warm_c, off_um = (rng.normal(size=(2, 100)) * 0.1).cumsum(axis=1)
        found = of(machine_sample, off_um + rng.normal(0.0, 0.01, 100), room=21.0 + warm_c)
        told += found.warmth["room"].is_told

    assert told <= MOST_BESIDE


def test_few_readings_tell_no_slope(machine_sample: Path) -> None:
    warm_c = np.repeat([20.0, 21.0, 22.0], 20)

    found = of(machine_sample, np.random.default_rng(6).normal(size=60), bed=warm_c)

    assert found.warmth == {}
    assert "temperature" not in sentence(found)


def test_growth_is_told_from_what_goes_with_the_feed(machine_sample: Path) -> None:
    """Fast touches were made while it was warmer: a delay that is fitted alone takes both."""
    fast = np.arange(120) // 12 % 2 == 1
    warm_c = 21.0 + np.sin(np.arange(120) / 9.0) + fast
    feed = np.where(fast, 600.0, 120.0)
    off_um = np.random.default_rng(7).normal(0.0, 1.0, 120) + 4.0 * warm_c + 2.0 * feed / 60.0

    touches = Touches.from_columns(
        touch=np.arange(120), deviation_um=off_um, feed_mm_min=feed, temp_c=warm_c
    )
    found = repeatability(replace(read_campaign(machine_sample), touches=touches))

    assert found.per_kelvin["machine"].low < 4.0 < found.per_kelvin["machine"].high
