"""Physics of the effects from the motion to the pin, against plain formulas."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from effects_rig import (
    ACCEL_MM_S2,
    DELAY_US,
    FILTER_US,
    POSITION_TOLERANCE_UM,
    PRETRAVEL_UM,
    STAMP_TOLERANCE_US,
    Trace,
    assert_close,
    assert_follows,
    assert_share,
    first_scan_us,
    mixed_touches,
    run,
    trace,
)
from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Touches
from skiplatch.simulator.effects import Effect

SKIP, PLC = InputPath.SKIP, InputPath.PLC


def contact(
    touches: Touches, feed_ratio: FloatArray | float, accel_mm_s2: FloatArray | float
) -> tuple[FloatArray, FloatArray]:
    """Time of contact in µs and speed in µm/µs: ramp from rest, then constant speed."""
    feed_mm_s = touches.feed_mm_min * feed_ratio / 60.0
    speed = np.minimum(feed_mm_s, np.sqrt(2.0 * accel_mm_s2 * touches.approach_mm))
    ramp_mm = speed**2 / (2.0 * accel_mm_s2)
    seconds = speed / accel_mm_s2 + (touches.approach_mm - ramp_mm) / speed
    return (touches.time_s + seconds) * 1e6, speed / 1e3


def assert_moves_like(
    played: Trace, feed_ratio: FloatArray | float, accel_mm_s2: FloatArray | float
) -> None:
    """Edge, stamp and deviation are those of the motion; the pretravel is the nominal one's."""
    believed_us, believed_speed = contact(played.touches, 1.0, ACCEL_MM_S2)
    pretravel_um = (played.nominal.true_edge_us[0] - believed_us - DELAY_US) * believed_speed
    contact_us, speed = contact(played.touches, feed_ratio, accel_mm_s2)
    edge_us = contact_us + pretravel_um / speed + DELAY_US

    assert_close(played.changed.true_edge_us[0], edge_us, 0.01)
    latency_us = played.changed.latch_us[0] - played.changed.true_edge_us[0]
    assert_close(
        latency_us,
        played.nominal.latch_us[0] - played.nominal.true_edge_us[0],
        STAMP_TOLERANCE_US,
    )
    expected_um = pretravel_um + speed * (DELAY_US + latency_us)
    assert_close(played.changed.deviation_um[0], expected_um, 2.0 * POSITION_TOLERANCE_UM)


@pytest.mark.parametrize("percent", [-30.0, 12.0])
def test_feed_error_scales_the_speed(percent: float) -> None:
    played = trace(SKIP, "feed_error", feed_percent=percent)

    assert_moves_like(played, 1.0 + percent / 100.0, ACCEL_MM_S2)


def test_a_feed_above_the_limit_is_that_of_the_limit() -> None:
    feed_mm_min = trace(SKIP, "feed_error").touches.feed_mm_min
    limit_mm_min = float(np.median(feed_mm_min))
    played = trace(SKIP, "feed_error", limit_mm_min=limit_mm_min)

    assert 0.2 < (feed_mm_min > limit_mm_min).mean() < 0.8
    assert_moves_like(played, np.minimum(1.0, limit_mm_min / feed_mm_min), ACCEL_MM_S2)


def test_unfinished_acceleration_touches_below_the_feed() -> None:
    played = trace(SKIP, "unfinished_acceleration", accel_ratio=0.1)
    _, speed = contact(played.touches, 1.0, 0.1 * ACCEL_MM_S2)

    assert_moves_like(played, 1.0, 0.1 * ACCEL_MM_S2)
    short = speed < 0.999 * played.speed_um_us
    assert 20 < short.sum() < 200


@pytest.mark.parametrize("by_feed", [-0.8, 0.6])
def test_acceleration_may_go_with_the_feed_but_never_beyond_the_believed(by_feed: float) -> None:
    played = trace(SKIP, "unfinished_acceleration", accel_ratio=0.7, by_feed=by_feed)
    ratio = np.minimum(0.7 * (played.touches.feed_mm_min / 1000.0) ** by_feed, 1.0)

    assert_moves_like(played, 1.0, ratio * ACCEL_MM_S2)
    assert 0.1 < (ratio == 1.0).mean() < 0.9


def test_pretravel_lobing_turns_with_the_azimuth_and_fades_with_the_tilt() -> None:
    played = trace(SKIP, "pretravel_lobing", amplitude_um=3.0, azimuth_deg=50.0)
    touches = played.touches
    lobes = np.cos(3.0 * np.deg2rad(touches.alpha_deg - 50.0))
    more_um = 3.0 * np.cos(np.deg2rad(touches.beta_deg)) * lobes

    assert_close(played.edge_shift_us, more_um / played.speed_um_us, 0.0011)
    assert_close(played.deviation_shift_um, more_um, POSITION_TOLERANCE_UM)


