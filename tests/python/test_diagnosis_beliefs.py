"""Beliefs that are uncertain move to where the touches have them, and no farther than may be."""

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played_again
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.belief_fit import CLOSE, FARTHEST, fit_beliefs
from skiplatch.diagnosis.fit.beliefs import (
    LOBES_U,
    NOISE_U,
    Belief,
    Key,
    believing,
    uncertain,
)
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene

REPEATABILITY = ("probe", "repeatability_um")
PRETRAVEL = ("probe", "pretravel_um")
DELAY = ("probe", "delay_us")
SCAN = ("plc", "scan_us")
ACCELERATION = ("axis", "accel_mm_s2")
LATENCY = ("report", "latency_us")
JITTER = ("report", "jitter_us")


def believed(campaign: Campaign, **u: float) -> Campaign:
    """A campaign with uncertainties of "section__name"."""
    given = {(name.split("__")[0], name.split("__")[1]): value for name, value in u.items()}
    return replace(campaign, nominal=replace(campaign.nominal, uncertainty=given))


def as_played(folder_truth: Campaign, wrong: Mapping[Key, float]) -> Campaign:
    """Touches as the campaign's chain makes them, believed to be of another."""
    campaign = played_again(folder_truth)
    return replace(campaign, nominal=believing(campaign.nominal, wrong))


def belief_of(beliefs: list[Belief], key: Key) -> Belief:
    return next(belief for belief in beliefs if belief.key == key)


def now(scene: Scene, belief: Belief) -> float:
    fitted = fit_beliefs(scene, Change(), [belief])
    return float(getattr(getattr(fitted.nominal, belief.key[0]), belief.key[1]))


def test_all_noise_and_the_lobes_are_uncertain_and_named_as_in_the_file() -> None:
    machine, bench = (uncertain(read_campaign(folder).nominal) for folder in (MACHINE, BENCH))

    assert [b.name for b in machine] == [
        "probe.repeatability_um",
        "skip.jitter_us",
        "report.jitter_us",
        "probe.lobe_um",
        "skip.latency_us",
        "report.latency_us",
    ]
    assert [b.name for b in bench] == [
        "bench.reference_jitter_us",
        "skip.jitter_us",
        "report.jitter_us",
        "skip.latency_us",
        "report.latency_us",
    ]
    *noise, lobes, skip, report = machine
    assert all(b.is_noise and b.u == NOISE_U for b in (*noise, *bench, skip, report))
    assert lobes.u == LOBES_U * lobes.value


def test_noise_of_nothing_is_certain() -> None:
    nominal = read_campaign(MACHINE).nominal
    none = replace(nominal, skip=replace(nominal.skip, jitter_us=0.0))

    assert ("skip", "jitter_us") not in [b.key for b in uncertain(none)]


def test_a_number_with_an_uncertainty_is_fitted_and_a_noise_with_one_has_that() -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=20.0, probe__repeatability_um=0.034)
    beliefs = uncertain(campaign.nominal)
    delay, noise = belief_of(beliefs, DELAY), belief_of(beliefs, REPEATABILITY)

    assert (delay.value, delay.u, delay.is_noise) == (500.0, 20.0, False)
    assert noise.is_noise
    assert noise.u == pytest.approx(0.1, rel=0.01)
    assert noise.u_absolute == pytest.approx(0.034)
    assert len([b for b in beliefs if b.key == REPEATABILITY]) == 1


def test_an_uncertainty_of_nothing_makes_a_noise_certain() -> None:
    beliefs = uncertain(believed(read_campaign(MACHINE), probe__repeatability_um=0.0).nominal)

    assert REPEATABILITY not in [b.key for b in beliefs]


@pytest.mark.parametrize("is_noise", [True, False])
def test_a_value_so_many_uncertainties_away_is_so_many_away(is_noise: bool) -> None:
    belief = Belief(PRETRAVEL, 6.0, 0.3, is_noise)

    for uncertainties in (-2.0, 0.0, 1.5):
        value = belief.moved(uncertainties)
        assert value > 0.0
        assert belief.uncertainties(value) == pytest.approx(uncertainties)


@pytest.mark.parametrize("factor", [1.5, 1.0 / 1.5])
def test_noise_believed_wrong_by_half_moves_to_where_it_is(factor: float) -> None:
    recorded = read_campaign(MACHINE)
    nominal = believing(recorded.nominal, {REPEATABILITY: 2.0})
    truth = replace(recorded, nominal=nominal)
    scene = Scene.of(as_played(truth, {REPEATABILITY: 2.0 * factor}))
    (belief,) = [b for b in uncertain(scene.nominal) if b.key == REPEATABILITY]

    assert belief.value == pytest.approx(2.0 * factor)
    assert now(scene, belief) == pytest.approx(2.0, rel=0.12)


