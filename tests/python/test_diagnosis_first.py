"""The first effect of a search, and the beliefs that it stands beside."""

from dataclasses import replace

import pytest

from played_campaigns import BENCH, played_again
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.search.first import beside_its_beliefs, first_effects
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split
from skiplatch.simulator.effects import Effect


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
