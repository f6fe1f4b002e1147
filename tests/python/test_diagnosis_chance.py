"""Chance goes with nothing: what a finding leaves to it must not be told by anything known."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again
from skiplatch.arrays import BoolArray
from skiplatch.campaign import Campaign, InputPath, Touches, read_campaign
from skiplatch.campaign.nominal import InputNominal, ProbeNominal, SkipNominal
from skiplatch.diagnosis.fit.material import DEFAULT
from skiplatch.diagnosis.plays.left import CHANCE, Left
from skiplatch.diagnosis.plays.leftover import Beside
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.chance import chance_of
from skiplatch.simulator.effects import Effect

SHARE, LATE_US = 0.3, 3000.0
BOUNCE = Effect("contact_bounce", {"probability": SHARE, "least_us": LATE_US})


def told(campaign: Campaign, *effects: Effect, discrepancy: float = 0.0) -> list[Left]:
    return [one for one in looks(campaign, *effects, discrepancy=discrepancy) if one.z > CHANCE]


def looks(campaign: Campaign, *effects: Effect, discrepancy: float = 0.0) -> list[Left]:
    scene = Scene.of(campaign)
    rigs = (Rig(campaign.nominal, effects), Rig(campaign.nominal))
    found, believed = (Beside.of(scene, rig, seed=1) for rig in rigs)
    return chance_of(found, believed, discrepancy)


def late(campaign: Campaign, rows: BoolArray, late_us: float = LATE_US) -> Campaign:
    """Some touches latch later, and are deeper by the way of that time."""
    touches = campaign.touches
    way_um = touches.feed_mm_min / 60.0 * late_us * 1e-3
    return replace(
        campaign,
        touches=replace(
            touches,
            latch_us=touches.latch_us + late_us * rows,
            report_us=touches.report_us + late_us * rows,
            deviation_um=touches.deviation_um + way_um * rows,
        ),
    )


def longest_rests(touches: Touches) -> BoolArray:
    rest_s = np.diff(touches.time_s, prepend=touches.time_s[:1])
    return np.asarray(rest_s > np.quantile(rest_s, 1.0 - SHARE))


def in_order() -> Campaign:
    campaign = played(MACHINE)
    return replace(campaign, touches=campaign.touches.in_order_of_time())


def every_third(campaign: Campaign) -> Campaign:
    rows = np.arange(0, len(campaign.touches), 3)
    return replace(campaign, touches=campaign.touches.select(rows))


def test_nothing_tells_which_touches_bounced() -> None:
    """At this level one finding in a thousand is told by accident."""
    for seed in range(3):
        assert told(played(MACHINE, BOUNCE, seed=seed), BOUNCE) == []


def test_the_rest_before_tells_which_touches_did_not_bounce_but_came_late() -> None:
    campaign = in_order()

    found = told(late(campaign, longest_rests(campaign.touches)), BOUNCE)

    assert found
    assert "rest before" in found[0].conditions


def test_few_touches_tell_that_those_of_one_side_alone_came_late() -> None:
    """All of them are late by as much; among each other their ranks are those of the noise."""
    campaign = in_order()
    few = every_third(campaign)
    on_side = (few.touches.alpha_deg > 90.0) & (few.touches.alpha_deg < 180.0)
    bounce = Effect("contact_bounce", {"probability": 0.25, "least_us": 300.0})

    (found, *_) = told(late(few, on_side, 300.0), bounce)

    assert any(name.startswith("azimuth") for name in found.conditions)
    for seed in range(3):
        assert told(every_third(played(MACHINE, bounce, seed=seed)), bounce) == []


def test_each_condition_is_asked_for_what_happens_to_some() -> None:
    """Ranks of how late each of them is tell less of it, and so may a forest of all conditions."""
    campaign = in_order()
    feed = campaign.touches.feed_mm_min
    often = np.random.default_rng(8).random(len(feed)) < 0.5
    rows = (feed >= np.quantile(feed, 0.75)) & often
    bounce = Effect("contact_bounce", {"probability": float(rows.mean()), "least_us": LATE_US})

    found = told(late(campaign, rows), bounce)

    assert max(one.z for one in found if one.conditions == ("feed",)) > 6.0


@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param(range(100, 110), marks=pytest.mark.long),
        pytest.param(range(100, 150), marks=pytest.mark.nightly),
    ],
)
def test_bounces_are_told_no_more_often_than_stated(seeds: range) -> None:
    """None of ten; of fifty: a rate of 3 % shows as surely as by more than one of a hundred."""
    campaigns = (every_third(played(MACHINE, BOUNCE, seed=seed)) for seed in seeds)

    assert not any(told(campaign, BOUNCE) for campaign in campaigns)


def test_what_leaves_nothing_more_to_chance_cannot_be_told_of() -> None:
    campaign = in_order()
    delay = Effect("trigger_delay", {"delay_us": 400.0})

    assert looks(campaign, delay) == []


def test_only_the_path_on_which_it_scatters_is_looked_at() -> None:
    blocking = Effect("isr_blocking", {"probability": SHARE, "length_us": LATE_US})
    campaign = in_order()
    rows = longest_rests(campaign.touches) & (campaign.touches.path == InputPath.SKIP)

    found = told(late(campaign, rows), blocking)

    assert {one.path for one in found} == {"skip"}


def test_a_shift_whose_form_is_off_a_little_is_no_chance_that_is_told() -> None:
    """Nothing real has just the form that is fitted; beyond what the fit asks for, it is told."""
    slow = Effect("isr_latency", {"latency_us": LATE_US, "jitter_us": LATE_US})
    campaign = played(MACHINE, slow)
    campaign = replace(campaign, touches=campaign.touches.in_order_of_time())
    rows = longest_rests(campaign.touches) & (campaign.touches.path == InputPath.SKIP)
    bent = late(campaign, rows)

    assert told(bent, slow, discrepancy=0.1)
    assert told(bent, slow, discrepancy=0.4) == []


def test_what_tells_chance_that_hides_within_a_step_matters() -> None:
    bench = read_campaign(BENCH)
    coarse = replace(
        bench, nominal=replace(bench.nominal, axis=replace(bench.nominal.axis, resolution_um=0.5))
    )
    campaign = played_again(coarse)
    touches = campaign.touches
    off_um = 0.5 * (touches.sign > 0.0)
    off = replace(campaign, touches=replace(touches, deviation_um=touches.deviation_um + off_um))

    found = [
        one
        for one in told(off, Effect("encoder_quantisation", {"resolution_um": 1.3}))
        if one.is_material(DEFAULT)
    ]

    assert "sense" in found[0].conditions
    assert found[0].size < 0.5 * 0.5


def test_a_clock_that_wanders_is_off_by_more_than_its_stamps_lie_off_the_grid() -> None:
    """What it shifts them by counts, whole periods of the scan among it."""
    rig = Effect("timer_drift", {"drift_ppm": 6.0}), Effect("scan_jitter", {"jitter_us": 20.0})
    campaign = played(BENCH, *rig)
    touches = campaign.touches
    off_us = 100.0 * np.sin(touches.time_s / touches.time_s.max() * 4.0 * np.pi)
    wandering = replace(campaign, touches=replace(touches, latch_us=touches.latch_us + off_us))
    shifts_us = 6.0 * touches.time_s

    assert {one.observable for one in told(wandering, *rig)} == {"grid"}
    assert told(wandering, *rig, discrepancy=300.0 / float(np.sqrt(np.mean(shifts_us**2)))) == []


@pytest.mark.parametrize("times", [8.0, 11.0])
def test_where_in_a_longer_scan_an_edge_falls_goes_with_the_time_as_in_any(times: float) -> None:
    period_us = (times - 1.0) * read_campaign(BENCH).nominal.plc.scan_us
    longer = Effect("scan_period", {"period_us": period_us})
    campaign = played(BENCH, longer)
    # Of so short a time waves of that length are looked at.
    short = campaign.touches.in_order_of_time().select(np.arange(150))
    campaign = replace(campaign, touches=short)
    rigs = (Rig(campaign.nominal, effects) for effects in ([longer], []))
    bound = (rig.whose_scans_are(campaign.touches, seed=1) for rig in rigs)

    found, believed = (Beside.of(Scene.of(campaign), rig, seed=1) for rig in bound)

    assert [one for one in chance_of(found, believed, 0.0) if one.z > CHANCE] == []


def test_stamps_that_a_drift_leads_through_their_ticks_are_not_left_to_chance() -> None:
    """Where in a tick a scan begins goes with time, in waves of what the clock drifts by a tick."""
    drift = Effect("timer_drift", {"drift_ppm": -9.85})
    coarse = read_campaign(BENCH)
    nominal = replace(coarse.nominal, skip=replace(coarse.nominal.skip, tick_us=2.0))
    campaign = played_again(replace(coarse, nominal=nominal), drift)

    assert [one.observable for one in looks(campaign, drift) if one.observable == "grid"] == []


def test_touches_that_are_moved_through_the_steps_of_a_counter_are_not_left_to_chance() -> None:
    """Each is then rounded in its own way, where all of a surface were rounded alike."""
    drift = Effect("thermal_drift", {"drift_um_k": -18.0})
    known = read_campaign(MACHINE)
    skip = known.touches.select(np.flatnonzero(known.touches.on_skip))
    nominal = replace(
        known.nominal,
        axis=replace(known.nominal.axis, resolution_um=2.5),
        probe=ProbeNominal(pretravel_um=10.0, repeatability_um=0.72),  # in the middle of a step
        input=InputNominal(),
        skip=SkipNominal(tick_us=known.nominal.skip.tick_us),
    )
    campaign = replace(known, nominal=nominal, touches=skip)

    assert looks(played_again(campaign, drift), drift) == []
