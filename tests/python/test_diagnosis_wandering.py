"""What wanders by itself goes with anything slow: an effect has to gain beside it."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played, played_again
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.wandering import beyond_wandering
from skiplatch.simulator.effects import Effect
from standing_fits import standing

LIKE = (0, 1, 2, 3, 9)
"""Seeds of walks that go with each other by more than half."""
ENOUGH = 15.0
"""Nats, as the rule has it."""


@pytest.fixture(scope="module")
def cold() -> Campaign:
    return played(MACHINE)


def wandering(count: int, seed: int) -> FloatArray:
    steps = np.random.default_rng(seed).normal(size=count)
    walk = np.cumsum(steps)
    return np.asarray((walk - walk.mean()) / walk.std())


def warmed_at_random(cold: Campaign, seed: int, *effects: Effect) -> Campaign:
    """A shop whose temperature wanders by a kelvin, and a machine in it."""
    touches = cold.touches
    warm = replace(cold, touches=replace(touches, temp_c=20.0 + wandering(len(touches), seed)))
    return played_again(warm, *effects) if effects else warm


@pytest.mark.parametrize("seed", LIKE[:2])
def test_a_drift_with_the_temperature_gains_beside_what_wanders(cold: Campaign, seed: int) -> None:
    drift = Effect("thermal_drift", {"drift_um_k": 5.0})
    scene = Scene.of(warmed_at_random(cold, seed, drift))

    assert beyond_wandering(scene, standing(scene, drift))["thermal_drift"] > ENOUGH


@pytest.mark.parametrize("seed", LIKE)
def test_one_that_only_resembles_what_wanders_does_not(cold: Campaign, seed: int) -> None:
    """A surface that wanders by 5 µm, held against the temperature that goes with it best."""
    campaign = warmed_at_random(cold, seed)
    touches = campaign.touches
    walk_um = 5.0 * wandering(len(touches), seed + 100)
    warm = touches.temp_c - 20.0
    um_k = float(warm @ walk_um / (warm @ warm))
    moved = replace(touches, deviation_um=touches.deviation_um + touches.sign * walk_um)
    scene = Scene.of(replace(campaign, touches=moved))
    fit = standing(scene, Effect("thermal_drift", {"drift_um_k": um_k}))

    assert abs(um_k) > 2.5
    assert beyond_wandering(scene, fit)["thermal_drift"] < ENOUGH


def test_a_level_is_not_asked_for() -> None:
    backlash = Effect("backlash", {"backlash_um": 8.0})
    scene = Scene.of(played(MACHINE, backlash))
    late = standing(scene, Effect("report_delay", {"delay_us": 400.0}))

    assert beyond_wandering(scene, late) == {}
    assert beyond_wandering(scene, standing(scene, backlash)) == {}


@pytest.mark.parametrize("count", [1, 2, 3, 12])
def test_touches_without_times_of_their_own_wander_no_less(cold: Campaign, count: int) -> None:
    few = cold.touches.select(np.arange(count))
    at_once = replace(cold, touches=replace(few, time_s=np.zeros(count)))
    scene = Scene.of(at_once)
    feed = standing(scene, Effect("following_error", {"lag_us": 900.0}))

    assert all(np.isfinite(gained) for gained in beyond_wandering(scene, feed).values())
