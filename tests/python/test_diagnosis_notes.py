"""What a report says beside its figures."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE
from skiplatch.campaign import read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis.plays.left import EVERYWHERE, Left
from skiplatch.diagnosis.reported.notes import notes
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.verdict import Verdict


def left(observable: str, kind: str, condition: str, z: float) -> Left:
    return Left(observable, "skip", kind, (condition,), 10.0, "µs", 2.0, 1.0, 0.1, z)


@pytest.mark.parametrize("is_reported", [True, False])
def test_reports_that_follow_no_latch_are_said_to_be_left_out(is_reported: bool) -> None:
    campaign = read_campaign(BENCH)
    nothing = np.full(len(campaign.touches), np.nan)
    report_us = campaign.touches.report_us if is_reported else nothing
    touches = replace(campaign.touches, latch_us=nothing, report_us=report_us)

    said = notes(Scene.of(replace(campaign, touches=touches)), Verdict.NO_GAP, (), [])

    assert any("late they come was not looked at" in line for line in said) == is_reported


def test_an_unknown_gap_says_what_tells_of_it_though_it_shows_everywhere() -> None:
    scene = Scene.of(read_campaign(BENCH))
    everywhere = left("latch", "scatter", EVERYWHERE, 40.0)
    elsewhere = left("report", "shift", "time", 20.0)
    telling = left("latch", "scatter", "touches since a change of axis", 9.0)

    said = notes(scene, Verdict.UNKNOWN, (), [everywhere, elsewhere, telling])
    bare = notes(scene, Verdict.UNKNOWN, (), [everywhere, elsewhere])

    whole = "What it looks like: latch, skip path: scatter everywhere"
    assert said[0] == f"{whole}; scatter goes with touches since a change of axis."
    assert bare[0] == f"{whole}."


def with_datum(free: DatumFreedom) -> Scene:
    campaign = read_campaign(MACHINE)
    return Scene.of(replace(campaign, nominal=replace(campaign.nominal, datum=Datum(free))))


@pytest.mark.parametrize(
    ("free", "named", "is_said"),
    [
        (DatumFreedom.AXIS, ("backlash",), True),
        (DatumFreedom.AXIS, ("scale_error",), False),
        (DatumFreedom.NONE, ("backlash",), False),  # where the faces are known
    ],
)
def test_zero_off_by_half_of_a_backlash_is_said_to_read_the_same(
    free: DatumFreedom, named: tuple[str, ...], is_said: bool
) -> None:
    said = notes(with_datum(free), Verdict.EXPLAINED, (), [], named)

    assert any("zero is off by half of the backlash" in line for line in said) == is_said
