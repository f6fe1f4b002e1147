"""What a rig leaves of touches: nothing where it plays itself, and what was put there where not."""

import re
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Status, Touches, read_campaign
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.likelihood.likelihood import MISSED
from skiplatch.diagnosis.plays.left import EVERYWHERE, RESOLVED, Left, Memo
from skiplatch.diagnosis.plays.leftover import NOTICED, Beside, left_over, noticed
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import as_recorded
from skiplatch.diagnosis.plays.scores import normal_scores
from skiplatch.diagnosis.plays.telling import FEWEST
from skiplatch.diagnosis.scene.observed import observed
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect
from skiplatch.span import Span

Disturbed = Callable[[Touches], FloatArray]


def looks(campaign: Campaign, memo: Memo | None = None, seed: int = 1) -> list[Left]:
    return left_over(Beside.of(Scene.of(campaign), Rig(campaign.nominal), seed=seed), memo)


def mattering(campaign: Campaign) -> list[Left]:
    return [one for one in looks(campaign) if one.is_significant and one.is_material(DEFAULT)]


def disturbed(campaign: Campaign, off_um: Disturbed) -> Campaign:
    touches = campaign.touches.in_order_of_time()
    deviation_um = touches.deviation_um + off_um(touches)
    return replace(campaign, touches=replace(touches, deviation_um=deviation_um))


def rests(touches: Touches) -> FloatArray:
    """Time since the touch before; 0 where that one was not recorded."""
    rest_s = np.diff(touches.time_s, prepend=touches.time_s[0])
    return np.where(np.diff(touches.touch, prepend=-2) == 1, rest_s, 0.0)


def told_by(found: Sequence[Left], kind: str) -> str:
    """All that something of a kind in the position goes with, in one text."""
    here = [one for one in found if one.kind == kind and one.observable == "position"]
    return "; ".join(name for one in here for name in one.conditions)


@pytest.mark.parametrize("folder", [MACHINE, BENCH])
def test_a_rig_leaves_nothing_of_its_own_plays(folder: Path) -> None:
    """False alarms at five standard errors, over some thirty looks: one in 100,000 campaigns."""
    for seed in range(2):
        assert mattering(played(folder, seed=seed)) == []


def test_touches_are_played_after_those_that_are_not_looked_at() -> None:
    """A clock that follows the temperature has run since the first touch, whichever are left."""
    clock = Effect("timer_drift", {"drift_ppm": 5.0, "warmth_ppm_k": 3.0})
    campaign = played(BENCH, clock)
    some = Scene.of(campaign).select(np.random.default_rng(2).random(len(campaign.touches)) < 0.6)

    found = left_over(Beside.of(some, Rig(campaign.nominal, [clock]), seed=1))

    assert not [one for one in found if one.is_significant and one.is_material(DEFAULT)]


def feed_um(touches: Touches) -> FloatArray:
    return np.asarray(3.0 * (touches.feed_mm_min > np.median(touches.feed_mm_min)))


def interacting_um(touches: Touches) -> FloatArray:
    """With the sense at high feeds, and against it at low ones: on average with neither."""
    fast = np.where(touches.feed_mm_min > np.median(touches.feed_mm_min), 1.0, -1.0)
    alone = np.column_stack([np.ones(len(touches)), touches.sign, touches.feed_mm_min, fast])
    together = touches.sign * fast
    return np.asarray(6.0 * (together - alone @ np.linalg.lstsq(alone, together, rcond=None)[0]))


def every_fifth_um(touches: Touches) -> FloatArray:
    return np.asarray(4.0 * (touches.touch % 5 == 0))


def test_a_shift_with_a_condition_is_found_and_named() -> None:
    found = mattering(disturbed(played(MACHINE), feed_um))

    assert "feed" in told_by(found, "shift")
    assert {one.path for one in found if one.kind == "shift"} >= {"skip"}


def test_its_size_is_half_of_what_touches_are_apart() -> None:
    found = mattering(disturbed(played(MACHINE), feed_um))

    shifts = [one for one in found if one.conditions == ("feed",) and one.kind == "shift"]
    size_um = next(one.size for one in shifts if one.path == "skip")
    assert size_um == pytest.approx(1.5, abs=0.3)


