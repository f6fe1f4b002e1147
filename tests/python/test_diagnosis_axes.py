"""Axes that nothing touches leave no parameter open that another one makes up for."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played_again
from skiplatch.campaign import Axis, Campaign, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.first_axis import first_axis, first_of_its_own
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect


def along(*axes: Axis) -> Campaign:
    """The touches of a machine, as if by these axes in turn."""
    campaign = read_campaign(MACHINE)
    axis = np.resize(np.array(axes, dtype=np.int8), len(campaign.touches))
    return replace(campaign, touches=replace(campaign.touches, axis=axis))


@pytest.mark.parametrize(
    ("axes", "first", "own"),
    [
        ((Axis.X, Axis.Y), Axis.X, set()),
        ((Axis.Y,), Axis.Y, {"y_excess_ratio", "y_ahead_deg"}),
        ((Axis.Z, Axis.Y), Axis.Y, {"y_excess_ratio", "y_ahead_deg"}),
        ((Axis.Z,), Axis.Z, {"z_excess_ratio", "z_ahead_deg"}),
    ],
)
def test_the_first_axis_has_nothing_more_than_x(
    axes: tuple[Axis, ...], first: Axis, own: set[str]
) -> None:
    scene = Scene.of(along(*axes))

    assert first_axis(scene.touches) == first
    assert first_of_its_own(scene.touches) == own
    wave = CANDIDATES["transmission_error"]
    assert {wave.names[number] for number in wave.taken_up(scene)} == own


def test_a_scale_of_y_alone_is_known_as_closely_as_one_of_x() -> None:
    def width_ppm(axis: Axis) -> float:
        campaign = played_again(along(axis), Effect("scale_error", {"scale_ppm": 80.0}))
        (named,) = diagnose(campaign, seed=1, jobs=2).effects
        low, high = named.intervals["scale_ppm"]
        assert named.effect.id == "scale_error"
        assert low < 80.0 < high
        return high - low

    assert width_ppm(Axis.Y) < 2.0 * width_ppm(Axis.X)