def test_pointed_lobes_have_cosines_of_their_multiples_and_fade_faster() -> None:
    played = trace(
        SKIP,
        "pretravel_lobing",
        amplitude_um=3.0,
        azimuth_deg=50.0,
        second_um=1.2,
        third_um=-0.4,
        elevation_power=1.0,
    )
    touches = played.touches
    off = np.deg2rad(touches.alpha_deg - 50.0)
    crests = 3.0 * np.cos(3.0 * off) + 1.2 * np.cos(6.0 * off) - 0.4 * np.cos(9.0 * off)
    more_um = np.cos(np.deg2rad(touches.beta_deg)) ** 2 * crests

    assert_close(played.edge_shift_us, more_um / played.speed_um_us, 0.0011)
    assert_close(played.deviation_shift_um, more_um, POSITION_TOLERANCE_UM)


def test_pretravel_lobing_leaves_no_pretravel_below_0() -> None:
    played = trace(SKIP, "pretravel_lobing", amplitude_um=50.0)
    contact_us, _ = contact(played.touches, 1.0, ACCEL_MM_S2)
    after_us = played.changed.true_edge_us[0] - contact_us

    assert after_us.min() == pytest.approx(DELAY_US, abs=0.002)
    assert (after_us < DELAY_US + 0.002).sum() > 20


@pytest.mark.parametrize("delay_us", [-150.0, 730.0])
def test_trigger_delay_costs_the_way_of_that_time(delay_us: float) -> None:
    played = trace(SKIP, "trigger_delay", delay_us=delay_us)

    assert_close(played.edge_shift_us, delay_us, 0.002)
    assert_close(played.latch_shift_us, delay_us, STAMP_TOLERANCE_US)
    assert_close(played.deviation_shift_um, played.speed_um_us * delay_us, POSITION_TOLERANCE_UM)


@pytest.mark.parametrize(
    ("effect_id", "most_us"), [("trigger_delay", DELAY_US), ("input_filter", FILTER_US)]
)
def test_no_delay_is_shorter_than_none(effect_id: str, most_us: float) -> None:
    played = trace(SKIP, effect_id, delay_us=-2000.0)

    assert_close(played.latch_shift_us, -most_us, STAMP_TOLERANCE_US)


@pytest.mark.parametrize("effect_id", ["trigger_delay", "input_filter"])
def test_a_delay_may_scatter_with_a_tail(effect_id: str) -> None:
    even = trace(SKIP, effect_id, n=4000, delay_us=10.0, jitter_us=80.0)
    tailed = trace(SKIP, effect_id, n=4000, delay_us=10.0, tail_us=80.0)

    assert_follows(even.latch_shift_us, stats.uniform(10.0, 80.0))
    assert_follows(tailed.latch_shift_us, stats.expon(10.0, 80.0))


@pytest.mark.parametrize("effect_id", ["trigger_delay", "input_filter"])
def test_plc_latches_a_delayed_edge_at_the_next_scan(effect_id: str) -> None:
    played = trace(PLC, effect_id, delay_us=430.0)
    expected_us = first_scan_us(played.pin_us + 430.0, played.scan_phase_us)
    later_um = played.speed_um_us * (expected_us - played.nominal.latch_us[0])

    assert_close(played.changed.latch_us[0], expected_us, STAMP_TOLERANCE_US)
    assert_close(played.deviation_shift_um, later_um, 2.0 * POSITION_TOLERANCE_UM)
    assert 0.3 < np.mean(played.latch_shift_us > 1.0) < 0.6


def test_input_filter_delays_the_pin_and_not_the_edge() -> None:
    played = trace(SKIP, "input_filter", delay_us=35.0)

    np.testing.assert_array_equal(played.edge_shift_us, 0.0)
    assert_close(played.latch_shift_us, 35.0, STAMP_TOLERANCE_US)
    assert_close(played.deviation_shift_um, played.speed_um_us * 35.0, POSITION_TOLERANCE_UM)


def test_link_slots_lie_on_a_lattice_that_is_fixed_for_a_rig() -> None:
    slot_us = 400.0
    phases = []
    for seed in (1, 2, 3):
        played = trace(SKIP, "link_slotting", seed=seed, slot_us=slot_us)
        phase_us = played.changed.true_edge_us[0, 0] % slot_us
        expected_us = first_scan_us(played.nominal.true_edge_us[0], phase_us, slot_us)

        assert_close(played.changed.true_edge_us[0], expected_us, 0.002)
        assert_close(played.latch_shift_us, played.edge_shift_us, STAMP_TOLERANCE_US)
        phases.append(phase_us)
    assert np.ptp(phases) > 10.0


