"""The experiments of the document on variable-speed compensation, through the firmware's latch."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import thinned
from skiplatch.campaign import InputPath, read_campaign
from skiplatch.compensation import campaigns, paper
from skiplatch.compensation.experiment import Result, run
from skiplatch.compensation.firmware import Side
from skiplatch.compensation.rigs import RIGS, Rig, grid
from skiplatch.compensation.touching import Directions, Station, Target
from skiplatch.diagnosis import Verdict, diagnose
from skiplatch.simulator.library import SimulationError

SEEDS = range(1, 7)
TAU_GOAL = 0.02
REDUCTION_GOAL = 10.0
TIME_GOAL = 0.005


@cache
def result(name: str, seed: int = 1) -> Result:
    return run(RIGS[name], seed=seed, jobs=2)


def quick(rig: Rig) -> Rig:
    return replace(rig, runs=4, ring_runs=3)


@pytest.mark.parametrize("name", RIGS)
def test_fifteen_ring_runs_give_the_delay_within_two_percent(name: str) -> None:
    rig = RIGS[name]

    assert rig.ring_runs * len(rig.ring_feeds_mm_min) == 15
    for seed in SEEDS:
        assert abs(result(name, seed).tau_error) < TAU_GOAL


def test_the_uncertainty_of_the_delay_is_the_scatter_of_its_errors() -> None:
    """Over 40 rings, σ of the scatter is known to 11 %: three of that may be off."""
    rig = replace(RIGS["haas"], runs=1)
    trials = [run(rig, seed=seed).tau for seed in range(100, 140)]
    stated_ms = np.sqrt(np.mean([tau.tau_uncertainty_ms**2 for tau in trials]))

    scatter_ms = np.std([tau.tau_ms for tau in trials], ddof=1)

    assert scatter_ms == pytest.approx(stated_ms, rel=0.34)


def test_without_random_error_the_delay_is_that_of_probe_filter_and_latch() -> None:
    rig = RIGS["omp60"]
    silent = replace(
        rig,
        nominal=replace(
            rig.nominal,
            probe=replace(rig.nominal.probe, repeatability_um=0.0),
            skip=replace(rig.nominal.skip, jitter_us=0.0),
        ),
        runs=1,
    )

    tau_us = run(silent, seed=1).tau.tau_ms * 1000.0

    assert tau_us == pytest.approx(25_350.0 + 5.0 + 2.0, abs=12.0)  # 0.01 µm over 50 mm/min


@pytest.mark.parametrize("name", RIGS)
def test_what_is_left_of_the_lobes_is_a_tenth_or_less(name: str) -> None:
    """Of the systematic part; in the mean, as each map has its own random error."""
    reductions = [result(name, seed).systematic_reduction for seed in SEEDS]

    assert np.mean(reductions) > REDUCTION_GOAL


@pytest.mark.parametrize("name", RIGS)
def test_what_is_measured_afterwards_is_random_error(name: str) -> None:
    """That of the map and that of the second measurement: √2 times what one leaves."""
    left = np.mean([result(name, seed).after.vr_um for seed in SEEDS])
    floor = np.mean([result(name, seed).floor_um for seed in SEEDS])

    assert left == pytest.approx(np.sqrt(2.0) * floor, rel=0.15)


def test_the_approaches_take_as_much_longer_as_the_document_says() -> None:
    increase = np.mean([result("haas", seed).time_increase for seed in SEEDS])

    assert increase == pytest.approx(0.046, abs=TIME_GOAL)


def test_another_grid_of_as_many_directions_takes_another_time() -> None:
    """So the agreement with the document is weak evidence: it does not give its grid."""
    haas = RIGS["haas"]
    betas_deg = tuple(15.0 * row for row in range(6))
    other = replace(haas, directions=grid(betas_deg, 18, with_pole=True))
    increases = [
        run(replace(other, seat=replace(haas.seat, azimuth_deg=azimuth_deg)), seed=1).time_increase
        for azimuth_deg in (0.0, 5.0)
    ]

    assert len(other.directions) == len(haas.directions) == 109
    assert increases == pytest.approx([0.066, 0.039], abs=0.003)


def test_all_touches_together_vary_as_the_document_says_of_the_laboratory() -> None:
    for name, document_um in (("omp40-2", 11.0), ("omp60", 16.8)):
        seen_um = np.mean([result(name, seed).before.all_vr_um for seed in SEEDS])

        assert seen_um == pytest.approx(document_um, rel=0.05)


def test_a_second_iteration_leaves_no_more_than_the_first() -> None:
    once, twice = result("haas"), run(RIGS["haas"], seed=1, iterations=2)

    assert twice.after.vr_um < 1.5 * once.after.vr_um
    assert not np.array_equal(twice.after.feed_mm_min, once.after.feed_mm_min)


def test_a_scan_makes_the_delay_longer_and_leaves_more_behind() -> None:
    polled = run(RIGS["haas"], seed=1, path=InputPath.PLC)

    half_a_scan_ms = 2.0
    assert polled.tau.tau_ms - result("haas").tau.tau_ms == pytest.approx(half_a_scan_ms, abs=0.5)
    assert polled.after.vr_um > 1.5 * result("haas").after.vr_um


def test_the_result_depends_on_the_seed_and_not_on_the_threads() -> None:
    rig = quick(RIGS["haas"])
    one, two = run(rig, seed=3, jobs=1), run(rig, seed=3, jobs=2)

    assert np.array_equal(one.after.all_um, two.after.all_um)
    assert not np.array_equal(one.before.all_um, run(rig, seed=4).before.all_um)


def test_an_artefact_off_centre_has_the_radii_of_one_on_centre() -> None:
    """Inside and outside, whichever moves: the fit finds the centre."""
    rig = quick(RIGS["haas"])
    shifted = replace(rig, target=replace(rig.target, offset_mm=(0.05, -0.02, 0.03)))
    centred = replace(rig, target=replace(rig.target, offset_mm=(0.0, 0.0, 0.0)))

    off_um, on_um = run(shifted, seed=1).before.mean_um, run(centred, seed=1).before.mean_um

    assert off_um == pytest.approx(on_um, abs=0.3)  # 0.1 µm of resolution, and the other normal


def test_the_approach_ends_where_the_tip_meets_the_surface() -> None:
    pushed = Directions(np.arange(0.0, 360.0, 30.0), np.full(12, 20.0)).unit
    for side in Side:
        for is_moved in (False, True):
            target = Target(
                side=side,
                radius_mm=10.0,
                offset_mm=(0.1, 0.2, -0.3),
                is_moved=is_moved,
                clearance_mm=1.0,
            )
            if side is Side.OUTSIDE and is_moved:
                continue  # no rig moves an artefact from outside against the tip
            way = target.approach_mm(pushed)[:, np.newaxis] * target.motion(pushed)
            ends = target.starts_mm(pushed) + way

            distances = np.linalg.norm(ends - np.array(target.offset_mm), axis=1)
            assert distances == pytest.approx(10.0)


def test_a_touch_that_is_not_latched_ends_the_experiment() -> None:
    rig = RIGS["haas"]
    limp = replace(rig.seat, stem_n_m2=1e-5)  # bends by centimetres before it triggers
    station = Station(rig.nominal, limp, path=InputPath.SKIP, seed=1)

    with pytest.raises(SimulationError, match="were not latched"):
        station.touch(rig.target, rig.directions, np.full(109, 100.0), runs=1)


def test_every_figure_says_whether_it_is_evidence() -> None:
    figures = paper.figures([result("haas")])

    by_name = {figure.name: figure for figure in figures}
    assert {figure.evidence for figure in figures} == {paper.SET, paper.FOUND}
    assert by_name["V_r before, mean of the runs"].evidence == paper.SET
    assert by_name["time increase"].difference == pytest.approx(
        100.0 * result("haas").time_increase - 4.6
    )


@pytest.mark.parametrize("name", ["omp40-2", "omp60"])
def test_the_laboratory_figures_as_printed_do_not_fit_together(name: str) -> None:
    """A map after is the one before and what the feeds add: its range cannot be so much less."""
    printed = RIGS[name].reported
    added_um = (printed.feed_max_mm_min - printed.feed_min_mm_min) * printed.tau_ms / 60.0

    excess_um = printed.vr_before_um - printed.vr_after_um - added_um

    assert excess_um > 1.9 * np.sqrt(2.0) * 0.3  # U(V_r) = 0.6 µm (k = 2), of either map


def test_what_is_simulated_fits_together() -> None:
    by_name = {figure.name: figure for figure in paper.figures([result("omp40-2")])}

    assert by_name["V_r before, mean of the runs"].ours < by_name["V_r before, at most"].ours
    assert by_name["W above the least radius, of the range"].paper == pytest.approx(0.458, abs=1e-3)


def test_several_trials_give_a_mean_and_an_interval() -> None:
    trials = [result("haas", seed) for seed in SEEDS]

    tau = paper.figures(trials)[0]

    assert tau.ours == pytest.approx(np.mean([trial.tau.tau_ms for trial in trials]))
    assert tau.low is not None
    assert tau.high is not None
    assert tau.low < tau.ours < tau.high


@cache
def quick_result(name: str) -> Result:
    return run(quick(RIGS[name]), seed=1)


@pytest.mark.long
def test_the_lobes_of_a_recorded_probe_are_diagnosed(tmp_path: Path) -> None:
    """The probe is played by its mechanics, not by the effect that is named."""
    campaigns.record(tmp_path, quick_result("haas"))

    found = diagnose(thinned(read_campaign(tmp_path / campaigns.BEFORE)), seed=1, jobs=2)

    assert [named.effect.id for named in found.effects] == ["pretravel_lobing"]
    assert 5.0 < found.effects[0].effect.parameters["amplitude_um"] < 9.0
    azimuth_deg = RIGS["haas"].seat.azimuth_deg + 60.0  # between two directions of least force
    assert found.effects[0].effect.parameters["azimuth_deg"] == pytest.approx(azimuth_deg, abs=3.0)


@pytest.mark.long
@pytest.mark.parametrize("name", ["omp60", "haas"])
def test_compensated_it_shows_no_gap(name: str, tmp_path: Path) -> None:
    """Of every second touch lobes of 0.1 µm would still be significant."""
    campaigns.record(tmp_path, quick_result(name))

    found = diagnose(thinned(read_campaign(tmp_path / campaigns.AFTER)), seed=1, jobs=2)

    assert found.verdict is Verdict.NO_GAP


@pytest.mark.parametrize("name", ["omp60", "haas"])
def test_recorded_deviations_are_those_of_the_map(name: str, tmp_path: Path) -> None:
    """About the centre that was found, also where that is far off for the artefact's size."""
    result = quick_result(name)
    campaigns.record(tmp_path, result)

    touches = read_campaign(tmp_path / campaigns.AFTER).touches
    recorded_um = touches.deviation_um.reshape(result.rig.runs, -1).mean(axis=0)

    assert recorded_um == pytest.approx(result.after.mean_um, abs=0.002)