def test_an_interaction_that_no_condition_shows_alone_is_found() -> None:
    campaign = disturbed(played(MACHINE), interacting_um)
    touches, off_um = campaign.touches, interacting_um(campaign.touches)
    for alone in (touches.sign, touches.feed_mm_min):
        assert abs(np.corrcoef(alone, off_um)[0, 1]) < 1e-6

    assert {"shift"} <= {one.kind for one in mattering(campaign) if one.is_predicted}


def test_every_fifth_touch_is_found() -> None:
    found = mattering(disturbed(played(MACHINE), every_fifth_um))

    assert "serial number in a cycle of 5" in told_by(found, "shift")


def test_a_fast_wave_in_time_is_found_with_its_period() -> None:
    def wave_um(touches: Touches) -> FloatArray:
        return np.asarray(4.0 * np.sin(2.0 * np.pi * touches.time_s / 180.0))

    found = mattering(disturbed(played(MACHINE), wave_um))

    waves = re.findall(r"time, in waves of ([0-9.]+) s", told_by(found, "wave"))
    assert waves
    assert [float(period) for period in waves] == pytest.approx([180.0] * len(waves), rel=0.02)


def test_a_wave_in_the_temperature_is_found() -> None:
    campaign = played(MACHINE)
    period_k = 0.31 * float(np.ptp(campaign.touches.temp_c))

    def wave_um(touches: Touches) -> FloatArray:
        return np.asarray(1.5 * np.sin(2.0 * np.pi * touches.temp_c / period_k))

    found = mattering(disturbed(campaign, wave_um))

    assert "temperature" in told_by(found, "wave")


def test_lobes_of_any_number_are_found_by_their_angle() -> None:
    campaign = read_campaign(MACHINE)
    turned = np.random.default_rng(4).uniform(0.0, 360.0, len(campaign.touches))
    touches = replace(campaign.touches, alpha_deg=turned)
    campaign = played_again(replace(campaign, touches=touches))

    def lobes_um(touches: Touches) -> FloatArray:
        return np.asarray(2.0 * np.sin(np.deg2rad(5.0 * touches.alpha_deg)))

    found = mattering(disturbed(campaign, lobes_um))

    assert re.search(r"azimuth, in waves of 7[12]", told_by(found, "wave"))


def test_what_scatters_for_a_time_leaves_nothing_of_its_own_plays() -> None:
    """Touches that all plays meet alike are no calmer than those that scatter as played."""
    touches = read_campaign(BENCH).touches
    span = Span(until=int(np.median(touches.touch)))
    shaky = Effect("scan_jitter", {"jitter_us": 70.0}, span)
    scene = Scene.of(played(BENCH, shaky))

    found = left_over(Beside.of(scene, Rig(scene.nominal, [shaky]), seed=1))

    scattered = [one.z for one in found if (one.observable, one.kind) == ("grid", "scatter")]
    assert max(scattered) < NOTICED


def test_scatter_that_goes_with_the_rest_before_is_found() -> None:
    noise_um = np.random.default_rng(3).normal(0.0, 6.0, 400)

    def restless_um(touches: Touches) -> FloatArray:
        return np.asarray(noise_um * (rests(touches) > np.median(rests(touches))))

    found = mattering(disturbed(played(MACHINE), restless_um))

    assert "rest" in told_by(found, "scatter")


def test_a_wait_that_is_bound_to_the_scan_is_found_though_it_scatters_less() -> None:
    bound = Effect("scan_phase_lock", {"phase": 0.5, "spread": 0.03, "unlocked": 0.3})

    found = mattering(played(BENCH, bound))

    assert {(one.observable, one.kind) for one in found if one.path == "plc"} >= {
        ("latch", "shape")
    }


def test_plays_that_move_scans_to_touches_are_not_asked_for_a_grid_that_was_kept() -> None:
    lock = Effect("scan_phase_lock", {"phase": 0.3, "spread": 0.06})
    moved = played(BENCH, lock)
    kept = read_campaign(BENCH)

    def observables(campaign: Campaign) -> set[str]:
        beside = Beside.of(Scene.of(campaign), Rig(campaign.nominal, [lock]), seed=1)
        return {look.name for look in beside.looks["plc"]}

    assert "grid" not in observables(kept)
    assert observables(moved) == {*observables(kept), "grid"}


