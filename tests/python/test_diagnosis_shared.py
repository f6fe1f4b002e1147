"""What touches of one campaign share, as where scans and coarse ticks meet, is in its plays too."""

import numpy as np
import pytest

from played_campaigns import BENCH, played
from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.plays import look as looking
from skiplatch.diagnosis.plays.left import SIGNIFICANT, Left
from skiplatch.diagnosis.plays.leftover import NOTICED, PLAYS
from skiplatch.diagnosis.plays.look import Look
from skiplatch.diagnosis.plays.scores import go_together, normal_scores
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.scene.scene import Scene

SEEDS = range(2)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(played(BENCH, seed=3))


def turning(scene: Scene, seed: int, *, together: bool) -> tuple[FloatArray, FloatArray]:
    """Values that turn by a twelfth from touch to touch, from anywhere in each play, or each alone.

    What the first play has is recorded; shapes (n,) and (r, n).
    """
    rng, n = np.random.default_rng(seed), len(scene)
    begin = rng.random((PLAYS + 1, 1 if together else n))
    values = 5.0 * ((np.arange(n) / 12.0 + begin) % 1.0)
    return values[0], values[1:]


def told(scene: Scene, recorded: FloatArray, plays: FloatArray) -> list[Left]:
    look = Look(Setting(scene, 1), "grid", "plc", scene.plc, recorded, plays)
    return [one for one in look.told() if one.z > SIGNIFICANT]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("together", [True, False])
def test_plays_tell_what_their_touches_share(scene: Scene, seed: int, *, together: bool) -> None:
    _, plays = turning(scene, seed, together=together)
    scores = [normal_scores(play, np.delete(plays, k, axis=0)) for k, play in enumerate(plays)]

    assert go_together(np.array(scores)) is together


@pytest.mark.parametrize("seed", SEEDS)
def test_what_plays_share_as_well_is_not_left(scene: Scene, seed: int) -> None:
    recorded, plays = turning(scene, seed, together=True)
    look = Look(Setting(scene, 1), "grid", "plc", scene.plc, recorded, plays)

    assert max(one.z for one in look.predicted()) > SIGNIFICANT
    assert told(scene, recorded, plays) == []


@pytest.mark.parametrize("seed", SEEDS)
def test_what_goes_with_a_condition_is_left_beside_what_plays_share(
    scene: Scene, seed: int
) -> None:
    recorded, plays = turning(scene, seed, together=True)
    feeds = scene.touches.feed_mm_min
    late = recorded + 4.0 * (feeds > np.median(feeds))

    assert "feed" in {one.conditions[0] for one in told(scene, late, plays)}


@pytest.mark.parametrize("seed", SEEDS)
def test_touches_that_go_together_where_plays_do_not_are_left(scene: Scene, seed: int) -> None:
    recorded, _ = turning(scene, seed, together=True)
    _, plays = turning(scene, seed, together=False)

    assert told(scene, recorded, plays) != []


@pytest.mark.parametrize("seed", SEEDS)
def test_plays_may_miss_touches_that_were_recorded(scene: Scene, seed: int) -> None:
    recorded, plays = turning(scene, seed, together=True)
    is_missed = np.random.default_rng(seed).random(plays.shape) < 0.05

    assert told(scene, recorded, np.where(is_missed, np.nan, plays)) == []


@pytest.mark.long
@pytest.mark.parametrize("late", [0.0, 0.5, 1.0, 2.0])
def test_nothing_is_missed_by_holding_no_chance_against_plays(
    scene: Scene, late: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What goes with a condition is told alike, whether what is no more than chance is held too."""
    _, plays = turning(scene, 0, together=True)
    recorded, _ = turning(scene, 5, together=False)
    feeds = scene.touches.feed_mm_min
    recorded = recorded + late * (feeds > np.median(feeds))

    def noticed() -> list[Left]:
        look = Look(Setting(scene, 1), "grid", "plc", scene.plc, recorded, plays)
        return [one for one in look.told() if one.z > NOTICED]

    found = noticed()
    monkeypatch.setattr(looking, "CHANCE", -np.inf)
    assert found == noticed()
    assert bool(found) is (late >= 1.0)
