"""Scans, ticks and queues that lie apart from others: what a search finds of them."""

from dataclasses import replace

import numpy as np
import pytest

from law_densities import law_log_density
from played_campaigns import BENCH, played
from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.grid_starts import _coarsest
from skiplatch.diagnosis.candidates.scan_starts import overruns, scan_periods
from skiplatch.diagnosis.candidates.surrogates import HALF_WAY
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import Fit, fit
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.reported.where import places
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.simulator.effects import Effect

PLC = ("latch_plc", "lattice")


def searched(effect: Effect, seed: int = 11) -> FloatArray:
    """What a search from the candidate's own starts makes of a campaign with the effect."""
    scene = Scene.of(played(BENCH, effect, seed=seed))
    candidate = CANDIDATES[effect.id]
    return fit(scene, [candidate], candidate.starts(scene, Change())).parameters[0]


@pytest.mark.parametrize("seed", [1, 6000])
def test_no_phase_of_late_scans_fits_better_than_the_one_that_is_chosen(
    seed: int,
) -> None:
    truth = Effect("scan_jitter", {"jitter_us": 200.0, "tail_us": 50.0})
    scene = Scene.of(played(BENCH, truth, seed=seed))
    change = CANDIDATES["scan_jitter"].change(scene, np.array([200.0, 50.0, 0.0]))
    period = scene.nominal.plc.scan_us
    stream = scene.streams["lattice"]
    law = law_under(scene, stream, change).select(stream.rows)
    stamps = scene.touches.latch_us[stream.rows]
    phases = np.arange(0.0, period, 1.0)
    totals = [law_log_density(law, (stamps - phase) % period, period).sum() for phase in phases]

    found = likelihood(scene, change, names=["lattice"]).total

    assert found > max(totals) + len(stamps) * np.log(period) - 1.0


@pytest.mark.parametrize("tick_us", [0.25, 0.0625, 0.02])
def test_the_phase_is_found_to_a_tick_however_fine_that_is(tick_us: float) -> None:
    """Stamps of which a third lie on the grid, the others up to 8 µs behind it."""
    campaign = played(BENCH, seed=3)
    skip = replace(campaign.nominal.skip, tick_us=tick_us)
    campaign = replace(campaign, nominal=replace(campaign.nominal, skip=skip))
    rng, touches, period = np.random.default_rng(3), campaign.touches, 2000.0
    late_us = np.where(rng.random(len(touches)) < 0.3, 0.0, rng.uniform(0.0, 8.0, len(touches)))
    stamps = np.ceil(touches.latch_us / period) * period + 711.3 + late_us
    stamps = np.where(touches.on_plc, np.rint(stamps / tick_us) * tick_us, touches.latch_us)
    scene = Scene.of(replace(campaign, touches=replace(touches, latch_us=stamps)))
    change = CANDIDATES["scan_jitter"].change(scene, np.array([8.0, 0.0, 0.3]))
    stream = scene.streams["lattice"]
    law = law_under(scene, stream, change).select(stream.rows)
    stamps = scene.touches.latch_us[stream.rows]
    phases = 711.3 + tick_us * np.arange(-3.0, 3.0, 0.1)
    turned = [(stamps - phase + period / 2.0) % period - period / 2.0 for phase in phases]
    best = max(law_log_density(law, off, period).sum() for off in turned)

    found = likelihood(scene, change, names=["lattice"]).total

    assert found > best + len(stamps) * np.log(period) - 1.0


@pytest.mark.long
@pytest.mark.parametrize(
    ("late_us", "span_us"),
    [(1000.0, 0.0), (600.0, 0.0), (500.0, 600.0), (700.0, 1000.0)],
)
def test_overruns_are_found_wherever_they_reach(late_us: float, span_us: float) -> None:
    truth = {"probability": 0.1, "overrun_us": late_us, "span_us": span_us}

    share, late, span, _ = np.abs(searched(Effect("scan_overrun", truth)))

    assert share == pytest.approx(0.1, rel=0.5)
    assert late == pytest.approx(late_us, abs=1.0 + 0.15 * span_us)
    assert span == pytest.approx(span_us, abs=1.0 + 0.25 * span_us)


