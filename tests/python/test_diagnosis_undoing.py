"""Effects of which one undoes what the other one does."""

import pytest

from played_campaigns import MACHINE, played
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.undoing import undoing
from skiplatch.simulator.effects import Effect
from standing_fits import standing


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(played(MACHINE))


@pytest.mark.parametrize(
    ("lag_us", "named"),
    [(0.0, False), (2000.0, False), (-300.0, False), (540.0, True), (510.0, True)],
)
def test_an_old_position_of_an_axis_that_is_ahead_is_told(
    scene: Scene, lag_us: float, named: bool
) -> None:
    """The position is 540 µs old in the mean."""
    fit = standing(
        scene,
        Effect("backlash", {"backlash_um": 3.0}),
        Effect("servo_hold", {"period_us": 80.0, "dead_us": 500.0}),
        Effect("following_error", {"lag_us": lag_us}),
    )

    assert undoing(scene, fit) == (["servo_hold", "following_error"] if named else [])


def test_what_is_within_the_scatter_of_touches_undoes_nothing(scene: Scene) -> None:
    def late_and_early(by_us: float) -> Fit:
        return standing(
            scene,
            Effect("trigger_delay", {"delay_us": by_us}),
            Effect("input_filter", {"delay_us": -by_us}),
        )

    assert undoing(scene, late_and_early(1.0)) == []
    assert undoing(scene, late_and_early(4000.0)) == ["trigger_delay", "input_filter"]
