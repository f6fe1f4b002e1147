"""How large what is left is: by the measure that plays are held to as well."""

import numpy as np
import pytest

from played_campaigns import BENCH, played
from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.plays.left import SIGNIFICANT, Left
from skiplatch.diagnosis.plays.leftover import PLAYS
from skiplatch.diagnosis.plays.look import Look
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.scene.scene import Scene

BODY_US = 200.0
QUEUE_US = 800.0


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(played(BENCH, seed=3))


def scatter_left(scene: Scene, recorded: FloatArray, plays: FloatArray) -> Left:
    look = Look(Setting(scene, 1), "report", "plc", scene.plc, recorded, plays)
    return next(one for one in look.everywhere() if one.kind == "scatter")


def queued(scene: Scene, rng: np.random.Generator) -> FloatArray:
    """Reports that queue, as plays of a finding have them; shape (r, n)."""
    return BODY_US + rng.exponential(QUEUE_US, (PLAYS, len(scene)))


@pytest.mark.parametrize("wider_us", [300.0, 1000.0])
def test_scatter_on_top_of_what_plays_have_is_what_was_added(scene: Scene, wider_us: float) -> None:
    rng = np.random.default_rng(1)
    plays = rng.normal(0.0, BODY_US, (PLAYS, len(scene)))
    recorded = rng.normal(0.0, np.hypot(BODY_US, wider_us), len(scene))

    left = scatter_left(scene, recorded, plays)

    assert left.z > SIGNIFICANT
    assert left.size == pytest.approx(wider_us, rel=0.2)


def test_what_scatters_less_than_plays_leaves_no_scatter_to_speak_of(scene: Scene) -> None:
    """Many below all plays make scores wide, though what was recorded is narrower altogether."""
    rng = np.random.default_rng(2)
    plays = queued(scene, rng)
    recorded = np.where(
        rng.random(len(scene)) < 0.3,
        BODY_US - rng.uniform(0.0, BODY_US / 2.0, len(scene)),
        BODY_US + rng.uniform(0.0, 2.0 * QUEUE_US, len(scene)),
    )

    left = scatter_left(scene, recorded, plays)

    assert left.z > SIGNIFICANT
    assert left.size == 0.0


def test_rare_wide_plays_hide_no_scatter_of_the_many(scene: Scene) -> None:
    """One play in a hundred far off makes their deviation large, and the body no wider."""
    rng = np.random.default_rng(3)
    rare = np.where(rng.random((PLAYS, len(scene))) < 0.01, 20.0 * BODY_US, 0.0)
    plays = rng.normal(0.0, BODY_US, rare.shape) + rare
    recorded = rng.normal(0.0, 2.0 * BODY_US, len(scene))

    left = scatter_left(scene, recorded, plays)

    assert left.size == pytest.approx(np.sqrt(3.0) * BODY_US, rel=0.2)


def test_a_play_that_latched_no_touch_hides_no_scatter(scene: Scene) -> None:
    rng = np.random.default_rng(4)
    plays = rng.normal(0.0, BODY_US, (PLAYS, len(scene)))
    plays[3] = np.nan
    recorded = rng.normal(0.0, 3.0 * BODY_US, len(scene))

    assert scatter_left(scene, recorded, plays).z > SIGNIFICANT
