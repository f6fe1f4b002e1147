"""``skiplatch repeat``: how often it tells what is not there, and what is."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Nominal, Touches, read_campaign
from skiplatch.commands.repeat import as_json
from skiplatch.repeatability import Repeatability, repeatability
from skiplatch.repeatability_words import sentence

RESOLUTION_UM = 0.1
DRAWS = 500
CHANCE = {"first": 0.01, "order": 0.01, "outlier": 0.05}
LUCK = 3.3  # standard errors: one in a thousand


@cache
def nominal_of(folder: Path) -> Nominal:
    return read_campaign(folder).nominal


def of(
    folder: Path, off_um: Sequence[float] | FloatArray, step_um: float = RESOLUTION_UM
) -> Repeatability:
    """Work out touches downwards along Z of one surface."""
    believed, n = nominal_of(folder), len(off_um)
    touches = Touches.from_columns(
        touch=np.arange(n), axis=np.full(n, 2), sign=np.full(n, -1), deviation_um=np.array(off_um)
    )
    nominal = replace(believed, axis=replace(believed.axis, resolution_um=step_um))
    return repeatability(Campaign(nominal, touches, folder))


def rates(folder: Path, effect: FloatArray, step: float, draws: int) -> dict[str, float]:
    """Give how often each is told of normal noise of 1 µm and an effect, rounded to a step."""
    rng = np.random.default_rng(len(effect))
    told = {"first": 0, "order": 0, "outlier": 0}
    for _ in range(draws):
        y = effect + rng.normal(size=len(effect))
        found = of(folder, np.round(y / step) * step, step)
        told["first"] += "first" in found.told
        told["order"] += "order" in found.told
        told["outlier"] += bool(found.outliers)
    return {name: count / draws for name, count in told.items()}


def too_often(found: dict[str, float], draws: int) -> dict[str, float]:
    most = {
        name: chance + LUCK * np.sqrt(chance * (1.0 - chance) / draws)
        for name, chance in CHANCE.items()
    }
    return {name: rate for name, rate in found.items() if rate > most[name]}


@pytest.mark.parametrize(
    ("n", "step"),
    [
        pytest.param(n, step, marks=pytest.mark.long if n == 10 else pytest.mark.nightly)
        for n in (5, 10, 20)
        for step in (1e-3, 2.0)
    ],
)
def test_noise_shows_nothing_more_often_than_stated(
    machine_sample: Path, n: int, step: float
) -> None:
    found = rates(machine_sample, np.zeros(n), step, DRAWS)

    assert too_often(found, DRAWS) == {}


def test_a_few_draws_of_noise_show_nothing_more_often_than_stated(machine_sample: Path) -> None:
    found = rates(machine_sample, np.zeros(10), 2.0, 50)

    assert too_often(found, 50) == {}


@pytest.mark.long
def test_what_is_there_is_told(machine_sample: Path) -> None:
    order = np.arange(20)

    first = rates(machine_sample, 5.0 * (order == 0), 1e-3, 100)
    drift = rates(machine_sample, 4.0 * order / order.max(), 1e-3, 100)
    far = rates(machine_sample, 10.0 * (order == 7), 1e-3, 100)

    assert first["first"] > 0.85
    assert drift["order"] > 0.9
    assert far["outlier"] > 0.9


def test_one_step_of_readings_is_scatter(machine_sample: Path) -> None:
    off = [0.0, *[-12.5] * 4, *[0.0] * 5]

    found = of(machine_sample, off)

    assert (found.outliers, found.told) == ((), frozenset())
    assert found.sigma.value == pytest.approx(np.std(off, ddof=1))
    assert sentence(found).count(";") == 0


def test_steps_of_a_coarse_axis_are_no_outliers_beside_a_finer_one(machine_sample: Path) -> None:
    n = 24
    coarse = np.zeros(n)
    coarse[[2, 10, 15, 20]] = [-3.125, 3.125, 3.125, -3.125]
    fine = np.tile([-1.25, 0.0, 0.0, 1.25], n // 4)
    off_um = np.concatenate([coarse, np.zeros(n), fine])
    with_one_far = np.where(np.arange(3 * n) == 10, 31.25, off_um)

    steps, far = (of_three_axes(machine_sample, each) for each in (off_um, with_one_far))

    assert (steps.outliers, far.outliers) == ((), (10,))


def of_three_axes(folder: Path, off_um: FloatArray) -> Repeatability:
    n = len(off_um)
    touches = Touches.from_columns(
        touch=np.arange(n), axis=np.repeat([0, 1, 2], n // 3), deviation_um=off_um
    )
    return repeatability(Campaign(nominal_of(folder), touches, folder))


def test_of_five_touches_no_first_is_told(machine_sample: Path) -> None:
    found = of(machine_sample, [-63.5, 38.1, 25.4, -38.1, -25.4])

    assert (found.first, found.outliers, found.told) == (None, (), frozenset())
    assert found.sigma.value == pytest.approx(43.0, abs=0.2)


def test_one_quantum_off_is_no_first_touch(machine_sample: Path) -> None:
    found = of(machine_sample, [2.0, 0.0, 0.0, 0.0, 0.0], 2.5)

    assert (found.first, found.outliers, found.told) == (None, (), frozenset())


def test_a_first_touch_that_only_a_line_makes_is_not_told(machine_sample: Path) -> None:
    z_um = np.array([145, 302.5, 452.5, 692.5, 927.5, 1282.5, 1772.5, 2140, 2450, 2887.5])

    found = of(machine_sample, -z_um)

    assert found.told == {"order"}
    assert found.plain == pytest.approx(np.std(z_um, ddof=1))


def test_way_is_told_in_the_coordinate_of_the_machine(machine_sample: Path) -> None:
    rising = -3.0 * np.arange(20) + np.random.default_rng(4).normal(0.0, 1.0, 20)

    found = of(machine_sample, rising)

    assert "a touch, less far along the approach (Z rises)" in sentence(found)
    assert f"all touches as they are scatter by {found.plain:.1f} µm" in sentence(found)
    assert as_json(found)["plain_sigma_um"] == pytest.approx(np.std(rising, ddof=1))
    assert as_json(found)["told"] == ["drift"]


def test_an_accident_in_a_short_series_is_an_outlier(machine_sample: Path) -> None:
    off = [0.0, 12.5, 12.5, 1512.5, 12.5, 0.0, 0.0, 0.0, 0.0, 0.0]

    assert of(machine_sample, off).outliers == (3,)


def drifting(seed: int) -> np.ndarray:
    return 0.2 * np.arange(40.0) + np.random.default_rng(seed).normal(0.0, 0.85, 40)


def test_first_touch_is_told_beside_a_drift_and_an_outlier(machine_sample: Path) -> None:
    um = drifting(3)
    um[0] += 8.0
    um[17] += 40.0

    found = of(machine_sample, um)

    assert "first" in found.told
    assert found.first is not None
    assert found.first.low <= 8.0 <= found.first.high
    assert found.outliers == (17,)


def test_drift_alone_makes_no_first_touch(machine_sample: Path) -> None:
    told = sum("first" in of(machine_sample, drifting(seed)).told for seed in range(200))

    assert told <= 8  # 1 % each


def test_the_first_of_touches_that_are_off_now_and_then_is_one_of_them(
    machine_sample: Path,
) -> None:
    um = np.random.default_rng(5).normal(0.0, 1.0, 100)
    um[::12] += 60.0

    found = of(machine_sample, um)

    assert found.first is None
    assert 0 in found.outliers
