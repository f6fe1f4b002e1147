"""The first effect of a search, and the beliefs that it stands beside."""

from dataclasses import replace

import pytest

from played_campaigns import BENCH, played_again, stamped_machine, thinned
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.fit.beliefs import SCAN_PERIOD, believing
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.search.first import beside_its_beliefs, first_effects
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split
from skiplatch.simulator.effects import Effect

ACCELERATION = ("axis", "accel_mm_s2")


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


def test_beliefs_that_all_observables_tell_alike_are_told_once() -> None:
    scene = scene_of(stamped_machine())

    assert Judge(scene, split(len(scene), 1)).told_otherwise() == []
