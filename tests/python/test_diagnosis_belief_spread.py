"""Intervals of parameters beside beliefs that are uncertain, on campaigns that are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from played_campaigns import MACHINE, played_again
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis.fit import belief_spread
from skiplatch.diagnosis.fit.belief_spread import beside_beliefs
from skiplatch.diagnosis.fit.beliefs import SCAN_PERIOD, Belief, Key, believing, uncertain
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.intervals import Estimate, estimates
from skiplatch.diagnosis.fit.surface import CONFIDENCE
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect
from standing_fits import standing, whole

TRIGGER = Effect("trigger_delay", {"delay_us": 150.0})
LOBES = Effect("pretravel_lobing", {"amplitude_um": 3.0, "azimuth_deg": 50.0})
BELIEVED_DELAY: Key = ("probe", "delay_us")
BELIEVED_LOBES: Key = ("probe", "lobe_um")
U_US = 20.0
RARE = 2e-3
"""False-alarm rate of the coverage test; its seeds are fixed."""


def both_ways(campaign: Campaign, truth: Effect, *beliefs: Belief) -> tuple[Estimate, Estimate]:
    """The effect beside certain beliefs, and beside uncertain ones."""
    scene = Scene.of(campaign)
    found = standing(scene, truth)
    alone = estimates(scene, found, [whole(truth)])
    (wider,) = beside_beliefs(scene, found, alone, beliefs)
    return alone[0], wider


def test_a_delay_is_known_no_better_than_what_it_is_on_top_of() -> None:
    belief = Belief(BELIEVED_DELAY, 500.0, U_US, is_noise=False)
    campaign = played_again(read_campaign(MACHINE), TRIGGER)
    assert campaign.nominal.probe.delay_us == belief.value

    alone, wider = both_ways(campaign, TRIGGER, belief)

    low, high = wider.intervals["delay_us"]
    value = wider.effect.parameters["delay_us"]
    half_us = U_US * stats.norm.ppf((1.0 + CONFIDENCE) / 2.0)
    closest = alone.intervals["delay_us"]
    assert value == alone.effect.parameters["delay_us"]
    assert high - value == pytest.approx(np.hypot(half_us, closest[1] - value), rel=0.05)
    assert value - low == pytest.approx(np.hypot(half_us, value - closest[0]), rel=0.05)
    assert wider.cloud is not None
    spread_us = np.sqrt(np.cov(wider.cloud.points[:, 0], aweights=wider.cloud.weights))
    assert spread_us == pytest.approx(U_US, rel=0.25)


def test_noise_and_certain_beliefs_widen_nothing() -> None:
    campaign = played_again(read_campaign(MACHINE), TRIGGER)
    noise = [belief for belief in uncertain(campaign.nominal) if belief.is_noise]

    alone, same = both_ways(campaign, TRIGGER, *noise)

    assert noise
    assert same.intervals == alone.intervals


def test_what_touches_know_of_a_belief_is_no_longer_open() -> None:
    """Scans over an hour tell their period far better than any data sheet."""
    campaign = played_again(read_campaign(MACHINE), TRIGGER)
    period = Belief(("plc", "scan_us"), campaign.nominal.plc.scan_us, 5.0, is_noise=False)

    alone, wider = both_ways(campaign, TRIGGER, period)

    assert wider.intervals["delay_us"] == pytest.approx(alone.intervals["delay_us"], abs=2.0)


def test_a_belief_that_is_known_closely_moves_no_further_than_that_costs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A likelihood that is flat at its peak, and the same anywhere far off, is no normal law."""
    known, slope_us = 5e-5, 1e3  # standard uncertainties of the belief; µs of delay for each

    def beside(
        _scene: Scene, _found: Fit, _belief: Belief, place: float
    ) -> tuple[FloatArray, float]:
        nats = 0.1 * place / known - min((place / known) ** 4, 1400.0)
        return np.array([150.0 + slope_us * place, 0.0, 0.0]), nats

    campaign = played_again(read_campaign(MACHINE), TRIGGER)
    value = campaign.nominal.plc.scan_us
    alone, _ = both_ways(campaign, TRIGGER)
    monkeypatch.setattr(belief_spread, "_beside", beside)
    _, wider = both_ways(campaign, TRIGGER, Belief(SCAN_PERIOD, value, 5.0, is_noise=False))

    closest, (low, high) = (one.intervals["delay_us"] for one in (alone, wider))
    assert alone.cloud is not None
    assert wider.cloud is not None
    more_us = (wider.cloud.points - alone.cloud.points)[:, 0].std() / slope_us
    assert known / 2.0 < more_us < 2.0 * known
    assert low - closest[0] == pytest.approx(0.0, abs=slope_us * 4.0 * known)
    assert high - closest[1] == pytest.approx(0.0, abs=slope_us * 4.0 * known)


@pytest.mark.long
def test_intervals_cover_beside_lobes_that_are_believed_wrong() -> None:
    recorded = read_campaign(MACHINE)
    nominal = believing(recorded.nominal, {BELIEVED_LOBES: 8.0})
    belief = Belief(BELIEVED_LOBES, 8.0, 0.4, is_noise=False)
    rng = np.random.default_rng(3)
    covered, missed_alone = [], 0
    for seed in range(30):
        real_um = 8.0 + 0.4 * float(rng.standard_normal())
        real = replace(recorded, nominal=believing(nominal, {BELIEVED_LOBES: real_um}))
        campaign = replace(played_again(real, LOBES, seed=seed), nominal=nominal)
        alone, wider = both_ways(campaign, LOBES, belief)
        for name, value in LOBES.parameters.items():
            low, high = wider.intervals[name]
            covered.append(low <= value <= high)
            missed_alone += not alone.intervals[name][0] <= value <= alone.intervals[name][1]

    fewest, most = stats.binom.interval(1.0 - RARE, len(covered), CONFIDENCE)
    assert fewest <= sum(covered) <= most
    assert missed_alone > 2 * (len(covered) - sum(covered))
