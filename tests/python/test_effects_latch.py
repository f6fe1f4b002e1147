"""Physics of the effects on the interrupt, the clock, the scans and the report."""

import numpy as np
import pytest
from scipy import stats

from effects_rig import (
    POSITION_TOLERANCE_UM,
    RARE,
    SCAN_US,
    STAMP_TOLERANCE_US,
    Trace,
    assert_close,
    assert_follows,
    assert_share,
    first_scan_us,
    trace,
)
from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath

SKIP, PLC = InputPath.SKIP, InputPath.PLC


def assert_deviation_follows_the_latch(played: Trace) -> None:
    way_um = played.speed_um_us * played.latch_shift_us
    assert_close(played.deviation_shift_um, way_um, 2.0 * POSITION_TOLERANCE_UM)


def wait_us(played: Trace) -> FloatArray:
    """From the pin to the latch."""
    return np.asarray(played.changed.latch_us[0] - played.pin_us)


def test_isr_latency_and_its_jitter_delay_the_latch() -> None:
    played = trace(SKIP, "isr_latency", n=2000, latency_us=42.0, jitter_us=30.0)

    assert_follows(played.latch_shift_us, stats.uniform(42.0, 30.0))
    assert played.latch_shift_us.min() > 42.0 - STAMP_TOLERANCE_US
    assert played.latch_shift_us.max() < 72.0 + STAMP_TOLERANCE_US
    assert_deviation_follows_the_latch(played)


def test_isr_latency_without_jitter_is_the_same_for_every_touch() -> None:
    played = trace(SKIP, "isr_latency", latency_us=17.5)

    assert_close(played.latch_shift_us, 17.5, STAMP_TOLERANCE_US)


def test_an_interrupt_does_not_come_before_its_edge() -> None:
    played = trace(SKIP, "isr_latency", latency_us=-100.0)

    assert_close(wait_us(played), 0.0, STAMP_TOLERANCE_US)


def test_isr_blocking_waits_for_the_rest_of_a_masked_stretch() -> None:
    played = trace(SKIP, "isr_blocking", n=10_000, probability=0.3, length_us=120.0)
    blocked = played.latch_shift_us != 0.0

    assert_share(blocked, 0.3)
    assert_follows(played.latch_shift_us[blocked], stats.uniform(0.0, 120.0))
    assert_deviation_follows_the_latch(played)


def test_isr_blocking_by_stretches_of_other_lengths_has_a_tail() -> None:
    played = trace(SKIP, "isr_blocking", n=10_000, probability=0.3, length_us=0.1, tail_us=120.0)
    blocked = played.latch_shift_us > 0.1

    assert_share(blocked, 0.3)
    assert_follows(played.latch_shift_us[blocked], stats.expon(0.05, 120.0))


def test_isr_blocking_by_what_the_same_edge_starts_is_waited_for_from_its_begin() -> None:
    played = trace(SKIP, "isr_blocking", n=10_000, probability=0.3, length_us=20.0, least_us=120.0)
    blocked = played.latch_shift_us != 0.0

    assert_share(blocked, 0.3)
    assert_follows(played.latch_shift_us[blocked], stats.uniform(120.0, 20.0))


@pytest.mark.parametrize("tick_us", [8.0, 0.3, 0.07])
def test_timer_quantisation_rounds_stamps_down_and_latches_the_position_of_the_tick(
    tick_us: float,
) -> None:
    played = trace(SKIP, "timer_quantisation", tick_us=tick_us)
    ticks = np.floor(np.rint(played.nominal.latch_us[0] * 100) / round(tick_us * 100))

    assert_close(played.changed.latch_us[0], ticks * tick_us, 1e-6)
    assert_deviation_follows_the_latch(played)
    np.testing.assert_array_equal(played.report_shift_us, 0.0)


def test_timer_quantisation_rounds_stamps_of_scans_and_moves_none() -> None:
    played = trace(PLC, "timer_quantisation", tick_us=8.0)

    assert_close(played.changed.latch_us[0], np.floor(played.nominal.latch_us[0] / 8.0) * 8.0, 1e-6)
    np.testing.assert_array_equal(played.deviation_shift_um, 0.0)


def test_timer_quantisation_may_round_to_the_nearest_tick() -> None:
    played = trace(SKIP, "timer_quantisation", tick_us=4.0, nearest=1.0)
    latched_us = played.nominal.latch_us[0]

    assert_close(played.changed.latch_us[0], np.floor(latched_us / 4.0 + 0.5) * 4.0, 1e-6)


@pytest.mark.parametrize("path", list(InputPath))
@pytest.mark.parametrize("drift_ppm", [-300.0, 40.0])
def test_timer_drift_stretches_the_stamps_of_both_paths(path: InputPath, drift_ppm: float) -> None:
    played = trace(path, "timer_drift", drift_ppm=drift_ppm)
    expected_us = played.nominal.latch_us[0] * (1.0 + drift_ppm * 1e-6)

    assert_close(played.changed.latch_us[0], expected_us, STAMP_TOLERANCE_US)
    np.testing.assert_array_equal(played.deviation_shift_um, 0.0)
    np.testing.assert_array_equal(played.report_shift_us, 0.0)