def test_overruns_are_proposed_beside_scans_that_are_a_little_late() -> None:
    rarely = Effect("scan_overrun", {"probability": 0.12, "overrun_us": 404.0})
    often = Effect("scan_jitter", {"jitter_us": 12.0, "on_time_share": 0.5})

    starts = overruns(Scene.of(played(BENCH, rarely, often)), Change())

    near = [start for start in starts if abs(start[1] - 404.0) < 10.0 and start[2] < 40.0]
    assert [start[0] for start in near] == [pytest.approx(0.12, rel=0.3)]


def test_scans_that_are_left_out_are_found_though_all_stamps_keep_the_grid() -> None:
    """Drawn without the simulator's form of it: now and then three to seven scans are left out."""
    campaign = played(BENCH, seed=5)
    touches, period, rng = campaign.touches, campaign.nominal.plc.scan_us, np.random.default_rng(5)
    gaps = np.where(rng.random(200_000) < 0.03, rng.integers(4, 9, 200_000), 1)
    begins = np.cumsum(gaps)
    edge = rng.uniform(begins[0], begins[-1], len(touches))
    more = np.floor(begins[np.searchsorted(begins, edge)] - edge)
    stamps = touches.latch_us + period * np.where(touches.on_plc, more, 0.0)
    scene = Scene.of(replace(campaign, touches=replace(touches, latch_us=stamps)))
    overrun, bounce = CANDIDATES["scan_overrun"], CANDIDATES["contact_bounce"]

    found = [fit(scene, [c], c.starts(scene, Change())) for c in (overrun, bounce)]
    gains = [likelihood(scene, f.change(scene), names=PLC).total for f in found]

    assert gains[0] > gains[1]
    assert found[0].parameters[0][3] > HALF_WAY
    assert abs(found[0].parameters[0][0]) == pytest.approx(0.03, rel=0.5)


def test_scans_may_wait_for_some_moves_and_keep_their_grid_for_the_others() -> None:
    """Played without the simulator's own form of it: of the touches 30 % wait 0.4 of a scan."""
    campaign = played(BENCH, seed=21)
    rng = np.random.default_rng(21)
    touches, period = campaign.touches, campaign.nominal.plc.scan_us
    bound = touches.on_plc & (rng.random(len(touches)) < 0.3)
    wait_us = rng.normal(0.4, 0.03, len(touches)) * period
    stamps = np.where(bound, np.round(touches.edge_us + wait_us), touches.latch_us)
    scene = Scene.of(replace(campaign, touches=replace(touches, latch_us=stamps)))
    lock, overrun = CANDIDATES["scan_phase_lock"], CANDIDATES["scan_overrun"]

    found = [fit(scene, [c], c.starts(scene, Change())) for c in (lock, overrun)]
    gains = [likelihood(scene, f.change(scene), names=PLC).total for f in found]

    assert gains[0] > gains[1] + 30.0
    assert found[0].parameters[0][0] == pytest.approx(0.6, abs=0.05)
    assert abs(found[0].parameters[0][2]) == pytest.approx(0.7, abs=0.15)


@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_grid_is_as_coarse_as_what_keeps_it_lets_it_be(times: int) -> None:
    period, turn = 37.25, 0.3
    stamps = (turn + times * np.array([4, 9, 11, 30, 31]) + 1) * period

    coarsest = _coarsest(stamps, period, turn)

    assert coarsest == pytest.approx((times * period, (1 % times + turn) / times))