def test_touches_that_all_meet_one_point_of_the_scan_are_found_by_the_edges_recorded() -> None:
    """All waits follow from the edges and the grid: it is the edges that are not anywhere."""
    campaign = played(BENCH, seed=5)
    touches, period = campaign.touches, campaign.nominal.plc.scan_us
    behind_us = campaign.nominal.input.filter_us
    rng = np.random.default_rng(5)
    wait_us = rng.normal(0.35, 0.04, len(touches)) * period
    edge_us = np.where(touches.on_plc, touches.latch_us - behind_us - wait_us, touches.edge_us)
    locked = replace(campaign, touches=replace(touches, edge_us=edge_us))

    found = mattering(locked)

    assert ("latch", "shape") in {(one.observable, one.kind) for one in found}


def test_a_few_scans_off_the_grid_are_found_by_how_far_and_leave_the_others_on_it() -> None:
    campaign = played(BENCH)
    touches = campaign.touches
    few = np.flatnonzero(touches.on_plc)[::40]
    stamps = touches.latch_us.copy()
    stamps[few] += 1300.0
    late = replace(campaign, touches=replace(touches, latch_us=stamps))
    scene = Scene.of(late)

    on_grid = np.delete(observed(scene, touches)["grid"], few)
    found = next(one for one in looks(late) if one.observable == "grid")

    assert np.nanmax(np.abs(on_grid)) < 3.0 * campaign.nominal.skip.tick_us
    assert found.kind == "scatter"
    assert found.is_significant


def test_stamps_beside_a_period_that_was_fitted_stay_on_its_grid() -> None:
    """An hour of scans, each off by less than a nanosecond: by millions of them it adds up."""
    campaign = played(BENCH)
    nominal, touches = campaign.nominal, campaign.touches
    fitted = replace(nominal, plc=replace(nominal.plc, scan_us=nominal.plc.scan_us + 0.000_43))
    hour = replace(touches, time_s=np.linspace(0.0, 3600.0, len(touches)))
    recorded = as_recorded(hour, Rig(fitted).play(hour, seed=2, replicates=1), 0)

    beside = Beside.of(Scene.of(replace(campaign, touches=recorded)), Rig(fitted), seed=1)

    for seen in (beside.recorded["grid"], beside.played["grid"]):
        assert np.nanmax(np.abs(seen)) < 3.0 * nominal.skip.tick_us


def test_touches_far_off_move_no_others_on_the_scans_that_they_share() -> None:
    """All scans of a rig are stamped early by one rest of a tick: a mean over all would move it."""
    campaign = played(BENCH)
    touches = campaign.touches
    off_um = np.zeros(len(touches))
    few = np.flatnonzero(touches.on_plc)[::30]
    off_um[few] = 150.0
    far = replace(campaign, touches=replace(touches, deviation_um=touches.deviation_um + off_um))

    calm, thrown = (
        Beside.of(Scene.of(one), Rig(one.nominal), seed=1).recorded["position"]
        for one in (campaign, far)
    )

    tick_um = campaign.nominal.skip.tick_us * Scene.of(campaign).speed
    assert np.nanmax(np.abs((thrown - calm - off_um) / tick_um)) < 0.1


def test_positions_on_a_coarser_grid_than_believed_are_found() -> None:
    coarse = Effect("encoder_quantisation", {"resolution_um": 2.6})

    steps = [one for one in mattering(played(MACHINE, coarse)) if one.kind == "steps"]

    assert "plc" in {one.path for one in steps}
    step_um = played(MACHINE).nominal.axis.resolution_um
    assert steps[0].size == pytest.approx(np.sqrt((2.6**2 - step_um**2) / 12.0), rel=1e-3)


@pytest.mark.parametrize("surfaces_keep_them", [True, False])
def test_latches_on_lines_that_the_surfaces_keep_show_no_encoder(surfaces_keep_them: bool) -> None:
    """A latch of 0 µm off lies where its surface does; one on whole µm beside that shows lines."""
    campaign = played(BENCH)
    touches = campaign.touches
    places_mm = np.random.default_rng(1).uniform(-150.0, 150.0, len(touches))
    lines_mm = np.round(places_mm, 3)
    beside_mm = 0.0 if surfaces_keep_them else 2e-4 * touches.sign
    surfaces = np.round(lines_mm + beside_mm, 4)
    off_um = np.round((lines_mm - surfaces) * touches.sign * 1000.0, 1)
    moved = replace(touches, position_mm=surfaces, deviation_um=off_um)

    found = looks(replace(campaign, touches=moved))

    assert ("steps" in {one.kind for one in found}) is not surfaces_keep_them