@pytest.mark.parametrize("path", list(InputPath))
def test_timer_drift_adds_up_the_temperature(path: InputPath) -> None:
    played = trace(path, "timer_drift", drift_ppm=0.0, warmth_ppm_k=3.0)
    touches = played.touches
    warmth_k = touches.temp_c - 20.0
    until_s = np.cumsum(warmth_k * np.diff(touches.time_s, prepend=0.0))
    latched_us = played.nominal.latch_us[0]
    since_us = until_s * 1e6 + warmth_k * (latched_us - touches.time_s * 1e6)

    assert_close(played.changed.latch_us[0], latched_us + 3.0e-6 * since_us, STAMP_TOLERANCE_US)


@pytest.mark.parametrize("more_us", [-400.0, 137.0])
def test_scan_period_sets_the_lattice_of_the_latches(more_us: float) -> None:
    played = trace(PLC, "scan_period", period_us=more_us)
    period_us = SCAN_US + more_us
    phase_us = played.changed.latch_us[0, 0] % period_us

    expected_us = first_scan_us(played.pin_us, phase_us, period_us)
    assert_close(played.changed.latch_us[0], expected_us, STAMP_TOLERANCE_US)
    assert_deviation_follows_the_latch(played)


def waits_of_late_scans(lateness_us: FloatArray, seed: int) -> FloatArray:
    """Pin to the first scan that begins after it, in a plain model of scans that do not overtake.

    Shape of `lateness_us`: (runs, scans). The pin falls anywhere in the period of the last 20 scans
    but ten; all scans before it can hold it up.
    """
    runs, scans = lateness_us.shape
    begin_us = np.maximum.accumulate(SCAN_US * np.arange(scans) + lateness_us, axis=1)
    pin_us = np.random.default_rng(seed).uniform(scans - 21, scans - 20, (runs, 1)) * SCAN_US
    return np.asarray(np.where(begin_us >= pin_us, begin_us, np.inf).min(axis=1) - pin_us[:, 0])


@pytest.mark.parametrize("jitter_us", [300.0, 2600.0])
def test_scan_jitter_begins_scans_late_but_in_their_order(jitter_us: float) -> None:
    played = trace(PLC, "scan_jitter", n=4000, jitter_us=jitter_us)
    lateness_us = np.random.default_rng(1).uniform(0.0, jitter_us, (40_000, 50))
    model_us = waits_of_late_scans(lateness_us, seed=2)

    assert stats.ks_2samp(wait_us(played), model_us).pvalue > RARE
    after_scan_us = (played.changed.latch_us[0] - played.scan_phase_us + 0.02) % SCAN_US
    assert after_scan_us.max() < jitter_us + 0.05
    assert after_scan_us.max() > 0.99 * min(jitter_us, SCAN_US)  # else once in 10^17 runs
    assert_deviation_follows_the_latch(played)


def test_scan_jitter_may_leave_some_scans_on_time() -> None:
    played = trace(PLC, "scan_jitter", n=10_000, jitter_us=300.0, on_time_share=0.6)
    rng = np.random.default_rng(5)
    is_late = rng.random((40_000, 50)) >= 0.6
    model_us = waits_of_late_scans(is_late * rng.uniform(0.0, 300.0, (40_000, 50)), seed=6)

    assert stats.ks_2samp(wait_us(played), model_us).pvalue > RARE
    after_scan_us = (played.changed.latch_us[0] - played.scan_phase_us + 0.02) % SCAN_US
    shorter_us = 0.4 * 150.0  # the mean gap before a scan on time, after one that may be late
    assert_share(after_scan_us < 0.05, 0.6 * (1.0 - shorter_us / SCAN_US))


@pytest.mark.parametrize("overrun_us", [400.0, 3500.0])
def test_a_scan_overrun_holds_up_the_scans_behind_it(overrun_us: float) -> None:
    played = trace(PLC, "scan_overrun", n=10_000, probability=0.15, overrun_us=overrun_us)
    is_late = np.random.default_rng(3).random((40_000, 50)) < 0.15
    model_us = waits_of_late_scans(np.where(is_late, overrun_us, 0.0), seed=4)

    assert stats.ks_2samp(wait_us(played), model_us).pvalue > RARE
    after_scan_us = (played.changed.latch_us[0] - played.scan_phase_us + 0.02) % SCAN_US
    on_lattice = after_scan_us < 0.05
    assert_close(after_scan_us[~on_lattice], overrun_us % SCAN_US, 0.05)
    assert_deviation_follows_the_latch(played)


