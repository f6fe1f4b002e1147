"""Two effects are both found, also where the one is weak or hides the other; and a third apart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosed import Search, found, groups
from played_campaigns import BENCH, MACHINE, played, played_again, stamped_machine, thinned
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import Effect

BOARD = Path(__file__).parent / "data" / "board_both_paths"
"""A Cortex-M3 with `other_interrupt`, recorded in its emulator: every third touch of 1,600."""
CLOCK_AND_SCANS = Path(__file__).parent / "data" / "bench_drift_and_jitter"
"""A clock that ages, scans with Gaussian jitter of 12 µs: by the withheld check's generator."""


def judged(campaign: Campaign) -> Judge:
    return Search(campaign).judge


@pytest.mark.nightly
def test_a_second_effect_is_named_though_it_gains_a_twentieth_of_the_first() -> None:
    campaign = played(
        MACHINE,
        Effect("input_filter", {"delay_us": 800.0, "jitter_us": 300.0}),
        Effect("backlash", {"backlash_um": -1.2}),
    )

    delay, length = groups(found(thinned(campaign)))

    assert "input_filter" in delay
    assert length == {"backlash"}


@pytest.mark.long
def test_lobes_that_are_an_error_by_azimuth_do_not_cost_the_second() -> None:
    campaign = played(
        MACHINE,
        Effect("pretravel_lobing", {"amplitude_um": 6.0, "azimuth_deg": 55.0}),
        Effect("link_slotting", {"slot_us": 400.0}),
    )

    lobes, slots = groups(found(thinned(campaign)))

    assert lobes == {"pretravel_lobing"}
    assert {"link_slotting", "trigger_delay", "input_filter"} <= slots


@pytest.mark.long
def test_effects_that_do_just_the_same_are_fitted_alike() -> None:
    delay = Effect("trigger_delay", {"delay_us": 300.0, "tail_us": 90.0})
    judge = judged(thinned(played(MACHINE, delay)))
    first, second = judge.singles()[:2]

    assert {first.ids, second.ids} == {("trigger_delay",), ("input_filter",)}
    assert first.fit.parameters == second.fit.parameters


@pytest.mark.long
def test_an_effect_of_an_odd_form_gets_no_second_one() -> None:
    campaign = thinned(played(MACHINE, Effect("backlash", {"backlash_um": 6.0})))
    touches = campaign.touches
    more_um = 2.0 * touches.sign * np.sin(np.deg2rad(touches.alpha_deg)) ** 2
    odd = replace(touches, deviation_um=touches.deviation_um + more_um)

    finding = found(replace(campaign, touches=odd))

    assert len(groups(finding)) < 2


def bent(campaign: Campaign) -> Campaign:
    """Let the positions err with their square as well, by nothing on average: that is backlash."""
    touches = campaign.touches
    middle_mm = touches.position_mm - np.mean(touches.position_mm)
    squares = (middle_mm / np.ptp(touches.position_mm)) ** 2
    more_um = touches.sign * 1.5 * (squares - np.mean(squares))
    return replace(campaign, touches=replace(touches, deviation_um=touches.deviation_um + more_um))


@pytest.mark.nightly
def test_a_faint_second_effect_of_another_kind_is_named_beside_an_odd_form() -> None:
    scale = Effect("scale_error", {"scale_ppm": -60.0})
    lag = Effect("following_error", {"lag_us": 40.0})

    # A long wave may stand for the squares.
    without, beside = (
        groups(found(thinned(bent(played_again(stamped_machine(), *effects)))))
        for effects in ((scale,), (scale, lag))
    )

    assert without[0] == beside[0] == {"scale_error"}
    assert not any("following_error" in group for group in without)
    assert any("following_error" in group for group in beside)


@pytest.mark.long
def test_a_pair_searched_the_other_way_round_is_the_same_pair() -> None:
    backlash, scale = (
        Effect("backlash", {"backlash_um": 4.0}),
        Effect("scale_error", {"scale_ppm": 80.0}),
    )
    judge = judged(thinned(played(MACHINE, backlash, scale)))
    ranked = judge.singles()
    pair = judge.pairs(ranked[0])[0]
    second = next(single for single in ranked if single.ids == pair.ids[1:])

    (turned,) = judge.turned([(pair, second)])

    assert turned.ids == pair.ids
    assert turned.score == judge.score(turned.fit).score
    assert turned.score > second.score


@pytest.mark.long
def test_two_effects_are_found_behind_the_noise_that_they_look_like() -> None:
    campaign = played(
        BENCH,
        Effect("backlash", {"backlash_um": 3.0}),
        Effect("encoder_quantisation", {"resolution_um": 4.0}),
    )
    search = Search(thinned(campaign))

    finding = search.found()

    assert finding.model is not None
    assert sorted(finding.model.ids) == ["backlash", "encoder_quantisation"]
    assert not search.left(finding.model)