@pytest.mark.parametrize("ratio", [0.6, 1.32, 2.1])
def test_a_scan_period_far_from_the_believed_one_is_found(ratio: float) -> None:
    """A few stamps that keep no grid do not spoil it."""
    campaign = played(BENCH, seed=9)
    touches, period = campaign.touches, ratio * campaign.nominal.plc.scan_us
    behind_us = campaign.nominal.input.filter_us
    next_us = np.ceil((np.nan_to_num(touches.edge_us) + behind_us) / period) * period
    odd = np.arange(len(touches)) % 41 == 0
    stamps = np.where(touches.on_plc & ~odd, np.floor(next_us), touches.latch_us)
    scene = Scene.of(replace(campaign, touches=replace(touches, latch_us=stamps)))
    candidate = CANDIDATES["scan_period"]

    found = fit(scene, [candidate], candidate.starts(scene, Change())).parameters[0]

    assert found[0] == pytest.approx(period - campaign.nominal.plc.scan_us, abs=1e-3)


def test_stamps_on_no_grid_were_not_rounded_to_coarse_ticks() -> None:
    """They scatter as far as such ticks would let them, but lie anywhere."""
    late = Effect("isr_latency", {"latency_us": 0.0, "jitter_us": 1000.0})
    scene = Scene.of(played(BENCH, late, seed=2))
    ticks = CANDIDATES["timer_quantisation"].change(scene, np.array([1000.0, 1000.0, 0.0]))
    jitter = CANDIDATES["isr_latency"].change(scene, np.array([0.0, 1000.0, 0.0]))

    coarse, plain = (likelihood(scene, change).total for change in (ticks, jitter))

    assert coarse < plain - 100.0


@pytest.mark.long
def test_what_the_stamps_of_a_foreign_clock_read_late_is_found_without_a_bias() -> None:
    truth = Effect("timer_quantisation", {"tick_us": 1.7, "origin_us": 0.3})

    origins = [searched(truth, seed)[1] for seed in range(5)]

    assert np.median(origins) == pytest.approx(0.3, abs=0.07)


@pytest.mark.parametrize(("tick_us", "origin_us"), [(41.3, 30.0), (120.9, -7.0)])
def test_coarse_ticks_are_found_with_where_they_lie(tick_us: float, origin_us: float) -> None:
    truth = Effect("timer_quantisation", {"tick_us": tick_us, "origin_us": origin_us})

    found = searched(truth)

    assert found[0] == pytest.approx(tick_us, rel=1e-6)
    assert found[1] == pytest.approx(origin_us, abs=1.0)


def with_scans_at(grid_us: FloatArray) -> Scene:
    """Latch each touch of the PLC at the first of some scans after its edge."""
    campaign = played(BENCH, seed=21)
    touches, behind_us = campaign.touches, campaign.nominal.input.filter_us
    next_us = grid_us[np.searchsorted(grid_us, np.nan_to_num(touches.edge_us) + behind_us)]
    stamps = np.where(touches.on_plc, np.floor(next_us), touches.latch_us)
    return Scene.of(replace(campaign, touches=replace(touches, latch_us=stamps)))


@pytest.mark.parametrize(("swing", "scatter"), [(0.15, 0.0), (0.0, 0.12)])
def test_another_period_is_found_though_its_grid_wanders_or_scatters(
    swing: float, scatter: float
) -> None:
    """No simulator's form: scans run ahead and lag again, or each of them is off by itself."""
    campaign = played(BENCH, seed=21)
    period_us, end_us = 0.97 * campaign.nominal.plc.scan_us, 1e6 * campaign.touches.time_s[-1]
    on_time = np.arange(0.0, end_us + 1e7, period_us)
    off = swing * np.sin(2.0 * np.pi * on_time / (0.3 * end_us))
    off += scatter * np.random.default_rng(2).standard_normal(len(on_time))
    scene = with_scans_at(np.sort(on_time + off * period_us))
    period, late = CANDIDATES["scan_period"], CANDIDATES["scan_jitter"]

    found, other = (fit(scene, [c], c.starts(scene, Change())) for c in (period, late))
    gains = [likelihood(scene, f.change(scene), names=PLC).total for f in (found, other)]

    assert found.parameters[0][0] == pytest.approx(-0.03 * campaign.nominal.plc.scan_us, abs=0.01)
    assert gains[0] > gains[1] + 10.0


