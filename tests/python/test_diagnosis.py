"""Diagnoses of campaigns whose effect is known: recorded ones, and such as the simulator plays."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import MACHINE, played, thinned
from skiplatch.campaign import Axis, Campaign, Touches, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis import Diagnosis, Verdict, as_json, as_text, diagnose, effects_from_json
from skiplatch.diagnosis.reported.notes import first_touch, notes
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.reliability import FAR_OFF, MANY, reliability, standing
from skiplatch.diagnosis.verdict.rules import EXPLAINS
from skiplatch.simulator.effects import Effect

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
DATA = Path(__file__).parent / "data"
JOBS = 2


def ids(diagnosis: Diagnosis) -> list[str]:
    return [named.effect.id for named in diagnosis.effects]


@pytest.mark.parametrize(
    ("right", "wrong", "least"),
    [(0, 0, 0.1), (9, 0, 0.1**0.1), (99, 0, 0.1**0.01), (0, 9, 1.0 - 0.9**0.1)],
)
def test_a_confidence_is_what_few_counts_leave_for_certain(
    right: int, wrong: int, least: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("skiplatch.diagnosis.verdict.reliability._counts", lambda _: (right, wrong))

    assert reliability(Verdict.EXPLAINED) == pytest.approx(least)


def test_a_form_as_far_off_as_can_be_is_counted_by_itself() -> None:
    failing = {rule.name for rule in EXPLAINS}

    partly = Verdict.PARTLY_EXPLAINED
    assert standing(partly, failing, 3) == standing(partly, failing, 1) == FAR_OFF
    assert standing(partly, failing - {"has_form"}, 3) == partly
    assert reliability(FAR_OFF) < reliability(partly)


def test_what_many_effects_explain_together_is_counted_by_itself() -> None:
    assert [standing(Verdict.EXPLAINED, (), n) for n in (1, 2, 3)] == [
        *(2 * [Verdict.EXPLAINED]),
        MANY,
    ]
    assert reliability(MANY) < reliability(Verdict.EXPLAINED)


@cache
def of_recorded(folder: Path) -> Diagnosis:
    return diagnose(read_campaign(folder), seed=1, jobs=JOBS)


@pytest.mark.parametrize("folder", [MACHINE, DATA / "bench_no_gap"])
def test_recorded_campaigns_without_a_gap_get_no_name(folder: Path) -> None:
    diagnosis = of_recorded(folder)

    assert diagnosis.verdict == Verdict.NO_GAP
    assert not diagnosis.effects
    assert not diagnosis.left
    assert "No gap" in as_text(diagnosis)


@pytest.mark.long
def test_with_positions_alone_a_delay_is_told_with_what_it_cannot_be_told_from() -> None:
    folder = SAMPLES / "machine_no_gap"
    campaign = thinned(played(folder, Effect("trigger_delay", {"delay_us": 300.0})))

    diagnosis = diagnose(campaign, seed=1, jobs=JOBS)

    (named,) = diagnosis.effects
    group = {named.effect.id, *named.alternatives}
    assert {"trigger_delay", "input_filter", "following_error"} <= group
    text = as_text(diagnosis)
    assert "cannot be told from" in text
    assert re.search(r"confidence 0\.\d{3} that it is one of these\n", text)


@pytest.mark.long
def test_two_effects_are_both_named() -> None:
    campaign = played(
        DATA / "bench_no_gap",
        Effect("backlash", {"backlash_um": 1.5}),
        Effect("report_delay", {"delay_us": 40.0}),
    )

    diagnosis = diagnose(thinned(campaign), seed=1, jobs=JOBS)

    assert sorted(ids(diagnosis)) == ["backlash", "report_delay"]
    found = {named.effect.id: named.effect.parameters for named in diagnosis.effects}
    assert found["backlash"]["backlash_um"] == pytest.approx(1.5, abs=0.05)
    assert found["report_delay"]["delay_us"] == pytest.approx(40.0, abs=5.0)


@pytest.mark.long
def test_reports_that_take_longer_the_faster_the_axis_steps_are_measured() -> None:
    truth = {"delay_us": 240.0, "stepping_us_min_m": 11.6}
    campaign = played(DATA / "bench_no_gap", Effect("report_delay", truth))

    diagnosis = diagnose(campaign, seed=1, jobs=JOBS)

    (named,) = diagnosis.effects
    assert named.effect.id == "report_delay"
    assert diagnosis.verdict == Verdict.EXPLAINED
    found = named.effect.parameters
    assert found["delay_us"] == pytest.approx(240.0, abs=0.3)
    assert found["stepping_us_min_m"] == pytest.approx(11.6, abs=0.2)
    assert found["queue_us"] == 0.0


@pytest.mark.long
def test_a_lag_behind_the_thermometer_is_measured() -> None:
    truth = {"drift_um_k": 1.5, "lag_s": 900.0}
    campaign = thinned(played(DATA / "bench_no_gap", Effect("thermal_drift", truth)))

    (named,) = diagnose(campaign, seed=1, jobs=JOBS).effects

    assert named.effect.id == "thermal_drift"
    for name, value in truth.items():
        assert named.effect.parameters[name] == pytest.approx(value, rel=0.03)


def test_a_stranger_is_not_named() -> None:
    campaign = played(DATA / "bench_no_gap")
    short = np.random.default_rng(3).random(len(campaign.touches)) < 0.1
    deviation_um = campaign.touches.deviation_um - np.where(short, 30.0, 0.0)
    stranger = replace(campaign, touches=replace(campaign.touches, deviation_um=deviation_um))

    diagnosis = diagnose(thinned(stranger), seed=1, jobs=JOBS)

    assert diagnosis.verdict == Verdict.UNKNOWN
    assert any("far off all plays in position" in note for note in diagnosis.notes)
    assert not diagnosis.effects


def test_the_result_depends_on_the_seed_and_not_on_the_number_of_processes() -> None:
    one = as_json(diagnose(read_campaign(MACHINE), seed=1, jobs=1))

    assert one == as_json(of_recorded(MACHINE))


def test_effects_come_back_from_json() -> None:
    effect = Effect("backlash", {"backlash_um": 1.5})
    document = {
        "format": "skiplatch-diagnosis/1",
        "effects": [{"id": effect.id, "params": dict(effect.parameters)}],
    }

    assert effects_from_json(document) == [effect]
    for wrong in (None, {}, {"format": "other"}, document | {"effects": [{"id": "backlash"}]}):
        with pytest.raises(ValueError, match=r"diagnosis"):
            effects_from_json(wrong)


@pytest.mark.parametrize(("touches", "verdict"), [(20, Verdict.NO_GAP), (15, Verdict.UNDECIDED)])
def test_what_a_campaign_cannot_tell_is_said(touches: int, verdict: Verdict) -> None:
    campaign = read_campaign(SAMPLES / "machine_no_gap")
    skip = np.flatnonzero(campaign.touches.on_skip)[:touches]
    few = replace(campaign, touches=campaign.touches.select(skip))

    diagnosis = diagnose(few, seed=1)

    assert diagnosis.verdict == verdict
    text = as_text(diagnosis)
    for words in ("could have hidden", "No touches on the plc path", "No latch_us"):
        assert words in text


def test_units_of_rotary_axes_are_said() -> None:
    """Degrees stand for millimetres in the simulation, and so in what is found by it."""
    linear = Scene.of(played(MACHINE)).select(np.arange(40))
    rotary = Scene(linear.nominal, replace(linear.touches, axis=np.full(40, Axis.C)))

    said = [notes(scene, Verdict.NO_GAP, [], []) for scene in (rotary, linear)]

    assert ["3.6″" in " ".join(lines) for lines in said] == [True, False]


@pytest.mark.parametrize(
    ("walls", "u_um", "is_said"),
    [(["one", "the other"], None, True), (["one", "one"], None, False), (["a", "b"], 1.0, False)],
)
def test_surfaces_met_in_one_sense_each_show_no_backlash(
    walls: list[str], u_um: float | None, is_said: bool
) -> None:
    campaign = played(MACHINE)
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.SESSION, u_um))
    touches = Touches.from_columns(
        touch=np.arange(40),
        axis=np.full(40, Axis.X),
        sign=np.tile([1.0, -1.0], 20),
        session=np.tile(walls, 20),
    )

    said = notes(Scene(nominal, touches), Verdict.NO_GAP, [], [])

    assert any("a backlash looks like where they lie" in line for line in said) == is_said


@pytest.mark.parametrize(
    ("verdict", "u_um", "is_said"),
    [
        (Verdict.NO_GAP, None, True),
        (Verdict.NO_GAP, 1.0, False),
        (Verdict.EXPLAINED, None, False),
    ],
)
def test_without_a_gap_it_is_said_what_a_free_datum_takes_up(
    verdict: Verdict, u_um: float | None, is_said: bool
) -> None:
    campaign = played(MACHINE)
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.AXIS, u_um))

    said = notes(Scene(nominal, campaign.touches), verdict, [], [])

    assert any("may be of any size" in line for line in said) == is_said


@pytest.mark.parametrize(
    ("axes", "named"), [([Axis.X, Axis.Y, Axis.Z], "X, Z"), ([-1, Axis.Y, -1], "the axis")]
)
def test_axes_that_are_met_in_one_sense_are_named(axes: list[int], named: str) -> None:
    touches = Touches.from_columns(
        touch=np.arange(40),
        axis=np.resize(axes, 40),
        sign=np.where(np.arange(40) % 3 == 1, np.tile([1.0, -1.0], 20), -1.0),
    )

    said = notes(Scene(played(MACHINE).nominal, touches), Verdict.EXPLAINED, [], [])

    assert f"One sense of motion along {named}: no backlash can be seen there." in said


@pytest.mark.parametrize(("off_um", "series_said"), [(25.0, 200), (0.0, 0)])
def test_a_first_touch_that_is_off_is_said(off_um: float, series_said: int) -> None:
    rng, campaign = np.random.default_rng(1), played(MACHINE)

    def series() -> Campaign:
        deviation_um = rng.normal(0.0, 2.0, 20)
        deviation_um[0] += off_um
        touches = Touches.from_columns(touch=np.arange(20), deviation_um=deviation_um)
        return replace(campaign, touches=touches)

    said = [first_touch(series()) for _ in range(200)]

    assert sum(map(bool, said)) == pytest.approx(series_said, abs=4)
    assert all("µm" in line for lines in said for line in lines)