@pytest.mark.long
def test_an_acceleration_a_thousandth_too_slow_is_found() -> None:
    # Stamps and positions together show a few ppm of the travel: the peak is as narrow.
    slow = Effect("unfinished_acceleration", {"accel_ratio": 0.999})

    assert judged(thinned(played_again(stamped_machine(), slow))).singles()[0].ids == (slow.id,)


@pytest.mark.long
def test_an_acceleration_that_only_short_and_fast_approaches_miss_is_found() -> None:
    campaign = read_campaign(MACHINE)
    touches, accel_mm_s2 = campaign.touches, campaign.nominal.axis.accel_mm_s2
    enough_mm_s2 = (touches.feed_mm_min / 60.0) ** 2 / (2.0 * touches.approach_mm)
    slow = Effect(
        "unfinished_acceleration", {"accel_ratio": 0.5 * np.max(enough_mm_s2) / accel_mm_s2}
    )

    assert judged(thinned(played_again(campaign, slow))).singles()[0].ids == (slow.id,)


@pytest.mark.long
def test_what_slack_hides_on_an_emulated_board_goes_to_two_effects_that_need_none() -> None:
    # Another interrupt holds up edge and scans: a clock of any form would take all of it for slack.
    # Some scans are late by up to its length: a jitter beside scans on time.
    named = groups(found(read_campaign(BOARD)))

    assert any("scan_jitter" in group for group in named)
    assert any("isr_blocking" in group for group in named)


@pytest.mark.long
def test_slack_of_the_first_effect_does_not_hide_the_second_one() -> None:
    # A hundredth of the clock's shift is as much as the scans scatter.
    assert groups(found(thinned(read_campaign(CLOCK_AND_SCANS)))) == [
        {"timer_drift"},
        {"scan_jitter"},
    ]


@pytest.mark.long
def test_a_faint_second_effect_is_named_beside_one_whose_form_leaves_nothing() -> None:
    # Against hundreds of nats of the clock's, what some bounces gain is next to nothing. Of fewer,
    # one in twenty, the ranks show too little to be noticed.
    campaign = played(
        BENCH,
        Effect("timer_drift", {"drift_ppm": -6.0}),
        Effect("contact_bounce", {"probability": 0.12, "span_us": 60.0}),
    )

    clock, late = groups(found(thinned(campaign)))

    assert clock == {"timer_drift"}
    assert "contact_bounce" in late


@pytest.mark.long
def test_what_scatters_is_searched_for_a_second_effect_before_others_take_its_place() -> None:
    campaign = played_again(
        stamped_machine(),
        Effect("feed_error", {"feed_percent": 0.22}),
        Effect("transmission_error", {"amplitude_um": 4.0, "period_mm": 5.0}),
    )

    named = groups(found(thinned(campaign)))

    assert sorted(map(sorted, named)) == [["feed_error"], ["transmission_error"]]


THREE = (
    Effect("report_delay", {"delay_us": 240.0, "queue_us": 30.0}),
    Effect("scan_overrun", {"probability": 0.15, "overrun_us": 90.0}),
    Effect("isr_blocking", {"probability": 0.15, "length_us": 100.0}),
)


@pytest.mark.long
def test_a_third_effect_is_named_beside_what_no_effect_explains() -> None:
    """Noise of some positions is no effect, and all that is left."""
    campaign = thinned(played(BENCH, *THREE))
    touches, rng = campaign.touches, np.random.default_rng(5)
    noise_um = np.where(rng.random(len(touches)) < 0.4, rng.normal(0.0, 0.3, len(touches)), 0.0)
    odd = replace(touches, deviation_um=touches.deviation_um + noise_um)

    diagnosis = diagnose(replace(campaign, touches=odd), seed=1)

    assert diagnosis.verdict == Verdict.PARTLY_EXPLAINED
    truth = {effect.id for effect in THREE}
    assert sorted(named.effect.id for named in diagnosis.effects) == sorted(truth)
    for named in diagnosis.effects:
        assert not {named.effect.id, *named.alternatives} & (truth - {named.effect.id})
    assert {one.observable for one in diagnosis.left} == {"position"}


@pytest.mark.nightly
def test_what_two_effects_leave_of_their_own_streams_gets_no_third_one() -> None:
    campaign = thinned(played(BENCH, Effect("backlash", {"backlash_um": 6.0}), THREE[0]))
    touches = campaign.touches
    more_um = 2.0 * touches.sign * np.sin(touches.time_s)
    odd = replace(touches, deviation_um=touches.deviation_um + more_um)

    assert len(groups(found(replace(campaign, touches=odd)))) == 2