def test_a_number_believed_wrong_moves_to_where_it_is() -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=20.0)
    scene = Scene.of(as_played(campaign, {DELAY: 470.0}))

    found = now(scene, belief_of(uncertain(scene.nominal), DELAY))

    assert found == pytest.approx(500.0, abs=8.0)


def test_a_period_is_found_whose_peak_is_far_sharper_than_its_uncertainty() -> None:
    """Stamps over the campaign tell it to a millionth: a search by the uncertainty misses it."""
    campaign = believed(read_campaign(BENCH), plc__scan_us=0.4)
    right_us = campaign.nominal.plc.scan_us
    scene = Scene.of(as_played(campaign, {SCAN: right_us - 0.37}))

    found = now(scene, belief_of(uncertain(scene.nominal), SCAN))

    assert found == pytest.approx(right_us, abs=2e-3)


def test_stamps_that_a_drifting_clock_reads_tell_the_period_without_the_drift() -> None:
    campaign = believed(read_campaign(BENCH), plc__scan_us=0.4)
    scene = Scene.of(as_played(campaign, {}))
    drift = Change(stamp_us=-9e-5 * scene.touches.latch_us)
    stamps = scene.touches.latch_us + drift.stamp_us
    drifted = Scene.of(replace(campaign, touches=replace(scene.touches, latch_us=stamps)))

    found = fit_beliefs(drifted, drift, [belief_of(uncertain(scene.nominal), SCAN)])

    assert found.nominal.plc.scan_us == pytest.approx(campaign.nominal.plc.scan_us, abs=2e-3)


def test_an_acceleration_is_found_as_closely_as_the_edges_tell_it() -> None:
    campaign = believed(read_campaign(BENCH), axis__accel_mm_s2=60.0)
    right = campaign.nominal.axis.accel_mm_s2
    scene = Scene.of(as_played(campaign, {ACCELERATION: right + 55.0}))

    found = now(scene, belief_of(uncertain(scene.nominal), ACCELERATION))

    assert found == pytest.approx(right, rel=1e-4)


def test_noise_hides_nothing_that_another_belief_explains() -> None:
    """A report that is later by some of its jitter is a latency, and no more jitter."""
    campaign = believed(read_campaign(BENCH), report__latency_us=20.0)
    right_us = campaign.nominal.report.latency_us
    scene = Scene.of(as_played(campaign, {LATENCY: right_us + 15.0}))

    fitted = fit_beliefs(scene, Change(), uncertain(scene.nominal))

    moved = {belief.key: places for belief, places in fitted.moved}
    assert fitted.nominal.report.latency_us == pytest.approx(right_us, abs=2.0)
    assert moved[JITTER] == 0.0


def test_a_belief_that_is_right_stays() -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=20.0)
    scene = Scene.of(as_played(campaign, {}))

    found = now(scene, belief_of(uncertain(scene.nominal), DELAY))

    assert found == pytest.approx(500.0, abs=8.0)


@pytest.mark.parametrize("factor", [0.65, 1.6])
def test_a_jitter_believed_wrong_about_its_middle_moves_with_its_delay(factor: float) -> None:
    recorded = read_campaign(BENCH)
    report = recorded.nominal.report
    begins_us = report.latency_us + report.jitter_us * (1.0 - factor) / 2.0
    wrong = {JITTER: factor * report.jitter_us, LATENCY: begins_us}
    scene = Scene.of(as_played(recorded, wrong))

    fitted = fit_beliefs(scene, Change(), uncertain(scene.nominal))

    assert fitted.nominal.report.jitter_us == pytest.approx(report.jitter_us, rel=0.05)
    assert fitted.nominal.report.latency_us == pytest.approx(report.latency_us, abs=1.5)
    moved = [belief for belief, places in fitted.moved if places]
    (delay,) = [belief for belief in moved if belief.key == LATENCY]
    assert delay.uncertainties(delay.moved(1.3)) == pytest.approx(1.3)
    assert delay.u_absolute == pytest.approx(NOISE_U * factor * report.jitter_us / 2.0)


@pytest.mark.parametrize("factor", [0.7, 0.8])
def test_a_jitter_that_lasts_longer_than_believed_begins_where_it_did(factor: float) -> None:
    recorded = read_campaign(BENCH)
    report = recorded.nominal.report
    scene = Scene.of(as_played(recorded, {JITTER: factor * report.jitter_us}))

    fitted = fit_beliefs(scene, Change(), uncertain(scene.nominal))

    assert fitted.nominal.report.latency_us == report.latency_us
    assert fitted.nominal.report.jitter_us == pytest.approx(report.jitter_us, rel=0.05)


