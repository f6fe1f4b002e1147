"""Axes that nothing touches leave no parameter open that another one makes up for."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosed import Search
from played_campaigns import MACHINE, played_again
from skiplatch.campaign import Axis, Campaign, Datum, DatumFreedom, read_campaign
from skiplatch.diagnosis.candidates.first_axis import (
    MOST_OVER,
    first_axis,
    first_of_its_own,
    within_ratio,
)
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.fit import starts_of
from skiplatch.diagnosis.fit.intervals import estimates
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import as_recorded
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect
from standing_fits import standing, whole

LONG = Effect("scale_error", {"scale_ppm": 80.0})


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
    assert {wave.names[number] for number in wave.taken_up(scene)} == own | {"moves_surface"}


@pytest.mark.parametrize("over", [-1730.4, 2400.0])
def test_an_axis_that_errs_alone_is_at_no_limit(over: float) -> None:
    """What X has is next to nothing: how many times as much another has, is told by no touch."""
    found = {"scale_ppm": -0.405, "y_excess_ratio": 12.0, "z_excess_ratio": over}

    admitted = within_ratio("scale_error", found)

    for name in ("y_excess_ratio", "z_excess_ratio"):
        assert admitted["scale_ppm"] * (1.0 + admitted[name]) == pytest.approx(
            found["scale_ppm"] * (1.0 + found[name])
        )
    assert abs(admitted["z_excess_ratio"]) < 0.6 * MOST_OVER
    assert within_ratio("scale_error", admitted) == admitted


@pytest.mark.parametrize("varies", [True, False])
def test_growth_of_a_scale_is_told_by_other_places_alone(varies: bool) -> None:
    """At one place only what a touch goes past it differs, which is what is to be explained."""
    campaign = read_campaign(MACHINE)
    place_mm = campaign.touches.position_mm if varies else np.zeros(len(campaign.touches))
    scene = Scene.of(replace(campaign, touches=replace(campaign.touches, position_mm=place_mm)))
    warmth = CANDIDATES["thermal_drift"]

    taken = {warmth.names[number] for number in warmth.taken_up(scene)}

    assert ("expansion_ppm_k" in taken) is not varies


def test_a_scale_of_y_alone_is_known_as_closely_as_one_of_x() -> None:
    def width_ppm(axis: Axis) -> float:
        scene = Scene.of(played_again(along(axis), LONG))
        (found,) = estimates(scene, standing(scene, LONG), (whole(LONG),))
        low, high = found.intervals["scale_ppm"]
        assert low < 80.0 < high
        return high - low

    assert width_ppm(Axis.Y) < 2.0 * width_ppm(Axis.X)


@pytest.mark.long
def test_a_scale_of_y_alone_is_the_likeliest_effect() -> None:
    assert Search(played_again(along(Axis.Y), LONG)).judge.singles()[0].ids == (LONG.id,)


def test_an_axis_of_few_touches_is_told_beside_surfaces_that_lie_far_apart() -> None:
    """What surfaces are off is no scatter: beside it, few touches tell which axis errs."""
    whole_campaign = along(Axis.X, Axis.Y, Axis.Z)
    few = whole_campaign.touches.select(np.arange(0, len(whole_campaign.touches), 10))
    nominal = replace(whole_campaign.nominal, datum=Datum(DatumFreedom.AXIS))
    x_alone = Effect(LONG.id, {**LONG.parameters, "y_excess_ratio": -1.0, "z_excess_ratio": -1.0})
    rig = Rig(nominal, [x_alone], FittedDatum({}, {"X": 300.0, "Y": -900.0, "Z": 2000.0}))
    outcomes = rig.play(few, seed=1, replicates=1)
    scene = Scene(nominal, as_recorded(few, outcomes, 0))
    assert max(np.bincount(scene.touches.axis)) < 16

    starts = np.array(starts_of(scene, CANDIDATES[LONG.id], NOTHING))

    assert np.any(np.all(np.abs(starts - [80.0, -1.0, -1.0, 0.0]) < [8.0, 0.1, 0.1, 0.1], axis=1))
