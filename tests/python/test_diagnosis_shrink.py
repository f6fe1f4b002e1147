"""How far a gap shrinks, on campaigns whose effects are known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scoringrules import crps_ensemble  # type: ignore[import-untyped]

from played_campaigns import BENCH, LATE_BENCH, MACHINE, played, played_again, stamped_machine
from skiplatch.arrays import BoolArray
from skiplatch.campaign import Campaign, Datum, DatumFreedom, InputPath, read_campaign
from skiplatch.comparison import compare
from skiplatch.comparison.cells import cells_of, feed_groups
from skiplatch.comparison.observables import OBSERVABLES
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import as_recorded
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.cell_scores import Cell, CellScores, TouchScores, floor_of
from skiplatch.diagnosis.verdict.shrink import Gap, PlayedRigs, _floor, _gap, _share_gone
from skiplatch.simulator.effects import Effect
from skiplatch.statistics import Interval

LATE = Effect("isr_latency", {"latency_us": 41.7})
DELAY = Effect("trigger_delay", {"delay_us": 150.0})
HALF = Effect("trigger_delay", {"delay_us": 75.0})


def held_out(campaign: Campaign) -> BoolArray:
    """About three touches in ten."""
    return np.random.default_rng(1).random(len(campaign.touches)) < 0.3


def shrunk(
    campaign: Campaign, *found: Effect, truth: Sequence[Effect] | None = None, jobs: int = 2
) -> Mapping[str, Gap]:
    scene = Scene.of(campaign)
    before, after = (Rig(scene.nominal, effects) for effects in ((), found))
    oracle = None if truth is None else Rig(scene.nominal, truth)
    played_rigs = PlayedRigs.of(scene, before, after, seed=1, jobs=jobs, truth=oracle)
    return played_rigs.gaps(held_out(campaign))


def test_a_gap_on_one_path_shows_at_its_size() -> None:
    gap = shrunk(read_campaign(LATE_BENCH), LATE)["latch_after_edge_us"]

    assert gap.before == pytest.approx(41.7, abs=0.3)
    assert gap.after == pytest.approx(gap.noise_floor, abs=0.05)
    assert gap.shrink.low > 0.95
    assert gap.is_clear


def test_feeds_of_few_touches_show_a_gap_together() -> None:
    """A campaign of a few dozen touches has one or two that are held out at each feed."""
    late = read_campaign(LATE_BENCH)
    skip = late.touches.path == InputPath.SKIP
    feeds = np.unique(late.touches.feed_mm_min)
    rows = [np.flatnonzero(skip & (late.touches.feed_mm_min == feed))[:7] for feed in feeds]
    few = replace(late, touches=late.touches.select(np.sort(np.concatenate(rows))))
    assert not list(cells_of(few.touches, held_out(few), 3))

    gap = shrunk(few, LATE)["latch_after_edge_us"]

    assert gap.before == pytest.approx(41.7, abs=1.0)
    assert gap.is_clear


def test_a_lock_shows_though_surfaces_lie_apart() -> None:
    """Edges that wait alike do so from each surface on, wherever that is."""
    lock = Effect("scan_phase_lock", {"phase": 0.1, "spread": 0.01})
    campaign = stamped_machine()
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.AXIS))
    datum = FittedDatum({"X": -600.0, "Y": 900.0, "Z": 0.0})
    believed, real = Rig(nominal, (), datum), Rig(nominal, (lock,), datum)
    outcomes = real.play(campaign.touches, seed=3, replicates=1)
    scene = Scene(nominal, as_recorded(campaign.touches, outcomes, 0))

    gap = PlayedRigs.of(scene, believed, real, seed=1, jobs=1).gaps(held_out(campaign))

    assert gap["deviation_um"].is_clear
    assert gap["deviation_um"].shrink.low > 0.8


def test_a_feed_that_is_off_shows_by_when_edges_come() -> None:
    """Positions tell little of it: they count from the edge on."""
    slow = Effect("feed_error", {"feed_percent": -10.0})
    gap = shrunk(played(BENCH, slow), slow)

    assert gap["edge_after_contact_us"].before > 100.0 * gap["edge_after_contact_us"].noise_floor
    assert gap["edge_after_contact_us"].shrink.low > 0.99


def test_machines_that_record_no_edge_have_no_gap_of_it() -> None:
    assert "edge_after_contact_us" not in shrunk(played(MACHINE, DELAY), DELAY)


def test_late_scans_show_beside_the_grid_that_they_should_keep() -> None:
    late = Effect("scan_jitter", {"jitter_us": 300.0})
    gap = shrunk(played(BENCH, late), late)["latch_off_scan_grid_us"]

    assert gap.before > 1.3 * gap.noise_floor
    assert gap.after < 1.1 * gap.noise_floor
    assert gap.shrink.value > 0.8


def test_a_lock_is_asked_for_the_grid_where_the_record_has_left_it() -> None:
    """Plays move scans to the touches; a rig whose touches wait for its scans keeps their grid."""
    lock = Effect("scan_phase_lock", {"phase": 0.3, "spread": 0.03})
    left = shrunk(played(BENCH, lock), lock)

    assert left["latch_off_scan_grid_us"].shrink.low > 0.9
    assert "latch_off_scan_grid_us" not in shrunk(played(BENCH), lock)


def test_half_of_the_cause_takes_away_part_of_the_gap() -> None:
    gap = shrunk(played(MACHINE, DELAY), HALF, truth=[DELAY])["deviation_um"]

    assert gap.noise_floor < gap.after < gap.before
    assert 0.4 < gap.shrink.value < 0.7
    assert gap.oracle_shrink is not None
    assert gap.oracle_shrink.value > 0.95
    assert gap.shrink.value == pytest.approx(
        (gap.before - gap.after) / (gap.before - gap.noise_floor)
    )


def test_an_effect_that_is_not_there_makes_a_gap() -> None:
    gap = shrunk(read_campaign(MACHINE), DELAY)["deviation_um"]

    assert gap.after > 5.0 * gap.before
    assert gap.shrink.value == pytest.approx(-1.0)


def test_what_has_not_come_by_chance_makes_no_gap_grow() -> None:
    """One touch in twenty is late: that none of the few held out is, is luck."""
    rare = Effect("contact_bounce", {"probability": 0.05, "mean_us": 300.0})
    scene = Scene.of(read_campaign(BENCH))
    few = np.arange(len(scene)) % 12 == 0
    before, after = (Rig(scene.nominal, effects) for effects in ((), [rare]))

    gaps = PlayedRigs.of(scene, before, after, seed=1, jobs=2).gaps(few)

    assert not any(gap.grows for gap in gaps.values())


def test_one_cell_in_which_nothing_came_by_chance_makes_no_gap_grow() -> None:
    """Its plays are late there, each time; beside what all the other cells show that is luck."""
    queue = Effect("report_delay", {"queue_us": 200.0, "unqueued_share": 0.6})
    scene = Scene.of(played(BENCH, queue))
    touches = scene.touches
    late = touches.report_us - touches.latch_us > scene.nominal.report.latency_us + 60.0
    _, _, cell = next(iter(cells_of(touches, np.full(len(scene), fill_value=True), 1)))
    is_there = np.isin(np.arange(len(scene)), cell)
    rows = np.where(is_there, ~late, np.arange(len(scene)) % 4 == 0)
    before, after = (Rig(scene.nominal, effects) for effects in ((), [queue]))

    gap = PlayedRigs.of(scene, before, after, seed=1, jobs=2).gaps(rows)["report_after_latch_us"]

    assert late[is_there].any()
    assert not gap.grows


def test_what_has_not_come_by_chance_scatters_no_less_than_its_plays() -> None:
    rare = Effect("contact_bounce", {"probability": 0.05, "mean_us": 300.0})
    scene = Scene.of(read_campaign(BENCH))
    few = np.arange(len(scene)) % 12 == 0
    before, after = (Rig(scene.nominal, effects) for effects in ((), [rare]))

    for seed in range(4):
        gaps = PlayedRigs.of(scene, before, after, seed=seed, jobs=2).gaps(few)
        assert [gap.tightness for gap in gaps.values()] == [1.0] * len(gaps)


def test_what_the_effects_hardly_ever_do_makes_a_gap_grow() -> None:
    often = Effect("contact_bounce", {"probability": 0.9, "mean_us": 300.0})

    assert shrunk(read_campaign(BENCH), often)["latch_after_edge_us"].grows
    assert not shrunk(played(BENCH, often), often)["latch_after_edge_us"].grows


def test_a_record_that_scatters_less_than_the_plays_is_close_to_them_by_no_luck() -> None:
    often = Effect("contact_bounce", {"probability": 0.5, "mean_us": 300.0})
    hardly = Effect("contact_bounce", {"probability": 0.5, "mean_us": 30.0})

    assert shrunk(played(BENCH, hardly), often)["latch_after_edge_us"].tightness < 0.5
    assert shrunk(played(BENCH, often), often)["latch_after_edge_us"].tightness == 1.0
    assert shrunk(played(BENCH, often), hardly)["latch_after_edge_us"].tightness >= 1.0


@pytest.mark.parametrize(("late_us", "is_hidden"), [(3.0, False), (60.0, True)])
def test_scatter_that_is_little_beside_the_gap_hides_none_of_it(
    late_us: float, is_hidden: bool
) -> None:
    bounce = Effect("contact_bounce", {"probability": 0.5, "mean_us": late_us})

    gap = shrunk(played(BENCH, LATE), LATE, bounce)["latch_after_edge_us"]

    assert gap.noise_floor > 1.0
    assert (gap.tightness < 0.5) is is_hidden


def test_a_rig_that_is_calmer_than_believed_is_no_fault_of_an_effect() -> None:
    late = Effect("isr_latency", {"latency_us": 40.0})
    calm = read_campaign(BENCH).nominal
    calm = replace(calm, skip=replace(calm.skip, jitter_us=0.0))
    touches = played_again(replace(read_campaign(BENCH), nominal=calm), late).touches
    scene = Scene.of(replace(read_campaign(BENCH), touches=touches))
    before, after = (Rig(scene.nominal, effects) for effects in ((), [late]))

    gaps = PlayedRigs.of(scene, before, after, seed=1, jobs=2).gaps(np.ones(len(scene), bool))

    assert [gap.tightness for gap in gaps.values()] == [1.0] * len(gaps)


@pytest.mark.parametrize("folder", [MACHINE, BENCH])
def test_without_a_gap_nothing_shrinks(folder: str) -> None:
    for name, gap in shrunk(read_campaign(folder)).items():
        assert gap.before == gap.after, name
        assert gap.shrink.value == 0.0, name
        assert not gap.is_clear, name
        assert gap.before < 1.25 * gap.noise_floor + 0.05, name


def test_every_interval_holds_its_value() -> None:
    for effect in (DELAY, HALF):
        for gap in shrunk(played(MACHINE, DELAY), effect).values():
            assert gap.shrink.low <= gap.shrink.value <= gap.shrink.high
    for gap in shrunk(played(BENCH, LATE), LATE).values():
        assert gap.shrink.low <= gap.shrink.value <= gap.shrink.high


def scored(before: float, after: float, floor: float, nominal_floor: float) -> CellScores:
    """Ten touches that all score alike."""
    ones = np.ones(10)
    return CellScores(ones, before * ones, after * ones, floor * ones, nominal_floor * ones, None)


def share_gone(scores: CellScores, *, is_clear: bool) -> Interval:
    """Give the share of their gap that is gone."""
    samples = (scores.before - scores.after, scores.before - _floor(scores))
    return _share_gone(samples, seed=1, is_clear=is_clear)


def test_without_a_clear_gap_the_interval_holds_zero() -> None:
    scores = scored(2.0, 1.0, 0.5, 0.5)
    unclear = share_gone(scores, is_clear=False)
    clear = share_gone(scores, is_clear=True)

    assert (unclear.low, unclear.value) == (0.0, 0.0)
    assert clear.value == clear.low == clear.high == pytest.approx(2.0 / 3.0)


def test_a_gap_that_is_hardly_one_is_measured_by_one_floor() -> None:
    """In a resample without it, what is gone is not held against another, far lower floor."""
    luck = 1.1 * np.random.default_rng(2).standard_normal(300)
    luck -= luck.mean()
    ones = np.ones(len(luck))
    scores = CellScores(ones, 10.1 + luck, 9.8 * ones, 10.0 * ones, ones, None)

    assert share_gone(scores, is_clear=True).low == pytest.approx(1.0)


def test_effects_that_scatter_too_much_do_not_make_the_gap_small() -> None:
    """Their own floor lies above what was there before: 1 of 20 above the nominal one is gone."""
    scores = scored(before=30.0, after=29.0, floor=40.0, nominal_floor=10.0)

    assert share_gone(scores, is_clear=True).value == pytest.approx(0.05)


@pytest.mark.parametrize(("miss", "is_clear"), [(0.4, False), (0.7, True)])
def test_plays_that_all_round_alike_may_be_off_by_half_a_step(miss: float, is_clear: bool) -> None:
    """They have no noise floor; what was recorded may round the other way."""
    exact = np.zeros(12)
    off = TouchScores(np.linspace(miss, miss + 0.01, 12), exact)
    cell = Cell(InputPath.SKIP, TouchScores(exact, exact), off, None)

    assert CellScores.of([cell], least=1.0 / 6.0).is_clear(0.001) == is_clear


def test_one_touch_that_effects_miss_by_far_hides_nothing_of_what_they_do_for_the_others() -> None:
    nearly = np.linspace(1.0, 1.03, 30)
    after = np.concatenate([nearly[1:], [40.0]])
    before, floor = np.linspace(3.0, 3.1, 30), np.full(30, 5.0)
    scores = CellScores(np.ones(30), before, after, floor, np.ones(30), None)

    assert stats.ttest_1samp(scores.before - after, 0.0).pvalue > 0.1
    assert scores.is_clear(0.001)


def test_wide_cells_do_not_drown_the_narrow_ones() -> None:
    ones = np.ones(10)

    def cell(path: InputPath, before: float, after: float, floor: float) -> Cell:
        scored = [TouchScores(score * ones, floor * ones) for score in (before, after)]
        return Cell(path, scored[0], scored[1], None)

    narrow = cell(InputPath.SKIP, 10.0, 1.0, 1.0)
    wide = cell(InputPath.PLC, 110.0, 110.0, 100.0)
    gap = _gap([narrow, wide], OBSERVABLES[0], 0.01, seed=1)

    assert gap.shrink.value == pytest.approx((11.1 - 2.1) / (11.1 - 2.0))


def test_a_path_of_small_cells_counts_beside_a_cell_that_shows_its_gap_alone() -> None:
    """Three touches in a cell are too few for a level of one in two thousand."""
    near = np.array([0.8, 1.0, 1.2])

    def cell(path: InputPath, before: float, after: float) -> Cell:
        scored = [TouchScores(score * near, np.ones(3)) for score in (before, after)]
        return Cell(path, scored[0], scored[1], None)

    small = [cell(InputPath.SKIP, 10.0, 1.0) for _ in range(8)]
    alone = Cell(InputPath.PLC, *2 * (TouchScores(9.0 + 0.001 * near, np.ones(3)),), truth=None)
    gap = _gap([*small, alone], OBSERVABLES[0], 0.01, seed=1)

    assert gap.before == pytest.approx((8 * 10.0 + 9.0) / 9, rel=1e-3)
    assert gap.shrink.value == pytest.approx(8 * 9.0 / (8 * 9.0 + 8.0), abs=0.01)


def test_only_touches_held_out_count() -> None:
    campaign = played(MACHINE, DELAY)
    off = np.where(held_out(campaign), 0.0, 1e3)
    touches = replace(campaign.touches, deviation_um=campaign.touches.deviation_um + off)

    assert shrunk(replace(campaign, touches=touches), DELAY) == shrunk(campaign, DELAY)


def test_threads_do_not_matter() -> None:
    campaign = played(MACHINE, DELAY)

    assert shrunk(campaign, DELAY, jobs=1) == shrunk(campaign, DELAY, jobs=2)


def test_the_floor_is_what_plays_score_on_each_other() -> None:
    plays = np.random.default_rng(1).exponential(size=(5, 20))
    scores = [
        crps_ensemble(plays[:, i], np.delete(plays, i, axis=1), estimator="pwm", backend="numpy")
        for i in range(plays.shape[1])
    ]

    np.testing.assert_allclose(floor_of(plays), np.mean(scores, axis=0))


def test_touches_that_each_have_their_own_feed_are_grouped() -> None:
    campaign = read_campaign(MACHINE)
    feeds = np.linspace(100.0, 3000.0, len(campaign.touches))
    touches = replace(campaign.touches, feed_mm_min=feeds)
    known = np.full(len(feeds), fill_value=True)

    assert len(np.unique(feed_groups(feeds))) == 8
    assert sum(len(rows) for *_, rows in cells_of(touches, known, 3)) == len(feeds)
    assert compare(replace(campaign, touches=touches), seed=1, jobs=2).cells
    np.testing.assert_array_equal(feed_groups(feeds[:12]), feeds[:12])


def test_cells_keep_paths_and_feeds_apart() -> None:
    touches = read_campaign(MACHINE).touches
    known = np.full(len(touches), fill_value=True)
    cells = list(cells_of(touches, known, 3))

    assert {path for path, _, _ in cells} == set(InputPath)
    for path, feed, rows in cells:
        assert np.all(touches.path[rows] == path)
        assert np.all(touches.feed_mm_min[rows] == feed)


def test_stamps_keep_the_grid_of_scans_whose_period_is_far_off() -> None:
    """They are held against the grid of that period: on the believed one they lie anywhere."""
    slower = Effect("scan_period", {"period_us": 1100.0})
    scene = Scene.of(played(BENCH, slower))
    rigs = (Rig(scene.nominal, effects) for effects in ((), (slower,)))

    every = np.full(len(scene), fill_value=True)
    gap = PlayedRigs.of(scene, *rigs, seed=1, jobs=2).gaps(every)["latch_off_scan_grid_us"]

    assert gap.is_clear
    assert gap.after < 0.01 * gap.before
    assert gap.shrink.low > 0.99
