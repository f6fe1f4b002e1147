"""The first effect of a search, and the beliefs that it stands beside."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played_again, stamped_machine, thinned
from skiplatch.campaign import Nominal, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.fit.belief_fit import fit_beliefs
from skiplatch.diagnosis.fit.beliefs import SCAN_PERIOD, believing, uncertain
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.intervals import settled
from skiplatch.diagnosis.fit.together import together
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.first import beside_its_beliefs, first_effects
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split
from skiplatch.simulator.effects import Effect

ACCELERATION = ("axis", "accel_mm_s2")
DELAY = ("probe", "delay_us")
PRETRAVEL = ("probe", "pretravel_um")


@pytest.mark.long
def test_an_effect_is_fitted_to_beliefs_as_stated_too_not_only_where_they_fit_without_it() -> None:
    """A coarse tick that rounds down reads early by half of it, which a filter may make up for.

    Beside that filter it would round to the nearest.
    """
    bench = read_campaign(BENCH)
    uncertain = {**bench.nominal.uncertainty, ("input", "filter_us"): 3.0}
    campaign = replace(bench, nominal=replace(bench.nominal, uncertainty=uncertain))
    scene = scene_of(played_again(campaign, Effect("timer_quantisation", {"tick_us": 8.0})))
    judge = Judge(scene, split(len(scene), 1))

    alone = first_effects(judge, lambda _: frozenset())
    best, *_ = beside_its_beliefs(judge, alone)

    assert alone[0].ids == best.ids == ("timer_quantisation",)
    (to_nearest,), (down,) = alone[0].fit.parameters, best.fit.parameters
    assert to_nearest[[0, 2]].tolist() == pytest.approx([8.0, 1.0])
    assert down[[0, 2]].tolist() == pytest.approx([8.0, 0.0])
    filter_us = judge.scene.nominal.input.filter_us
    assert filter_us == pytest.approx(bench.nominal.input.filter_us, abs=0.3)


@pytest.mark.long
def test_an_effect_that_moves_a_belief_leaves_it_where_another_observable_has_it() -> None:
    """A late filter asks for a lower acceleration; where latches are read asks for the real one."""
    machine = stamped_machine()
    right = machine.nominal.axis.accel_mm_s2
    late = Effect("input_filter", {"delay_us": 170.0})
    recorded = played_again(thinned(machine), late)
    believed = believing(recorded.nominal, {ACCELERATION: 0.97 * right})
    believed = replace(believed, uncertainty={ACCELERATION: 0.04 * right})
    scene = scene_of(replace(recorded, nominal=believed))
    judge = Judge(scene, split(len(scene), 1))

    best, *_ = first_effects(judge, lambda _: frozenset())

    assert "latch_skip" in judge.scene.streams
    assert best.fit.candidates[-1].change is catalogue()[late.id].change
    assert best.fit.parameters[0][0] == pytest.approx(170.0, rel=0.1)
    assert judge.scene.nominal.axis.accel_mm_s2 == pytest.approx(right, rel=1e-3)


@pytest.mark.long
def test_a_clock_that_is_off_is_told_beside_a_period_that_is_uncertain() -> None:
    """Beside the period that fits without it, a clock that is off breaks the grid of the stamps."""
    machine = stamped_machine()
    right_us = machine.nominal.plc.scan_us
    coarse = {("axis", "resolution_um"): 0.5, ("skip", "tick_us"): 0.5}
    rough = believing(machine.nominal, {("probe", "repeatability_um"): 0.5, **coarse})
    machine = thinned(replace(machine, nominal=rough))
    recorded = played_again(machine, Effect("timer_drift", {"drift_ppm": 0.4}))
    believed = believing(recorded.nominal, {SCAN_PERIOD: right_us + 0.06})
    believed = replace(believed, uncertainty={SCAN_PERIOD: 0.07})
    scene = scene_of(replace(recorded, nominal=believed))
    judge = Judge(scene, split(len(scene), 1))

    best, *_ = first_effects(judge, lambda _: frozenset())

    assert best.ids == ("timer_drift",)
    assert best.fit.parameters[0] == pytest.approx([0.4, 0.0, 0.0], abs=0.001)
    assert best.fit.slack == 0.0
    assert judge.scene.nominal.plc.scan_us == pytest.approx(right_us, rel=5e-9)


@pytest.fixture(name="lagging", scope="module")
def fixture_lagging() -> Scene:
    """Two feeds, a known surface, a lag of 274 µs, and a pretravel 2.2 µm shorter than believed.

    A feed that is off by a share, and by as much at every feed, does all of that behind a probe of
    11 ms, beside the pretravel as it is stated.
    """
    machine = read_campaign(MACHINE)
    slow = np.flatnonzero(np.isin(machine.touches.feed_mm_min, (300.0, 1000.0)))
    chain = replace(believing(machine.nominal, {DELAY: 11000.0}), datum=Datum(DatumFreedom.NONE))
    machine = replace(machine, touches=machine.touches.select(slow), nominal=chain)
    recorded = played_again(machine, Effect("following_error", {"lag_us": 274.0}), seed=1)
    believed = believing(chain, {PRETRAVEL: chain.probe.pretravel_um + 2.2})
    return scene_of(replace(recorded, nominal=replace(believed, uncertainty={PRETRAVEL: 1.3})))


def test_each_effect_is_held_against_the_beliefs_that_it_has_itself(lagging: Scene) -> None:
    judge = Judge(lagging, split(len(lagging), 1))
    right_um = lagging.nominal.probe.pretravel_um - 2.2

    alone = first_effects(judge, lambda _: frozenset())
    best, second, third, *_ = beside_its_beliefs(judge, alone)

    assert alone[0].ids == ("feed_error",)
    assert {best.ids, second.ids} == {("following_error",), ("feed_error",)}
    assert second.score > best.score - TIED > third.score
    lag = next(one for one in (best, second) if one.ids == ("following_error",))
    assert lag.fit.parameters[0][0] == pytest.approx(274.0, abs=8.0)
    assert judge.scene.nominal.probe.pretravel_um == pytest.approx(right_um, abs=0.3)


def test_an_effect_and_a_belief_on_a_ridge_are_found_together(lagging: Scene) -> None:
    """In turn neither gets away from where the other one is."""
    (pretravel,) = [b for b in uncertain(lagging.nominal) if b.key == PRETRAVEL]
    lag, start = catalogue()["following_error"], np.array([150.0, 0.0, 0.0, 0.0])
    far = Fit((lag,), (start,), frozenset(lagging.streams))

    def nats(fit: Fit, nominal: Nominal) -> float:
        there = lagging.with_nominal(nominal)
        moved = pretravel.uncertainties(nominal.probe.pretravel_um)
        return likelihood(there, fit.change(there)).total - 0.5 * moved**2

    in_turn = fit_beliefs(lagging, far.change(lagging), [pretravel]).nominal
    there = lagging.with_nominal(in_turn)
    found, nominal = together(there, far, [pretravel])

    assert nats(found, nominal) > nats(settled(there, far), in_turn) + 100.0
    assert found.parameters[0] == pytest.approx([274.0, 0.0, 0.0, 0.0], abs=15.0)
    right_um = lagging.nominal.probe.pretravel_um - 2.2
    assert nominal.probe.pretravel_um == pytest.approx(right_um, abs=0.3)


@pytest.mark.parametrize("one", ["input_filter", "trigger_delay"])
def test_what_does_just_the_same_is_fitted_once_and_given_by_each_name(
    lagging: Scene, one: str
) -> None:
    found = Judge(lagging, split(len(lagging), 1)).singles({one})

    assert {single.ids for single in found} == {("input_filter",), ("trigger_delay",)}
    assert found[0].fitted == found[1].fitted


def test_beliefs_that_all_observables_tell_alike_are_told_once() -> None:
    scene = scene_of(stamped_machine())

    assert Judge(scene, split(len(scene), 1)).told_otherwise() == []