def test_a_jitter_that_is_wider_moves_no_delay_below_nothing() -> None:
    nominal = believing(read_campaign(BENCH).nominal, {LATENCY: 1.0})
    (delay,) = [b for b in uncertain(nominal) if b.key == LATENCY]

    wider = delay.applied(nominal, 2.0)

    assert wider.report.latency_us == 0.0
    assert wider.report.jitter_us > nominal.report.jitter_us


def test_a_jitter_that_moves_in_two_ways_moves_no_farther_than_in_one() -> None:
    """From its start on and about its middle: twice the farthest would take up a queue."""
    recorded = read_campaign(BENCH)
    report = recorded.nominal.report
    scene = Scene.of(as_played(recorded, {JITTER: report.jitter_us / 5.0}))

    fitted = fit_beliefs(scene, Change(), uncertain(scene.nominal))

    moved = [places for belief, places in fitted.moved if belief.moves == JITTER]
    assert len(moved) == 2
    assert 0.8 * FARTHEST < sum(moved) <= FARTHEST
    assert fitted.nominal.report.jitter_us < report.jitter_us / 5.0 * (1.0 + NOISE_U) ** FARTHEST


def test_nothing_moves_farther_than_the_farthest() -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=20.0)
    scene = Scene.of(as_played(campaign, {DELAY: 200.0}))
    belief = belief_of(uncertain(scene.nominal), DELAY)

    ((_, moved),) = fit_beliefs(scene, Change(), [belief]).moved

    assert moved == pytest.approx(FARTHEST, abs=2.0 * CLOSE)
    assert moved <= FARTHEST


def test_moving_costs_what_it_is_unlikely_by() -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=20.0)
    scene = Scene.of(as_played(campaign, {DELAY: 470.0}))
    belief = belief_of(uncertain(scene.nominal), DELAY)

    fitted = fit_beliefs(scene, Change(), [belief])

    ((_, moved),) = fitted.moved
    there = likelihood(scene.with_nominal(fitted.nominal), Change()).total
    assert fitted.nats == pytest.approx(there - 0.5 * moved**2)
    assert fitted.nats > likelihood(scene, Change()).total


def test_no_beliefs_leave_the_chain_as_it_is() -> None:
    scene = Scene.of(read_campaign(MACHINE))

    fitted = fit_beliefs(scene, Change(), [])

    assert fitted.nominal is scene.nominal
    assert fitted.nats == likelihood(scene, Change()).total
    assert not fitted.moved


def test_beliefs_are_fitted_together() -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=20.0, plc__scan_us=5.0)
    scene = Scene.of(as_played(campaign, {DELAY: 480.0, SCAN: 1004.0}))
    beliefs = [belief_of(uncertain(scene.nominal), key) for key in (DELAY, SCAN)]

    together = fit_beliefs(scene, Change(), beliefs)

    assert together.nominal.probe.delay_us == pytest.approx(500.0, abs=8.0)
    assert np.isfinite(together.nats)
    assert together.nats >= max(fit_beliefs(scene, Change(), [b]).nats for b in beliefs) - 0.1


def test_a_search_that_misses_a_peak_takes_what_fitted_beside_another_change(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    campaign = believed(read_campaign(MACHINE), probe__delay_us=40.0)
    truth = campaign.nominal
    scene = Scene.of(as_played(campaign, {DELAY: 450.0}))
    belief = belief_of(uncertain(scene.nominal), DELAY)

    def far_off(*_: object, bounds: tuple[float, float], **__: object) -> SimpleNamespace:
        return SimpleNamespace(x=bounds[0])

    monkeypatch.setattr("scipy.optimize.minimize_scalar", far_off)

    assert fit_beliefs(scene, Change(), [belief]).nominal == scene.nominal
    tried = fit_beliefs(scene, Change(), [belief], truth).nominal
    assert tried.probe.delay_us == pytest.approx(truth.probe.delay_us, abs=8.0)


def test_a_noise_as_uncertain_as_it_is_large_is_twice_as_large_one_uncertainty_on() -> None:
    belief = Belief(REPEATABILITY, 3.0, 1.0, is_noise=True)

    assert belief.moved(1.0) == pytest.approx(belief.value + belief.u_absolute)
    assert belief.moved(-1.0) == pytest.approx(1.5)
    assert belief.moved(FARTHEST) < 6.0 * belief.value
