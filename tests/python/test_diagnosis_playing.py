"""A rig is played where its surfaces are, and comes back from JSON."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from made_diagnoses import made
from played_campaigns import BENCH, MACHINE, stamped_machine
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Campaign, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis import (
    Diagnosis,
    Named,
    Verdict,
    as_json,
    effects_from_json,
    rig_from_json,
)
from skiplatch.diagnosis.fit.beliefs import believing, uncertain
from skiplatch.diagnosis.plays.playing import Folds, Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.scene.observed import observed
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.parts import FOLDS, folds
from skiplatch.simulator.effects import Effect, effects
from skiplatch.simulator.playing import Outcomes
from skiplatch.span import Span

NOTHING = {p.name: 0.0 for p in effects()["backlash"].parameters}
BACKLASH = Effect("backlash", {**NOTHING, "backlash_um": 2.0})
REPEATABILITY = ("probe", "repeatability_um")


def stamped() -> Campaign:
    """A machine that records stamps, its data unknown by axis."""
    campaign = stamped_machine()
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.AXIS))
    return replace(campaign, nominal=nominal)


def played(campaign: Campaign, datum: FittedDatum) -> Outcomes:
    return Rig(campaign.nominal, (), datum).play(campaign.touches, seed=3, replicates=2)


def middle(values: FloatArray) -> float:
    return float(np.nanmedian(values))


def test_a_coordinate_that_is_off_shifts_the_deviations_of_its_axis_and_nothing_else() -> None:
    campaign = stamped()
    on_x = campaign.touches.axis == Axis.X

    plain, off = (played(campaign, FittedDatum({}, data)) for data in ({}, {"X": 12.0}))

    for shifted_um in off.deviation_um - plain.deviation_um:
        np.testing.assert_allclose(shifted_um, np.where(on_x, 12.0, 0.0), atol=1e-9)
    np.testing.assert_array_equal(off.latch_us, plain.latch_us)


def test_a_surface_that_is_off_is_met_later_and_there() -> None:
    campaign = stamped()
    skip = campaign.touches.on_skip & (campaign.touches.axis == Axis.X)
    speed_um_us = Scene(campaign.nominal, campaign.touches).speed[skip]

    plain, off = (played(campaign, FittedDatum(data)) for data in ({}, {"X": 40.0}))

    later_us = (off.latch_us - plain.latch_us)[:, skip]
    farther_um = (off.deviation_um - plain.deviation_um)[:, skip]
    assert middle(later_us * speed_um_us) == pytest.approx(40.0, rel=0.02)
    assert middle(farther_um) == pytest.approx(40.0, abs=0.5)


def test_past_the_nominal_surface_the_axis_goes_on_at_the_speed_that_it_has_there() -> None:
    """Also on its ramp, which would bring it to another speed at a surface that lies farther."""
    campaign = stamped()
    axis = replace(campaign.nominal.axis, accel_mm_s2=30.0)
    slow = replace(campaign, nominal=replace(campaign.nominal, axis=axis))
    scene = Scene(slow.nominal, slow.touches)

    off = played(slow, FittedDatum(dict.fromkeys("XYZ", 60.0)))

    beyond_um = observed(scene, off)["position"][:, slow.touches.on_skip]
    assert np.nanmax(np.abs(beyond_um)) < axis.resolution_um
    assert middle(off.deviation_um) > 60.0


@pytest.mark.parametrize("kind", ["surface_um", "coordinate_um"])
@pytest.mark.parametrize("is_coordinate", [0.0, 1.0])
def test_the_lines_of_an_encoder_stay_where_a_datum_is_off(kind: str, is_coordinate: float) -> None:
    campaign, step_um = stamped(), 3.0
    touches = campaign.touches
    parameters = {"resolution_um": step_um, "is_coordinate": is_coordinate, "origin": 0.25}
    encoder = Effect("encoder_quantisation", parameters)
    datum = FittedDatum(**{kind: {"X": 1.3, "Y": -0.4, "Z": 40.0}})

    rig = Rig(campaign.nominal, [encoder], datum)
    (deviation_um,) = rig.play(touches, seed=3, replicates=1).deviation_um

    nominal_um = touches.sign * touches.position_mm * 1e3 - touches.sign * 0.25 * step_um
    counts = (deviation_um + is_coordinate * nominal_um) / step_um
    np.testing.assert_allclose(counts, np.rint(counts), atol=0.003)


@pytest.mark.parametrize("kind", ["surface_um", "coordinate_um"])
def test_the_lines_of_the_counter_stay_where_a_datum_is_off(kind: str) -> None:
    campaign = stamped()
    step_um = campaign.nominal.axis.resolution_um
    datum = FittedDatum(**{kind: {"X": 7.3 * step_um, "Y": -0.4 * step_um}})

    plain, off = (played(campaign, one).deviation_um for one in (FittedDatum(), datum))

    np.testing.assert_allclose(off / step_um, np.rint(off / step_um), atol=1e-6)
    on_x = campaign.touches.on_skip & (campaign.touches.axis == Axis.X)
    assert np.nanmean((off - plain)[:, on_x]) / step_um == pytest.approx(7.3, abs=0.2)


def test_a_datum_that_is_known_is_not_moved() -> None:
    bench = read_campaign(BENCH)

    plain, named = (played(bench, FittedDatum({}, data)) for data in ({}, {"X": 12.0}))

    np.testing.assert_array_equal(plain.deviation_um, named.deviation_um)


def diagnosed(rig: Rig, believed: Campaign) -> Diagnosis:
    """A diagnosis that says what a rig is."""
    beliefs = uncertain(believed.nominal)
    named = [
        Named(
            one,
            "position",
            {name: (v, v) for name, v in one.parameters.items()},
            (),
            0.9,
        )
        for one in rig.effects
    ]
    known = [(b, getattr(getattr(rig.nominal, b.key[0]), b.key[1])) for b in beliefs]
    return made(Verdict.EXPLAINED, Rig(believed.nominal), rig, named, beliefs=known)


def test_a_rig_comes_back_from_json() -> None:
    campaign = read_campaign(MACHINE)
    nominal = believing(campaign.nominal, {REPEATABILITY: 0.5})
    rig = Rig(nominal, [BACKLASH], FittedDatum({"X": 3.0, "Y": -1.0}, {"X": 0.5, "Y": 0.25}))

    document = json.loads(json.dumps(as_json(diagnosed(rig, campaign))))
    back = rig_from_json(document, campaign.nominal)

    assert back == rig
    np.testing.assert_array_equal(
        back.play(campaign.touches, seed=1, replicates=1).deviation_um,
        rig.play(campaign.touches, seed=1, replicates=1).deviation_um,
    )


def test_names_with_a_point_in_them_come_back() -> None:
    campaign = read_campaign(MACHINE)
    rig = Rig(campaign.nominal, [], FittedDatum({}, {"session 3.b": 7.0}))

    assert rig_from_json(as_json(diagnosed(rig, campaign)), campaign.nominal) == rig


def test_a_fold_is_played_by_its_own_rig() -> None:
    campaign = read_campaign(MACHINE)
    rigs = [Rig(campaign.nominal, found) for found in ([], [BACKLASH])]
    fold = folds(len(campaign.touches), seed=1) % len(rigs)

    played = Folds(rigs, fold).play(campaign.touches, seed=3, replicates=2)

    alone = [rig.play(campaign.touches, seed=3, replicates=2).deviation_um for rig in rigs]
    np.testing.assert_array_equal(played.deviation_um, np.where(fold == 0, *alone))
    assert not np.array_equal(alone[0], alone[1], equal_nan=True)


def test_folds_share_no_touch_and_have_as_many_each() -> None:
    fold = folds(1001, seed=1)

    assert np.ptp(np.bincount(fold, minlength=FOLDS)) <= 1
    assert not np.array_equal(fold, folds(1001, seed=2))


def test_when_an_effect_began_comes_back_from_json() -> None:
    campaign = read_campaign(MACHINE)
    begun = replace(BACKLASH, span=Span(since=17, until=40))

    document = as_json(diagnosed(Rig(campaign.nominal, [begun]), campaign))

    (entry,) = document["effects"]
    assert (entry["since"], entry["until"]) == (17, 40)
    assert effects_from_json(document) == [begun]


@pytest.mark.parametrize("number", [1.5, "17", True, [17]])
def test_a_touch_that_is_none_is_refused(number: Any) -> None:  # noqa: ANN401
    entry = {"id": BACKLASH.id, "params": dict(BACKLASH.parameters), "since": number}

    with pytest.raises(ValueError, match="number of a touch"):
        effects_from_json({"format": "skiplatch-diagnosis/2", "effects": [entry]})


def test_an_older_diagnosis_has_effects_alone() -> None:
    nominal = read_campaign(MACHINE).nominal
    entry = {"id": BACKLASH.id, "params": dict(BACKLASH.parameters)}

    rig = rig_from_json({"format": "skiplatch-diagnosis/1", "effects": [entry]}, nominal)

    assert rig == Rig(nominal, [BACKLASH])


@pytest.mark.parametrize(
    "beliefs",
    [
        {"probe.colour": {"fitted": 1.0}},
        {"datum.X.elsewhere_um": {"fitted": 1.0}},
        {"probe.repeatability_um": {"value": 1.0}},
        {"probe.repeatability_um": {"fitted": "wide"}},
        ["probe.repeatability_um"],
    ],
)
def test_beliefs_that_are_none_are_refused(beliefs: Any) -> None:  # noqa: ANN401
    document = {"format": "skiplatch-diagnosis/2", "effects": [], "beliefs": beliefs}

    with pytest.raises(ValueError, match=r"belief|diagnosis"):
        rig_from_json(document, read_campaign(MACHINE).nominal)