def test_link_slots_end_at_their_phase_on_the_clock() -> None:
    for seed in (1, 2, 3):
        played = trace(SKIP, "link_slotting", seed=seed, slot_us=400.0, phase_deg=90.0)

        assert_close((played.changed.true_edge_us[0] - 100.0 + 1.0) % 400.0, 1.0, 0.002)


@pytest.mark.parametrize("path", list(InputPath))
def test_link_retries_come_whole_periods_late_and_geometrically_often(
    path: InputPath,
) -> None:
    period_us, probability, n = 700.0, 0.4, 3000
    played = trace(path, "link_retry", n=n, probability=probability, period_us=period_us)
    retries = np.rint(played.edge_shift_us / period_us)

    assert_close(played.edge_shift_us, retries * period_us, 0.002)
    expected = n * stats.geom(1.0 - probability, loc=-1).pmf(np.arange(7))
    seen = np.bincount(retries.astype(int), minlength=7)
    expected = np.append(expected, n - expected.sum())
    assert stats.chisquare(np.append(seen[:7], seen[7:].sum()), expected).pvalue > 1e-4


def test_contact_bounce_delays_some_edges_by_an_exponential_time() -> None:
    played = trace(SKIP, "contact_bounce", n=10_000, probability=0.4, mean_us=250.0)
    bounced = played.latch_shift_us > 0.0

    assert_share(bounced, 0.4)
    assert_follows(played.latch_shift_us[bounced], stats.expon(scale=250.0))
    assert_close(
        played.deviation_shift_um,
        played.speed_um_us * played.latch_shift_us,
        2.0 * POSITION_TOLERANCE_UM,
    )


def test_contact_bounce_may_have_a_least_and_a_uniform_part() -> None:
    played = trace(SKIP, "contact_bounce", n=10_000, probability=0.4, least_us=60.0, span_us=120.0)
    bounced = played.latch_shift_us > 0.0

    assert_share(bounced, 0.4)
    assert_follows(played.latch_shift_us[bounced], stats.uniform(60.0, 120.0))


def test_a_link_that_failed_once_may_fail_more_often_again() -> None:
    probability, again, n = 0.1, 0.5, 20_000
    played = trace(
        SKIP, "link_retry", n=n, probability=probability, period_us=700.0, retry_excess=again
    )
    retries = np.rint(played.edge_shift_us / 700.0)

    assert_share(retries > 0, probability)
    assert_share(retries[retries > 0] > 1, probability + again)
    assert_share(retries[retries > 1] > 2, probability + again)


@pytest.mark.parametrize("path", list(InputPath))
def test_lost_triggers_are_missed_and_the_others_are_as_before(path: InputPath) -> None:
    played = trace(path, "lost_trigger", n=2000, probability=0.15)
    ok = played.changed.ok[0]

    assert_share(~ok, 0.15)
    np.testing.assert_array_equal(played.latch_shift_us[ok], 0.0)
    np.testing.assert_array_equal(played.deviation_shift_um[ok], 0.0)
    assert np.isnan(played.changed.latch_us[0, ~ok]).all()


def test_all_triggers_can_be_lost() -> None:
    touches = mixed_touches(50, seed=1)

    assert not run(touches, Effect("lost_trigger", {"probability": 1.0})).ok.any()


def test_what_an_edge_goes_through_does_not_depend_on_the_feed() -> None:
    touches = mixed_touches(200, seed=2, path=SKIP)
    bounce = Effect("contact_bounce", {"probability": 0.5, "mean_us": 100.0})
    slower = replace(touches, feed_mm_min=touches.feed_mm_min / 2.0)

    bounced = [run(t, bounce).latch_us - run(t).latch_us for t in (touches, slower)]

    assert_close(bounced[0], bounced[1], 2.0 * STAMP_TOLERANCE_US)


def test_the_pretravel_of_the_rig_is_what_the_formulas_take_it_for() -> None:
    """Mean 9 µm, lobes of 2 µm and 0.3 µm of scatter: no touch further off than 2 + 5·0.3 µm."""
    touches = mixed_touches(400, seed=3)
    contact_us, speed = contact(touches, 1.0, ACCEL_MM_S2)
    pretravel_um = (run(touches).true_edge_us[0] - contact_us - DELAY_US) * speed

    assert np.abs(pretravel_um - PRETRAVEL_UM).max() < 3.5
