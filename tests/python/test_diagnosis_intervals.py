"""What a diagnosis leaves open of each parameter, on campaigns whose parameters are known."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from played_campaigns import BENCH, MACHINE, played
from skiplatch.diagnosis.fit.intervals import Estimate, estimates, settled
from skiplatch.diagnosis.fit.surface import CONFIDENCE
from skiplatch.diagnosis.reported.samples import samples
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.simulator.effects import Effect, effects
from standing_fits import standing, whole

RARE = 2e-3
"""False-alarm rate of the coverage test; its seeds are fixed."""
DELAY = Effect("trigger_delay", {"delay_us": 150.0})
LAG = Effect("following_error", {"lag_us": 300.0})
LOBES = Effect("pretravel_lobing", {"amplitude_um": 3.0, "azimuth_deg": 50.0})


def estimated(scene: Scene, *begun: Effect, slack: float = 0.0) -> list[Estimate]:
    found = standing(scene, *begun, slack=slack)
    return estimates(scene, found, tuple(map(whole, begun)))


def off(effect: Effect, by: float) -> Effect:
    return Effect(effect.id, {name: value * by for name, value in effect.parameters.items()})


def width(interval: tuple[float, float]) -> float:
    return interval[1] - interval[0]


@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param(range(100, 110), marks=pytest.mark.long),
        pytest.param(range(100, 120), marks=pytest.mark.nightly),
    ],
)
def test_intervals_cover_as_often_as_they_say(seeds: range) -> None:
    covered, errors, halves = [], [], []
    for truth in (DELAY, LAG, LOBES):
        for seed in seeds:
            scene = Scene.of(played(MACHINE, truth, seed=seed))
            (found,) = estimated(scene, off(truth, 1.01))
            for name, value in truth.parameters.items():
                low, high = found.intervals[name]
                covered.append(low <= value <= high)
                errors.append(found.effect.parameters[name] / value - 1.0)
                halves.append((high - low) / value / 2.0)

    fewest, most = stats.binom.interval(1.0 - RARE, len(covered), CONFIDENCE)
    assert fewest <= sum(covered) <= most
    assert np.median(np.abs(errors)) < 0.03
    sigmas = np.array(errors) / np.array(halves) * stats.norm.ppf((1.0 + CONFIDENCE) / 2.0)
    assert 0.75 < np.sqrt(np.mean(sigmas**2)) < 1.3  # not wider than they need be either


@pytest.mark.parametrize(
    "truth",
    [
        Effect("isr_latency", {"latency_us": 12.0, "jitter_us": 6.0}),
        Effect("scan_period", {"period_us": 137.0}),
        Effect("encoder_quantisation", {"resolution_um": 1.5}),
        Effect("contact_bounce", {"probability": 0.3, "mean_us": 250.0}),
        Effect("thermal_drift", {"drift_um_k": 1.5, "lag_s": 900.0}),
    ],
    ids=lambda truth: truth.id,
)
def test_intervals_hold_their_value_and_stay_in_the_range_of_the_table(truth: Effect) -> None:
    (found,) = estimated(Scene.of(played(BENCH, truth)), truth)

    for parameter in effects()[truth.id].parameters:
        low, high = found.intervals[parameter.name]
        value = found.effect.parameters[parameter.name]
        assert parameter.low <= low <= value <= high <= parameter.high, parameter.name
    for name, value in truth.parameters.items():
        assert found.effect.parameters[name] == pytest.approx(value, rel=0.5)


@pytest.mark.long
def test_an_effect_that_does_the_same_leaves_a_parameter_open() -> None:
    scene = Scene.of(played(MACHINE, DELAY))
    (alone,) = estimated(scene, DELAY)

    together, _ = estimated(scene, off(DELAY, 0.5), Effect("following_error", {"lag_us": 75.0}))

    assert width(together.intervals["delay_us"]) > 10.0 * width(alone.intervals["delay_us"])


def test_slack_widens_an_interval() -> None:
    scene = Scene.of(played(MACHINE, LAG))
    (firm,) = estimated(scene, LAG)
    (loose,) = estimated(scene, LAG, slack=0.4)

    assert width(loose.intervals["lag_us"]) > 1.5 * width(firm.intervals["lag_us"])


def test_samples_lie_as_the_intervals_say() -> None:
    (found,) = estimated(Scene.of(played(MACHINE, LAG)), LAG)
    named = Named(found.effect, "", found.intervals, (), 0.9, cloud=found.cloud)

    drawn = samples([named], 4000, seed=1)

    low, high = found.intervals["lag_us"]
    first, last = np.quantile(drawn["following_error.lag_us"], [0.05, 0.95])
    assert low <= first <= last <= high
    assert last - first > 0.6 * (high - low)
    scatter_us = drawn["following_error.scatter_us"]  # held at 0 by the search, sampled after it
    assert 0.0 <= scatter_us.min() < scatter_us.max()


def azimuth(scene: Scene, begun: Mapping[str, float]) -> Estimate:
    (found,) = estimated(scene, Effect("pretravel_lobing", begun))
    return found


def test_nothing_is_known_of_the_azimuth_of_lobes_that_are_not_there() -> None:
    found = azimuth(Scene.of(played(MACHINE)), {"amplitude_um": 0.01, "azimuth_deg": 50.0})

    assert found.intervals["azimuth_deg"] == (0.0, 120.0)
    assert 0.0 <= found.intervals["amplitude_um"][0] <= found.intervals["amplitude_um"][1] < 0.3


def test_an_interval_may_pass_the_end_of_the_turn() -> None:
    truth = {"amplitude_um": 3.0, "azimuth_deg": 119.9}
    scene = Scene.of(played(MACHINE, Effect("pretravel_lobing", truth)))
    found = azimuth(scene, truth)
    low, high = found.intervals["azimuth_deg"]

    assert 0.0 <= found.effect.parameters["azimuth_deg"] < 120.0
    assert low <= found.effect.parameters["azimuth_deg"] <= high
    assert 0.2 < high - low < 4.0
    assert any(low <= 119.9 + turn <= high for turn in (-120.0, 0.0))
    assert high > 120.0 or low < 0.0


@pytest.mark.parametrize(
    ("folder", "truth", "by"),
    [
        (MACHINE, DELAY, 1.1),
        (BENCH, Effect("thermal_drift", {"drift_um_k": 1.5, "lag_s": 900.0}), 1.1),
    ],
    ids=["near", "fifty widths off"],
)
def test_estimates_begin_from_a_fit_to_other_touches(
    folder: Path, truth: Effect, by: float
) -> None:
    scene = Scene.of(played(folder, truth))
    (near,) = estimated(scene, truth)
    (far,) = estimated(scene, off(truth, by))

    for name in truth.parameters:
        whole_width = width(near.intervals[name])
        reached = far.effect.parameters[name]
        assert reached == pytest.approx(near.effect.parameters[name], abs=0.3 * whole_width)
        assert width(far.intervals[name]) == pytest.approx(whole_width, rel=0.4)


def test_a_fit_to_other_touches_is_settled_on_these() -> None:
    clock = Effect("timer_drift", {"drift_ppm": -20.0, "warmth_ppm_k": -2.0})
    scene = Scene.of(played(BENCH, clock))

    (found,) = settled(scene, standing(scene, off(clock, 1.00001))).parameters

    # After hours a clock is known to many digits; what the search held at 0 stays there.
    assert found == pytest.approx([-20.0, 0.0, -2.0], rel=2e-6)
    assert found[1] == 0.0