def test_a_few_that_are_lost_matter() -> None:
    found = mattering(played(BENCH, Effect("lost_trigger", {"probability": 0.08})))

    assert {one.observable for one in found} == {MISSED}


def test_which_are_lost_is_asked_only_while_they_are() -> None:
    """That none is before tells them by their number, which a rig that begins to lose them says."""
    bench = read_campaign(BENCH)
    since = int(np.median(bench.touches.touch))
    loses = Effect("lost_trigger", {"probability": 0.3}, Span(since=since))
    scene = Scene.of(played_again(bench, loses))

    always = Rig(scene.nominal, [replace(loses, span=Span())])
    begins = Rig(scene.nominal, [loses])
    missed = [
        [one for one in left_over(Beside.of(scene, rig, seed=1)) if one.observable == MISSED]
        for rig in (always, begins)
    ]

    assert max(one.z for one in missed[0]) > 4.5
    assert max(one.z for one in missed[1]) < 4.0


def test_one_that_is_missed_is_an_accident() -> None:
    campaign = played(BENCH)
    unseen = np.arange(len(campaign.touches)) == 7
    status = np.where(unseen, Status.MISSED, campaign.touches.status).astype(np.int8)
    blank = {
        name: np.where(unseen, np.nan, getattr(campaign.touches, name))
        for name in ("latch_us", "report_us", "deviation_um")
    }

    found = mattering(replace(campaign, touches=replace(campaign.touches, status=status, **blank)))

    assert found == []


def test_misses_that_go_with_the_feed_are_found() -> None:
    campaign = played(MACHINE)
    touches = campaign.touches
    fast = touches.feed_mm_min > np.median(touches.feed_mm_min)
    lost = fast & (np.random.default_rng(1).random(len(touches)) < 0.5)
    status = np.where(lost, Status.MISSED, touches.status).astype(np.int8)
    deviation_um = np.where(lost, np.nan, touches.deviation_um)
    missing = replace(touches, status=status, deviation_um=deviation_um)

    found = [one for one in mattering(replace(campaign, touches=missing)) if one.is_predicted]

    assert [one for one in found if one.observable == MISSED and "feed" in one.conditions]


def test_one_long_rest_before_a_touch_far_off_is_nothing_that_goes_with_rests() -> None:
    campaign = played(MACHINE)
    touches = campaign.touches.in_order_of_time()
    late_s = np.where(np.arange(len(touches)) >= 50, 3600.0, 0.0)
    off_um = np.where(np.arange(len(touches)) == 50, 100.0, 0.0)
    rested = replace(
        touches, time_s=touches.time_s + late_s, deviation_um=touches.deviation_um + off_um
    )

    found = mattering(replace(campaign, touches=rested))

    assert not [one for one in found if any("rest" in name for name in one.conditions)]


@pytest.mark.parametrize(("off_ticks", "is_news"), [(0.5, False), (1.0, True)])
def test_what_is_rounded_up_or_down_from_one_place_is_no_scatter(
    off_ticks: float, is_news: bool
) -> None:
    plain = played(BENCH)
    nominal = replace(plain.nominal, skip=replace(plain.nominal.skip, jitter_us=0.0))
    scene = Scene(nominal, plain.touches.in_order_of_time())
    stream = scene.streams["latch_skip"]
    off_us = off_ticks * nominal.skip.tick_us * np.where(scene.touches.touch % 2, 1.0, -1.0)
    moved_us = np.where(stream.rows, stream.law.mean + off_us - stream.residuals, 0.0)
    touches = replace(scene.touches, latch_us=scene.touches.latch_us + moved_us)

    found = mattering(replace(plain, nominal=nominal, touches=touches))

    scattered = {(one.observable, one.path) for one in found if one.kind == "scatter"}
    assert (("latch", "skip") in scattered) is is_news


@pytest.mark.parametrize(("share", "is_material"), [(0.99, False), (1.01, True)])
def test_a_difference_has_to_exceed_its_rounding(share: float, is_material: bool) -> None:
    step_um = 10.0
    size_um = share * RESOLVED * step_um
    left = Left("position", "skip", "shift", (EVERYWHERE,), size_um, "µm", 5.0, 1.0, step_um, 9.0)

    assert left.is_material(DEFAULT) is is_material
    assert left.is_material(Materiality(um=1.0)) is is_material


