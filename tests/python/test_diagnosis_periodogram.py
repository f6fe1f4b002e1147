"""The periodogram finds the period of an error, and agrees with a slower one from a library."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from played_campaigns import MACHINE, played
from skiplatch.campaign import Axis
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.fit import fit
from skiplatch.diagnosis.scene.periodogram import explained_by_sines, shortest_wave
from skiplatch.diagnosis.scene.scene import Scene

PERIOD_MM, FASTEST_PER_MM = 2.37, 2.0


def positions(rng: np.random.Generator, distinct: int, count: int) -> np.ndarray:
    """So many touches at so many places."""
    return rng.choice(rng.uniform(-150.0, 250.0, distinct), count)


@pytest.mark.parametrize(("distinct", "count"), [(30, 150), (200, 200), (1000, 1000)])
def test_the_period_is_found_and_explains_what_a_library_says(distinct: int, count: int) -> None:
    rng = np.random.default_rng(distinct)
    position = positions(rng, distinct, count)
    error = 3.0 + 5.0 * np.sin(2.0 * np.pi * position / PERIOD_MM + 1.0) + rng.normal(size=count)
    weights = rng.uniform(0.5, 2.0, count)

    per_mm, explained = explained_by_sines(position, error, weights, 0.5, FASTEST_PER_MM)

    span_mm = np.ptp(position)
    assert per_mm[0] == pytest.approx(0.5 / span_mm, abs=0.2 / span_mm)
    assert per_mm[np.argmax(explained)] == pytest.approx(1.0 / PERIOD_MM, abs=0.2 / span_mm)
    some = np.append(np.arange(0, len(per_mm), 50), np.argmax(explained))
    omegas = 2.0 * np.pi * per_mm[some]
    slowly = signal.lombscargle(
        position, error, omegas, weights=weights, floating_mean=True, normalize=True
    )
    np.testing.assert_allclose(explained[some], slowly, atol=0.03)


def test_noise_is_explained_by_no_sine() -> None:
    rng = np.random.default_rng(5)
    position = positions(rng, 1000, 1000)

    _, explained = explained_by_sines(
        position, rng.normal(size=1000), np.ones(1000), 0.5, FASTEST_PER_MM
    )

    assert np.all(explained >= -1e-9)
    assert explained.max() < 0.03  # 2 ln(4000) / 1000 is expected of the best of so many


def test_touches_at_one_place_and_without_error_are_no_failure() -> None:
    _, explained = explained_by_sines(np.ones(20), np.zeros(20), np.ones(20), 0.5, FASTEST_PER_MM)

    assert np.all(explained == 0.0)


@pytest.mark.parametrize("jitter_mm", [0.0, 0.3])
def test_places_that_lie_evenly_tell_no_wave_below_twice_their_spacing(jitter_mm: float) -> None:
    places = 12.5 * np.arange(25) + np.random.default_rng(4).uniform(-jitter_mm, jitter_mm, 25)

    shortest_mm = shortest_wave(np.repeat(places, 3))

    assert 25.0 <= shortest_mm < 1.05 * 25.0


def test_places_that_lie_anywhere_tell_waves_far_below_their_spacing() -> None:
    places = np.random.default_rng(6).uniform(-150.0, 250.0, 40)
    shortest_mm = shortest_wave(places)
    frequencies = np.arange(0.5 / 400.0, 1.0 / shortest_mm, 0.1 / 400.0)

    def design(per_mm: float) -> np.ndarray:
        turn = 2.0 * np.pi * per_mm * places
        return np.column_stack([np.ones(40), np.sin(turn), np.cos(turn)])

    assert shortest_mm < 0.2 * 400.0 / 40.0
    for period_mm in (2.0, 37.0):
        wave = design(1.0 / period_mm)[:, 1]
        others = frequencies[np.abs(frequencies - 1.0 / period_mm) > 1.0 / 400.0]
        left = [np.linalg.lstsq(design(one), wave)[1][0] for one in others]
        assert min(left) > 0.3 * np.sum((wave - wave.mean()) ** 2)


@pytest.mark.parametrize("places", [np.arange(7.0), np.full(50, 3.0), np.arange(30) * 1e-4])
def test_too_few_places_tell_no_wave(places: np.ndarray) -> None:
    assert shortest_wave(places) == np.inf


@pytest.mark.long
@pytest.mark.parametrize(
    ("places", "third_um", "pitch_mm"), [(23, 0.0, 10.0), (31, 3.0, 10.0), (40, 0.0, 2.0)]
)
def test_a_periodic_error_at_few_places_is_found_with_its_higher_orders(
    places: int, third_um: float, pitch_mm: float
) -> None:
    campaign = played(MACHINE)
    touches = campaign.touches.in_order_of_time()
    rng = np.random.default_rng(1)
    places_mm = positions(rng, places, len(touches))
    turn = 2.0 * np.pi * places_mm / pitch_mm
    error_um = 6.0 * np.sin(turn + 0.5) + 5.0 * np.sin(2.0 * turn + 2.0)
    error_um += third_um * np.sin(3.0 * turn + 1.0)
    sign = Scene(campaign.nominal, touches).sign
    disturbed = replace(
        touches, position_mm=places_mm, deviation_um=touches.deviation_um + sign * error_um
    )

    scene = Scene(campaign.nominal, disturbed)
    effect = catalogue()["transmission_error"]
    found = fit(scene, [effect], effect.starts(scene, Change())).parameters[0]

    orders = np.flatnonzero([6.0, 5.0, third_um])
    period_mm, sizes_um, phases_deg = found[1], found[[0, 3, 5]], found[[2, 4, 6]]
    assert period_mm == pytest.approx(pitch_mm, abs=0.01)
    assert sizes_um == pytest.approx((6.0, 5.0, third_um), rel=0.05)
    turned_deg = (phases_deg - np.rad2deg([0.5, 2.0, 1.0]))[orders]
    np.testing.assert_allclose((turned_deg + 180.0) % 360.0 - 180.0, 0.0, atol=10.0)


@pytest.mark.long
def test_periodic_errors_of_two_axes_are_found_with_their_own_sizes_and_phases() -> None:
    campaign = played(MACHINE)
    touches = campaign.touches.in_order_of_time()
    turn = 2.0 * np.pi * touches.position_mm / 10.0
    is_y = touches.axis == Axis.Y
    error_um = np.where(is_y, 3.0 * np.sin(turn + 2.5), 6.0 * np.sin(turn + 0.5))
    sign = Scene(campaign.nominal, touches).sign
    disturbed = replace(touches, deviation_um=touches.deviation_um + sign * error_um)

    scene = Scene(campaign.nominal, disturbed)
    effect = catalogue()["transmission_error"]
    found = fit(scene, [effect], effect.starts(scene, Change())).parameters[0]

    assert 20 < is_y.sum() < len(touches) - 20
    assert found[:2] == pytest.approx((6.0, 10.0), rel=0.02)
    assert found[7] == pytest.approx(-0.5, abs=0.02)
    assert found[9] % 360.0 == pytest.approx(np.rad2deg(2.0), abs=3.0)
