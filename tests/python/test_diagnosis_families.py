"""Families that name no effect show up where there is something of their kind, and only there."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from played_campaigns import BENCH, MACHINE, played
from skiplatch.campaign import InputPath, Touches
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.generic import families
from skiplatch.diagnosis.judge import PLAIN, Judge, split
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.structure import structures
from skiplatch.simulator import Effect

Disturbed = Callable[[Touches], Touches]

ALWAYS = ("~position: now and then off", "~position: noise", "~position: noisy")


def seen(scene: Scene) -> set[str]:
    """The families that are not always looked into."""
    ids = {family.id for family in families(scene, Change())}
    return {name for name in ids if not name.startswith(ALWAYS)}


def in_position(off_um: Callable[[Touches], np.ndarray]) -> Disturbed:
    return lambda t: replace(t, deviation_um=t.deviation_um + off_um(t))


def turning(period_share: float) -> Disturbed:
    """An error that swings so many times in the campaign."""
    return in_position(
        lambda t: 5.0 * np.sin(2.0 * np.pi * t.time_s / (period_share * t.time_s[-1]))
    )


def late_from_the_middle_on(touches: Touches) -> Touches:
    """The skip input alone becomes slower once."""
    late_us = 30.0 * (touches.time_s > np.median(touches.time_s)) * (touches.path == InputPath.SKIP)
    return replace(touches, latch_us=touches.latch_us + late_us)


def late_after_a_few(touches: Touches) -> Touches:
    """The skip input alone is faster by far at six touches of thirty, the first ones."""
    first = np.flatnonzero(touches.path == InputPath.SKIP)[:30]
    late_us = np.zeros(len(touches))
    late_us[first[6:]] = 30.0
    kept = (touches.path != InputPath.SKIP) | (np.arange(len(touches)) <= first[-1])
    return replace(touches, latch_us=touches.latch_us + late_us).select(kept)


def stamped_by_another_clock(touches: Touches) -> Touches:
    """Every seventh stamp is off: it comes before its latch, and so long before its report."""
    off_us = -400.0 * (touches.touch % 7 == 0)
    return replace(touches, latch_us=touches.latch_us + off_us)


@pytest.mark.parametrize(
    ("disturbed", "family"),
    [
        (turning(0.1), "~position: swings with time"),
        (turning(1.0), "~position: comes and goes with time"),
        (in_position(lambda t: 0.5 * t.approach_mm), "~position: approach"),
        (late_from_the_middle_on, "~latch_skip: changes once"),
        (late_after_a_few, "~latch_skip: changes once"),
        (stamped_by_another_clock, "~stamp: what the report is off by"),
    ],
)
def test_what_has_the_look_of_a_family_makes_it_a_candidate(
    disturbed: Disturbed, family: str
) -> None:
    campaign = played(BENCH)

    scene = Scene(campaign.nominal, disturbed(campaign.touches.in_order_of_time()))

    assert family in seen(scene)


def test_noise_is_no_course_in_time() -> None:
    """Each touch is held against the others around it: its own would explain itself."""
    campaign = played(BENCH, Effect("isr_latency", {"latency_us": 3.0, "jitter_us": 6.0}))
    touches = campaign.touches.in_order_of_time()
    slow_us = 6.0 * np.sin(2.0 * np.pi * touches.time_s / touches.time_s[-1])
    late_us = slow_us * (touches.path == InputPath.SKIP)
    touches = replace(touches, latch_us=np.floor(touches.latch_us + late_us))
    scene = Scene(campaign.nominal, touches)

    (course,) = [
        f for f in families(scene, Change()) if f.id == "~latch_skip: comes and goes with time"
    ]
    stream = scene.streams["latch_skip"]
    shown_us = np.asarray(course.change(scene, np.array([1.0])).skip_us)[stream.rows]
    noise_us = (stream.residuals - late_us)[stream.rows]

    assert np.corrcoef(shown_us, late_us[stream.rows])[0, 1] > 0.95
    assert stats.pearsonr(shown_us - late_us[stream.rows], noise_us).pvalue > 1e-3


def test_a_clock_with_two_states_is_fitted_to_the_tick_and_no_effect_does_as_well() -> None:
    campaign = played(BENCH)
    touches = stamped_by_another_clock(campaign.touches.in_order_of_time())
    judge = Judge(Scene(campaign.nominal, touches), split(len(touches), 0))

    family = judge.generic()[0]

    assert family.ids == ("~stamp: what the report is off by",)
    assert family.score > judge.singles()[0].score + PLAIN
    slope, jump_us = family.fit.parameters[0]
    assert slope == pytest.approx(0.0, abs=1e-3)
    assert jump_us == pytest.approx(-400.0, abs=1.0)


def test_one_lobe_is_seen_whether_or_not_it_fades_with_the_elevation() -> None:
    campaign = played(MACHINE)
    touches = campaign.touches.in_order_of_time()
    scene = Scene(campaign.nominal, touches)

    for fading, family in ((scene.cos_beta, "azimuth"), (1.0, "azimuth at any elevation")):
        off = replace(
            touches, deviation_um=touches.deviation_um + 8.0 * np.cos(scene.alpha) * fading
        )
        judge = Judge(Scene(campaign.nominal, off), split(len(off), 0))

        assert judge.generic()[0].ids == (f"~deviation_skip: {family}",)


@pytest.mark.parametrize("folder", [BENCH, MACHINE])
def test_no_family_is_enough_for_a_simulation_without_effects(folder: Path) -> None:
    for seed in range(5):
        scene = Scene.of(played(folder, seed=seed))
        judge = Judge(scene, split(len(scene), seed))

        assert not [found.ids for found in judge.generic() if judge.is_enough(found)]


def test_a_touch_whose_predecessor_was_not_recorded_follows_none() -> None:
    touches = played(BENCH).touches.in_order_of_time()
    kept = np.array([0, 1, 2, 4, 5, 8])

    scene = Scene(played(BENCH).nominal, touches.select(kept))

    np.testing.assert_array_equal(scene.follows, np.diff(scene.touches.touch, prepend=-9) == 1)
    assert scene.follows.sum() == np.sum(np.diff(touches.touch[kept]) == 1)
    np.testing.assert_array_equal(scene.select(np.arange(6) > 2).follows, scene.follows[3:])


def test_one_long_rest_before_a_touch_far_off_is_no_structure() -> None:
    campaign = played(MACHINE)
    touches = campaign.touches.in_order_of_time()
    late_s = np.where(np.arange(len(touches)) >= 50, 3600.0, 0.0)
    off_um = np.where(np.arange(len(touches)) == 50, 100.0, 0.0)

    rested = replace(
        touches, time_s=touches.time_s + late_s, deviation_um=touches.deviation_um + off_um
    )
    left = structures(Scene(campaign.nominal, rested), Change())

    assert not [s for s in left if "rest" in s.looks_like]