def test_a_grid_on_time_gains_nothing_by_wandering() -> None:
    scene = Scene.of(played(BENCH, seed=21))
    still, other = (
        likelihood(scene, Change(period_us=off_us), names=["lattice"]).total
        for off_us in (0.0, 1e-9)
    )

    assert other < still + 0.1


def test_a_scan_late_by_a_whole_period_is_not_early() -> None:
    """It was left out; a tick less than a period would explain stamps that are a tick early."""
    scene = Scene.of(played(BENCH))
    period, tick = scene.nominal.plc.scan_us, scene.nominal.skip.tick_us

    overrun = np.array([0.1, period - tick, 0.0, 0.0])
    (late,) = CANDIDATES["scan_overrun"].change(scene, overrun).lattice_extra

    assert late.offset == period


@pytest.mark.parametrize("seed", range(3))
def test_a_queue_behind_a_longer_way_that_some_reports_pass_is_found_whole(
    seed: int,
) -> None:
    truth = Effect("report_delay", {"delay_us": 80.0, "queue_us": 200.0, "unqueued_share": 0.3})

    found = np.abs(searched(truth, seed))

    assert found[0] == pytest.approx(80.0, rel=0.05)
    assert found[1] == pytest.approx(200.0, rel=0.3)
    assert found[2] == pytest.approx(0.3, abs=0.12)


def test_edges_bound_to_the_scans_propose_no_period_that_no_scan_can_have() -> None:
    """Their waits are all the same, and so say nothing of the period."""
    bound = Effect("scan_phase_lock", {"phase": 0.3})
    scene = Scene.of(played(BENCH, bound))
    believed = scene.nominal.plc.scan_us

    periods = [believed + start[0] for start in scan_periods(scene, Change())]

    assert min(periods) >= 0.08 * believed


def test_stamps_propose_the_widest_grid_that_they_keep() -> None:
    """Those of every fourth scan keep the grid of all; edges that came early tell no period."""
    period = Scene.of(played(BENCH)).nominal.plc.scan_us
    campaign = played(BENCH, Effect("scan_period", {"period_us": 3.0 * period}))
    touches = campaign.touches
    early_us = np.where(touches.touch % 2, 0.0, 8.0 * period)
    early = replace(campaign, touches=replace(touches, edge_us=touches.edge_us - early_us))

    seen = [start[0] for start in scan_periods(Scene.of(early), Change())]

    assert min(abs(off - 3.0 * period) for off in seen) < 1e-3


def test_all_stamps_propose_a_period_that_half_of_them_do_not_tell() -> None:
    """Of 24 touches half serve the fit; the period is off by 40 ppm."""
    campaign = played(BENCH, Effect("scan_period", {"period_us": 0.08}))
    polled = np.flatnonzero(Scene.of(campaign).plc)[:24]
    scene = Scene.of(replace(campaign, touches=campaign.touches.select(polled)))
    half = scene.select(np.arange(len(scene)) % 2 == 0)

    seen = [start[0] for start in scan_periods(half, Change())]

    assert seen[0] == pytest.approx(0.08, rel=0.02)


def test_stamps_of_another_period_lie_anywhere_on_the_believed_grid() -> None:
    scene = Scene.of(played(BENCH, Effect("scan_period", {"period_us": 0.08})))
    fit = Fit((CANDIDATES["scan_period"],), (np.array([0.08]),), frozenset(scene.streams))

    (grid,) = (
        place
        for place in places(scene, Finding(Scored(fit, 100.0, 50.0)), [], [])
        if place.stretch == "grid"
    )

    assert grid.size == pytest.approx(scene.nominal.plc.scan_us / np.sqrt(12.0), rel=0.1)


@pytest.mark.parametrize("turns", [-1.0, 1.0])
def test_a_place_in_a_period_is_the_same_a_period_on(turns: float) -> None:
    values = np.array([0.3 + turns, 0.05, 0.0, 0.4 - turns, 0.2])

    (effect,) = as_effects(Fit((CANDIDATES["scan_phase_lock"],), (values,), frozenset()))

    assert effect.parameters["phase"] == pytest.approx(0.3)
    assert effect.parameters["second_after"] == pytest.approx(0.4)
