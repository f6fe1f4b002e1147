"""Touches far off all that their rig plays are listed, if they are few; and what could hide."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, thinned
from skiplatch.arrays import BoolArray
from skiplatch.campaign import Campaign, Status, Touches, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.plays.leftover import Beside
from skiplatch.diagnosis.plays.look import Look
from skiplatch.diagnosis.plays.outliers import gone_with, outliers
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.hidden import could_hide
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import Effect

FAR_UM = 1000.0


def listed(campaign: Campaign) -> list[int]:
    return list(outliers(Scene.of(campaign), Rig(campaign.nominal), seed=1).touches)


def thrown(campaign: Campaign, rows: np.ndarray) -> Campaign:
    """Let touches read far off."""
    off_um = np.zeros(len(campaign.touches))
    off_um[rows] = FAR_UM
    touches = campaign.touches
    return replace(campaign, touches=replace(touches, deviation_um=touches.deviation_um + off_um))


@pytest.mark.parametrize("folder", [MACHINE, BENCH])
def test_touches_far_off_are_listed_by_their_numbers(folder: Path) -> None:
    campaign = played(folder)
    rows = np.array([7, 90, 301])
    numbers = campaign.touches.touch[rows].tolist()
    assert numbers != rows.tolist()

    assert listed(thrown(campaign, rows)) == numbers


def test_latches_without_a_contact_are_accidents_as_well() -> None:
    campaign = played(MACHINE)
    touches, rows = campaign.touches, np.array([7, 90, 301])
    status = touches.status.copy()
    status[rows] = Status.FALSE
    shaken = replace(campaign, touches=replace(touches, status=status))

    assert listed(shaken) == touches.touch[rows].tolist()


@pytest.mark.long
@pytest.mark.parametrize(("share", "verdict"), [(0.03, Verdict.NO_GAP), (0.2, Verdict.UNKNOWN)])
def test_so_few_latches_without_a_contact_are_no_gap(share: float, verdict: Verdict) -> None:
    campaign = thinned(played(MACHINE))
    touches = campaign.touches
    is_false = np.random.default_rng(2).random(len(touches)) < share
    status = np.where(is_false, Status.FALSE, touches.status).astype(np.int8)

    found = diagnose(replace(campaign, touches=replace(touches, status=status)), seed=1)

    assert is_false.sum() > 1
    assert found.verdict is verdict
    assert set(found.outliers) == (set(touches.touch[is_false]) if share < 0.05 else set())


@pytest.mark.parametrize("folder", [MACHINE, BENCH])
def test_a_rig_throws_none_of_its_own_touches_out(folder: Path) -> None:
    for seed in range(3):
        assert listed(played(folder, seed=seed)) == []


@pytest.mark.parametrize(("share", "is_told"), [(0.3, True), (0.6, False)])
def test_of_most_touches_none_is_far_off_the_others(share: float, is_told: bool) -> None:
    campaign = played(MACHINE)
    rows = np.flatnonzero(np.random.default_rng(1).random(len(campaign.touches)) < share)

    far = listed(thrown(campaign, rows))

    assert far == (campaign.touches.touch[rows].tolist() if is_told else [])


def test_a_report_far_off_is_an_outlier_as_well() -> None:
    campaign = played(BENCH)
    late_us = np.where(np.arange(len(campaign.touches)) == 33, 50_000.0, 0.0)
    touches = replace(campaign.touches, report_us=campaign.touches.report_us + late_us)

    assert listed(replace(campaign, touches=touches)) == [int(campaign.touches.touch[33])]


def test_what_one_touch_in_a_hundred_meets_is_no_outlier() -> None:
    """Some plays show it at each touch, so that those that met it are not far off all."""
    late = Effect("scan_overrun", {"probability": 0.01, "overrun_us": 9000.0, "span_us": 10.0})
    campaign = played(BENCH, late)

    assert listed(campaign), "without the effect they are"
    assert not outliers(Scene.of(campaign), Rig(campaign.nominal, [late]), seed=1).touches


def at_azimuths(touches: Touches) -> BoolArray:
    """One touch in twenty-five."""
    return np.asarray(touches.alpha_deg < np.quantile(touches.alpha_deg, 0.04))


def every_twentieth(touches: Touches) -> BoolArray:
    return np.asarray(touches.touch % 20 == 3)


@pytest.mark.parametrize(
    ("happens", "told"), [(at_azimuths, "azimuth"), (every_twentieth, "every 20 touches")]
)
def test_what_tells_which_touches_are_far_off_is_said(
    happens: Callable[[Touches], BoolArray], told: str
) -> None:
    touches = read_campaign(MACHINE).touches
    numbers = touches.touch[happens(touches)].tolist()

    assert told in gone_with(Scene.of(read_campaign(MACHINE)), numbers, seed=1)


def test_chance_may_be_why_accidents_fall_where_they_do() -> None:
    """The level is one in 300,000, and the law of so few is not quite normal."""
    scene = Scene.of(read_campaign(MACHINE))
    rng = np.random.default_rng(1)
    for count in (5, 10, 20, 20):
        numbers = rng.choice(scene.touches.touch, count, replace=False).tolist()
        assert gone_with(scene, numbers, seed=1) == ""


def test_what_a_feed_shows_of_accidents_is_no_cause_of_them() -> None:
    scene = Scene.of(read_campaign(MACHINE))
    fast = scene.touches.feed_mm_min == scene.touches.feed_mm_min.max()
    numbers = np.random.default_rng(1).choice(scene.touches.touch[fast], 15, replace=False)

    assert gone_with(scene, numbers.tolist(), seed=1) == ""


@pytest.mark.long
def test_touches_far_off_for_a_cause_are_a_gap_and_none_of_them_is_listed() -> None:
    campaign = thinned(played(MACHINE))

    found = diagnose(thrown(campaign, at_azimuths(campaign.touches)), seed=1)

    assert found.verdict is Verdict.UNKNOWN
    assert found.outliers == []
    assert any("azimuth" in failure for failure in map(str, found.failures))


@pytest.mark.long
def test_stamps_off_for_one_cause_are_not_explained_by_another() -> None:
    """Stamps that alone are early look like scans a whole period later, less that."""
    campaign = played(BENCH)
    touches = campaign.touches
    is_early = np.random.default_rng(5).random(len(touches)) < 0.06
    stamps = touches.latch_us - np.where(is_early, 700.0, 0.0)
    stranger = replace(campaign, touches=replace(touches, latch_us=stamps))

    diagnosis = diagnose(thinned(stranger), seed=1)

    assert diagnosis.verdict == Verdict.UNKNOWN
    assert not diagnosis.effects


@pytest.mark.long
def test_gross_outliers_spoil_no_gap_that_is_gone() -> None:
    """A fortieth of the touches, some of them held out, by many times what the effect moves."""
    backlash = played(MACHINE, Effect("backlash", {"backlash_um": 8.0}))
    rows = np.arange(7, len(backlash.touches), 40)
    spoilt = thrown(backlash, rows)

    diagnosis = diagnose(spoilt, seed=1)

    assert [named.effect.id for named in diagnosis.effects] == ["backlash"]
    assert set(diagnosis.outliers) == set(spoilt.touches.touch[rows].tolist())
    assert diagnosis.gap["deviation_um"].shrink.low > 0.9


@pytest.mark.long
def test_gross_errors_to_either_side_are_no_bounce() -> None:
    """They are a few times the noise, and most of them late, as of one effect that comes seldom."""
    campaign = played(MACHINE, seed=4)
    skip = campaign.touches.select(np.flatnonzero(campaign.touches.on_skip))
    rng = np.random.default_rng(4)
    rows = rng.choice(len(skip), 8, replace=False)
    off_um = np.zeros(len(skip))
    off_um[rows] = rng.choice([-1.0, 1.0, 1.0, 1.0], 8) * rng.exponential(30.0, 8)
    unknown = np.full(len(skip), np.nan)
    touches = replace(
        skip, deviation_um=skip.deviation_um + off_um, latch_us=unknown, report_us=unknown
    )

    diagnosis = diagnose(replace(campaign, touches=touches), seed=1)

    assert diagnosis.verdict == Verdict.NO_GAP
    grossly = rows[np.abs(off_um[rows]) > 20.0]
    assert set(skip.touch[grossly].tolist()) <= set(diagnosis.outliers)


def test_those_that_lie_beyond_their_plays_are_counted() -> None:
    campaign = thrown(played(MACHINE), np.array([7, 90, 301]))
    off_um = np.where(np.arange(len(campaign.touches)) == 33, -FAR_UM, 0.0)
    touches = replace(campaign.touches, deviation_um=campaign.touches.deviation_um + off_um)
    scene = Scene.of(replace(campaign, touches=touches))

    found = outliers(scene, Rig(campaign.nominal), seed=1)

    assert (len(found.touches), found.beyond) == (4, 3)


def test_four_times_the_touches_hide_less_than_half() -> None:
    campaign = played(MACHINE)
    skip = np.flatnonzero(campaign.touches.on_skip)
    scene = Scene.of(campaign)

    many, few = (
        could_hide(scene.select(skip[:n]), Rig(campaign.nominal), seed=1)["deviation_um"]
        for n in (160, 40)
    )

    assert 0.7 * few.relative / 2.0 < many.relative < few.relative / 2.0
    assert 0.4 * few.size / 2.0 < many.size < 1.4 * few.size / 2.0  # by the scatter of few


@pytest.mark.parametrize(("part", "least", "most"), [(1.0, 0.85, 1.0), (0.5, 0.0, 0.4)])
def test_a_shift_that_could_have_hidden_is_the_least_that_is_seen(
    part: float, least: float, most: float
) -> None:
    """Plays of a rig, half of them shifted, beside other plays of it: with 95 % one sees it."""
    campaign = played(MACHINE)
    scene = Scene.of(campaign)
    scene, rig = scene.select(np.flatnonzero(~scene.plc)[:80]), Rig(campaign.nominal)
    size = part * could_hide(scene, rig, seed=1)["deviation_um"].size
    beside = Beside.of(scene, rig, seed=2)
    plays, rows = beside.played["position"], np.full(len(scene), fill_value=True)

    def is_seen(k: int) -> bool:
        shifted, others = plays[k] + size * (scene.sign > 0), np.delete(plays, k, axis=0)
        look = Look(beside.setting, "position", "skip", rows, shifted, others)
        return any(left.kind == "shift" and left.is_significant for left in look.straight())

    assert least <= np.mean([is_seen(k) for k in range(0, len(plays), 2)]) <= most


def test_the_path_that_tells_most_counts() -> None:
    """Scans scatter by far more than interrupts: the skip path tells."""
    campaign = played(MACHINE)
    scene, rig = Scene.of(campaign), Rig(campaign.nominal)
    both, skip, plc = (
        could_hide(part, rig, seed=1)["deviation_um"].size
        for part in (scene, scene.select(~scene.plc), scene.select(scene.plc))
    )

    assert skip < plc
    assert both == pytest.approx(skip, rel=0.2)


def test_noise_beyond_what_is_played_hides_more() -> None:
    campaign = played(MACHINE)
    scene, noise_um = Scene.of(campaign), np.random.default_rng(1).normal(0.0, 20.0, 400)
    noisy = Scene(
        scene.nominal,
        replace(scene.touches, deviation_um=scene.touches.deviation_um + noise_um),
    )

    sizes = [
        could_hide(one, Rig(one.nominal), seed=1)["deviation_um"].size for one in (scene, noisy)
    ]

    assert sizes[1] > 3.0 * sizes[0]


def test_rounding_that_leaves_no_scatter_hides_a_step() -> None:
    """Positions of a bench whose axis has no noise, and stamps that keep their grid."""
    campaign = played(BENCH)
    step_um, tick_us = campaign.nominal.axis.resolution_um, campaign.nominal.skip.tick_us

    hidden = could_hide(Scene.of(campaign), Rig(campaign.nominal), seed=1)

    assert hidden["deviation_um"].size == step_um
    assert hidden["latch_off_scan_grid_us"].size == tick_us
    assert all(one.size > 0.0 for one in hidden.values())


def test_what_was_not_recorded_hides_nothing() -> None:
    campaign = played(MACHINE)

    assert could_hide(Scene.of(campaign), Rig(campaign.nominal), seed=1).keys() == {"deviation_um"}
