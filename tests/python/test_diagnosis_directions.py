"""Directions that were not recorded: filled in by axis and sense; lobes are unknown then."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played, played_again
from skiplatch.campaign import Axis, Campaign, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.fit.directions import UNDIRECTED, with_directions
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.scene.covariates import conditions, recorded_only
from skiplatch.diagnosis.verdict.verdict import Verdict


def without_directions(campaign: Campaign) -> Campaign:
    unknown = np.full(len(campaign.touches), np.nan)
    touches = replace(campaign.touches, alpha_deg=unknown, beta_deg=unknown)
    return replace(campaign, touches=touches)


def with_lobes(campaign: Campaign, lobe_um: float) -> Campaign:
    probe = replace(campaign.nominal.probe, lobe_um=lobe_um)
    return replace(campaign, nominal=replace(campaign.nominal, probe=probe))


def test_axis_and_sense_give_the_direction() -> None:
    touches = with_directions(without_directions(played(MACHINE))).touches

    for axis, plus in ((Axis.X, 0.0), (Axis.Y, 90.0)):
        for sign in (1.0, -1.0):
            here = (touches.axis == axis) & (touches.sign == sign)
            assert set(touches.alpha_deg[here]) <= {plus if sign > 0.0 else plus + 180.0}
    assert set(touches.beta_deg[touches.axis == Axis.Z]) <= {90.0}


def test_what_was_recorded_stays() -> None:
    campaign = played(MACHINE)

    assert np.array_equal(with_directions(campaign).touches.alpha_deg, campaign.touches.alpha_deg)
    assert with_directions(campaign).nominal == campaign.nominal


def test_lobes_in_unknown_directions_are_scatter_and_a_datum_of_each_sense() -> None:
    campaign = with_lobes(without_directions(played(MACHINE)), 4.0)
    probe_um = campaign.nominal.probe.repeatability_um

    nominal = with_directions(campaign).nominal

    assert nominal.probe.lobe_um == 0.0
    assert probe_um < nominal.probe.repeatability_um < np.hypot(probe_um, 4.0)
    assert nominal.datum.free is DatumFreedom.AXIS_SENSE
    u_um = nominal.uncertainty["probe", "repeatability_um"]
    middle_um = nominal.probe.repeatability_um
    largest_um = middle_um * (1.0 + u_um / middle_um) ** 2
    assert largest_um > np.hypot(probe_um, 4.0 / np.sqrt(2.0))


@pytest.mark.parametrize(
    ("datum", "u_um"),
    [
        (Datum(DatumFreedom.NONE), 4.0 / np.sqrt(2.0)),
        (Datum(DatumFreedom.AXIS, 3.0), np.hypot(3.0, 4.0 / np.sqrt(2.0))),
        (Datum(DatumFreedom.CAMPAIGN), None),
    ],
)
def test_such_lobes_shift_each_sense_of_a_surface_that_is_known(
    datum: Datum, u_um: float | None
) -> None:
    campaign = with_lobes(without_directions(played(MACHINE)), 4.0)
    known = replace(campaign, nominal=replace(campaign.nominal, datum=datum))

    found = with_directions(known).nominal.datum

    assert found.free is DatumFreedom.AXIS_SENSE
    assert found.u_um == (None if u_um is None else pytest.approx(u_um))


@pytest.mark.long
def test_a_sound_probe_with_lobes_shows_no_gap_without_directions() -> None:
    """It had a gap of the size of its lobes, which were all played in one direction."""
    campaign = without_directions(played_again(with_lobes(read_campaign(MACHINE), 6.0)))
    every_third = campaign.touches.select(np.arange(len(campaign.touches)) % 3 == 0)

    found = diagnose(replace(campaign, touches=every_third), seed=1)

    assert found.verdict is Verdict.NO_GAP
    assert UNDIRECTED in found.notes


def test_what_goes_with_a_direction_that_was_not_recorded_is_not_told() -> None:
    """An axis that is touched along the lobes alone scatters by them, and others do not."""
    campaign = with_lobes(without_directions(played(MACHINE)), 4.0)
    scene = scene_of(campaign)

    known = Setting(scene, seed=1).known

    assert not any(name.startswith(("azimuth", "axis", "sense", "elevation")) for name in known)
    assert {"feed", "position", "time"} <= known.keys()


def test_what_merely_stands_in_is_no_condition() -> None:
    scene = scene_of(replace(played(MACHINE), stood_in=frozenset({"time_s", "feed_mm_min"})))
    setting = Setting(scene, seed=1)

    assert not {"time", "rest before", "feed"} & setting.known.keys()
    assert {"approach", "serial number", "position"} <= setting.known.keys()
    assert "time" not in {place.name for place in setting.places}


def test_a_direction_that_was_filled_in_is_no_condition() -> None:
    """What goes with the sense would be said to go with an azimuth that nobody recorded."""
    recorded = read_campaign(MACHINE)
    bare = without_directions(recorded)

    scenes = (scene_of(with_lobes(one, 0.0)) for one in (bare, recorded))
    told, known = (recorded_only(scene, conditions(scene)) for scene in scenes)

    assert not any(name.startswith("azimuth") for name in told)
    assert {"azimuth", "sense"} <= known.keys()
    assert "sense" in told