def test_a_stated_size_counts_in_place_of_the_scatter() -> None:
    left = Left("position", "skip", "shift", (EVERYWHERE,), 2.0, "µm", 0.1, 20.0, 0.0, 9.0)

    assert not left.is_material(DEFAULT)
    assert left.is_material(Materiality(um=1.9))
    assert not left.is_material(Materiality(um=2.1))


def test_what_is_missing_stays_missing() -> None:
    played_um = np.array([[1.0, np.nan, np.nan], [2.0, 5.0, np.nan], [3.0, 7.0, np.nan]])

    scores = normal_scores(np.array([np.nan, 6.0, 6.0]), played_um)

    assert np.isnan(scores[[0, 2]]).all()
    assert scores[1] == pytest.approx(0.0)  # between the two plays that are there


def test_ranks_are_normal_scores_of_even_shares() -> None:
    rng = np.random.default_rng(2)
    plays = rng.exponential(size=(60, 3000))

    scores = normal_scores(rng.exponential(size=3000), plays)

    assert scores.mean() == pytest.approx(0.0, abs=5.0 / np.sqrt(3000.0))
    assert scores.std() == pytest.approx(1.0, abs=0.07)
    assert np.isfinite(normal_scores(np.full(3000, 1e9), plays)).all()


def test_touches_among_equal_plays_are_ranked_by_lot() -> None:
    """They scatter as others do, and in the middle of the equal ones not at all."""
    rng = np.random.default_rng(2)
    values = np.zeros(3000)

    scores = normal_scores(values, np.zeros((60, 3000)), rng.random(3000))

    assert scores.std() == pytest.approx(1.0, abs=0.05)
    assert not normal_scores(values, np.zeros((60, 3000))).any()


def test_an_observable_of_a_few_touches_is_not_looked_at() -> None:
    campaign = played(BENCH)
    unknown = np.arange(len(campaign.touches)) >= FEWEST // 2
    report_us = np.where(unknown, np.nan, campaign.touches.report_us)
    few = replace(campaign, touches=replace(campaign.touches, report_us=report_us))

    names = {one.observable for one in looks(few)}

    assert "report" not in names
    assert {"edge", "latch", "position"} <= names


def test_a_memo_gives_the_same_and_is_what_is_looked_up() -> None:
    campaign, memo = disturbed(played(MACHINE), feed_um), Memo()

    first = looks(campaign, memo)

    assert first == looks(campaign) == looks(campaign, memo)
    assert len(memo) == 2  # the position on either path
    for found in memo.values():
        found.clear()
    assert looks(campaign, memo) == []


def test_looks_from_other_processes_are_the_same() -> None:
    beside = Beside.of(
        Scene.of(read_campaign(MACHINE)), Rig(read_campaign(MACHINE).nominal), seed=1
    )

    with ProcessPoolExecutor(2) as executor:
        assert left_over(beside, executor=executor) == left_over(beside)


def test_another_hypothesis_is_not_looked_up() -> None:
    campaign, memo = played(MACHINE), Memo()

    looks(campaign, memo)
    looks(disturbed(campaign, feed_um), memo)

    assert len(memo) == 4


def test_the_most_significant_comes_first() -> None:
    found = looks(disturbed(played(MACHINE), feed_um))

    assert [one.z for one in found] == sorted((one.z for one in found), reverse=True)


def test_what_is_noticed_is_named_by_its_streams_on_its_path() -> None:
    def left(observable: str, path: str, z: float = 4.0, relative: float = 1.0) -> Left:
        return Left(observable, path, "shift", ("feed",), relative, "µm", relative, 1.0, 0.0, z)

    def streams(one: Left) -> set[str]:
        return set(noticed([one], DEFAULT))

    assert streams(left("latch", "skip")) == {"latch_skip"}
    assert streams(left("position", "plc")) == {"position", "deviation_plc"}
    assert streams(left("edge", "skip")) == {"motion"}
    assert streams(left("grid", "plc")) == {"lattice"}
    assert streams(left("latch", "skip", z=3.4)) == set()
    assert streams(left("latch", "skip", relative=0.1)) == set()