@pytest.mark.parametrize(("overrun_us", "span_us"), [(10.0, 0.0), (400.0, 5000.0)])
def test_scans_that_are_left_out_leave_the_others_on_the_lattice(
    overrun_us: float, span_us: float
) -> None:
    played = trace(
        PLC,
        "scan_overrun",
        n=10_000,
        probability=0.15,
        overrun_us=overrun_us,
        span_us=span_us,
        left_out=1.0,
    )
    rng = np.random.default_rng(3)
    late_us = overrun_us + rng.uniform(0.0, span_us, (40_000, 50))
    whole_us = np.ceil(late_us / SCAN_US) * SCAN_US * (rng.random((40_000, 50)) < 0.15)
    model_us = waits_of_late_scans(whole_us, seed=4)

    assert stats.ks_2samp(wait_us(played), model_us).pvalue > RARE
    after_scan_us = (played.changed.latch_us[0] - played.scan_phase_us + 0.02) % SCAN_US
    assert after_scan_us.max() < 0.05
    assert_deviation_follows_the_latch(played)


def test_when_every_scan_overruns_the_whole_lattice_is_late() -> None:
    played = trace(PLC, "scan_overrun", probability=1.0, overrun_us=3400.0)
    expected_us = first_scan_us(played.pin_us, played.scan_phase_us + 3400.0)

    assert_close(played.changed.latch_us[0], expected_us, STAMP_TOLERANCE_US)


@pytest.mark.parametrize("scans", [1.0, 2.0, 7.0])
def test_input_image_delay_latches_whole_scans_later(scans: float) -> None:
    played = trace(PLC, "input_image_delay", scans=scans)

    assert_close(played.latch_shift_us, scans * SCAN_US, STAMP_TOLERANCE_US)
    assert_deviation_follows_the_latch(played)


def test_an_input_image_between_two_ages_is_now_the_one_and_now_the_other() -> None:
    played = trace(PLC, "input_image_delay", n=4000, scans=1.3)
    older = np.rint(played.latch_shift_us / SCAN_US)

    assert_close(played.latch_shift_us, older * SCAN_US, STAMP_TOLERANCE_US)
    assert set(older) == {1.0, 2.0}
    assert np.mean(older == 2.0) == pytest.approx(0.3, abs=0.03)  # 4 standard errors
    assert_deviation_follows_the_latch(played)


@pytest.mark.parametrize("phase", [0.05, 0.3, 0.99])
def test_scan_phase_lock_fixes_the_wait_for_the_scan(phase: float) -> None:
    played = trace(PLC, "scan_phase_lock", phase=phase)

    assert_close(wait_us(played), (1.0 - phase) * SCAN_US, STAMP_TOLERANCE_US)
    assert_deviation_follows_the_latch(played)


def test_scan_phase_lock_scatters_about_its_point() -> None:
    played = trace(PLC, "scan_phase_lock", n=10_000, phase=0.9, spread=0.05)
    phase = 1.0 - wait_us(played) / SCAN_US
    unwrapped = (phase + 0.5 - 0.9) % 1.0 - 0.5

    assert_follows(unwrapped, stats.norm(0.0, 0.05))
    assert phase.min() < 0.05  # beyond the end of the period, round to its beginning


def test_scan_phase_lock_may_have_a_second_point() -> None:
    played = trace(
        PLC, "scan_phase_lock", n=4000, phase=0.2, spread=0.01, second_after=0.5, second_share=0.3
    )
    phase = 1.0 - wait_us(played) / SCAN_US
    at_second = np.abs(phase - 0.7) < 0.1

    assert_share(at_second, 0.3)
    assert_close(phase[~at_second], 0.2, 0.05)
    assert_follows(phase[at_second], stats.norm(0.7, 0.01))


def test_scan_phase_lock_leaves_the_scans_of_other_touches_where_they_were() -> None:
    played = trace(PLC, "scan_phase_lock", n=2000, phase=0.2, unlocked=0.4)
    is_unmoved = np.abs(played.latch_shift_us) < STAMP_TOLERANCE_US

    assert_share(is_unmoved, 0.4)
    locked_us = wait_us(played)[~is_unmoved]
    assert_close(locked_us, 0.8 * SCAN_US, STAMP_TOLERANCE_US)


@pytest.mark.parametrize("path", list(InputPath))
def test_report_delay_is_a_longer_way_and_an_exponential_queue(path: InputPath) -> None:
    played = trace(path, "report_delay", n=20_000, delay_us=400.0, queue_us=200.0)

    assert_follows(played.report_shift_us, stats.expon(400.0, 200.0))


def test_reports_take_the_longer_the_more_steps_are_made_meanwhile() -> None:
    played = trace(SKIP, "report_delay", n=2000, delay_us=400.0, stepping_us_min_m=50.0)
    feed_m_min = played.touches.feed_mm_min / 1000.0

    assert feed_m_min.max() > 5.0 * feed_m_min.min()
    assert_close(played.report_shift_us, 400.0 + 50.0 * feed_m_min, STAMP_TOLERANCE_US)


def test_a_report_does_not_arrive_before_its_latch() -> None:
    played = trace(SKIP, "report_delay", delay_us=-10_000.0)

    assert_close(played.changed.report_us[0], played.changed.latch_us[0], STAMP_TOLERANCE_US)
