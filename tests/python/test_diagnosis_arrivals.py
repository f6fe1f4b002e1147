"""Arrivals of reports stand in for stamps where the latch has none of its own."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from played_campaigns import BENCH, played, played_again, stamped_machine
from skiplatch.campaign import Campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.law import extra_variance
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import Effect
from standing_fits import standing

TELLING = ("deviation_skip", "deviation_plc", "arrival")
RARE = 1e-3
"""False-alarm rate of each case, of which all are fixed by their seeds."""


def unstamped(campaign: Campaign) -> Campaign:
    """Give the campaign as of a bus that tells of arrivals alone."""
    none = np.full(len(campaign.touches), np.nan)
    return replace(campaign, touches=replace(campaign.touches, latch_us=none))


def bench(*effects: Effect) -> Scene:
    return scene_of(unstamped(played(BENCH, *effects)))


def test_an_arrival_is_a_time_of_no_more_than_the_latch() -> None:
    campaign = played(BENCH)
    true_us, report = campaign.touches.latch_us, campaign.nominal.report

    scene = scene_of(unstamped(campaign))

    early_us = true_us + campaign.nominal.skip.tick_us - scene.touches.latch_us
    assert set(scene.streams) == {"motion", *TELLING}
    assert early_us.min() > 0.0
    assert early_us.max() < report.jitter_us + campaign.nominal.skip.tick_us


@pytest.mark.parametrize(
    "truth",
    [
        None,
        Effect("report_delay", {"delay_us": 90.0, "stepping_us_min_m": 40.0}),
        Effect("report_delay", {"delay_us": 90.0, "queue_us": 300.0, "unqueued_share": 0.5}),
        Effect("input_filter", {"delay_us": 60.0, "jitter_us": 30.0}),
        Effect("timer_quantisation", {"tick_us": 900.0}),
        Effect("timer_drift", {"drift_ppm": 500.0}),
    ],
)
def test_their_laws_are_those_of_plays(truth: Effect | None) -> None:
    scene, found = bench(), [truth] if truth else []
    plays = Rig(scene.nominal, found).play(scene.touches, seed=7, replicates=60)
    shown = replace(scene.touches, latch_us=plays.latch_us[0], deviation_um=plays.deviation_um[0])
    again = Scene(scene.nominal, replace(shown, edge_us=plays.edge_us[0]))
    is_seen = truth is not None and catalogue()[truth.id].applies(again)
    fit = standing(again, truth) if truth is not None and is_seen else None

    for name in TELLING:
        stream = again.streams[name]
        law = law_under(again, stream, fit.change(again)) if fit else stream.law
        spread = np.sqrt(law.spread**2 + extra_variance(law))
        scores = ((stream.residuals - law.mean) / spread)[stream.rows]
        late = stats.ttest_1samp(scores, 0.0).pvalue
        assert late > RARE, name
        # What is no wider than a step of the position is rounded to it.
        assert np.std(scores) == pytest.approx(1.0, abs=0.15) or name == "deviation_skip"


def test_a_clock_that_nobody_reads_is_no_candidate() -> None:
    scene = bench()

    assert not catalogue()["timer_drift"].applies(scene)
    assert catalogue()["timer_drift"].applies(Scene.of(played(BENCH)))


def test_without_a_belief_of_how_long_reports_take_arrivals_tell_no_latch() -> None:
    campaign = unstamped(played(BENCH))
    unknown = replace(campaign.nominal, unknown=frozenset({("report", "latency_us")}))

    scene = scene_of(replace(campaign, nominal=unknown))

    assert not scene.has_stamps.any()


def test_without_positions_arrivals_tell_no_latch() -> None:
    campaign = unstamped(played(BENCH))
    none = np.full(len(campaign.touches), np.nan)
    edges = replace(campaign, touches=replace(campaign.touches, deviation_um=none))

    assert set(scene_of(edges).streams) == {"motion"}
    assert scene_of(edges).nominal == campaign.nominal


def test_stamps_of_the_latch_stay() -> None:
    campaign = played(BENCH)

    scene = scene_of(campaign)

    assert scene.nominal == campaign.nominal
    assert "report" in scene.streams


@pytest.mark.long
def test_a_late_report_is_named_though_nobody_stamped() -> None:
    late = Effect("report_delay", {"delay_us": 400.0, "stepping_us_min_m": 30.0})
    campaign = unstamped(played_again(stamped_machine(), late))

    found = diagnose(campaign, seed=1)

    assert found.verdict is Verdict.EXPLAINED
    assert [one.effect.id for one in found.effects] == ["report_delay"]
    assert found.effects[0].effect.parameters["delay_us"] == pytest.approx(400.0, abs=5.0)
    assert any("arrivals of reports are held" in note for note in found.notes)


def test_no_gap_is_seen_where_there_is_none() -> None:
    assert diagnose(unstamped(played(BENCH)), seed=1).verdict is Verdict.NO_GAP
