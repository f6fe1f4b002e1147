"""A coarse counter counts the coordinate of an axis, wherever its surfaces lie."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE
from skiplatch.campaign import Campaign, InputPath, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.scene.lines import above_line_um, with_lines
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

STEP_UM = 5.0
FAR_UM = 29.6


def slow(campaign: Campaign, seed: int = 3) -> Campaign:
    """Give touches of the skip path at feeds at which a step of the counter takes milliseconds."""
    rng = np.random.default_rng(seed)
    touches = campaign.touches.select(campaign.touches.path == InputPath.SKIP)
    n, surfaces_mm = len(touches), np.round(rng.uniform(-80.0, 0.0, 40), 3)
    conditions = {
        "time_s": 30.0 * np.arange(n),
        "feed_mm_min": rng.choice([25.0, 50.0, 100.0], n),
        "position_mm": rng.choice(surfaces_mm, n),
    }
    return replace(campaign, touches=replace(touches, **conditions))


def counted(campaign: Campaign, *, seed: int = 3) -> Campaign:
    """Play a campaign with a fine counter, and round the coordinates that it latches.

    Surfaces lie anywhere, and all of them farther than believed.
    """
    touches = campaign.touches
    fine = replace(campaign.nominal, axis=replace(campaign.nominal.axis, resolution_um=0.001))
    farther = replace(touches, approach_mm=touches.approach_mm + FAR_UM / 1000.0)
    controller = Controller.for_campaign(fine, farther)
    outcomes = play(fine, controller, farther, seed=seed, datum_um=np.full(len(touches), FAR_UM))
    surface_um = touches.sign * touches.position_mm * 1000.0
    coordinate_um = surface_um + outcomes.deviation_um[0]
    deviation_um = np.rint(coordinate_um / STEP_UM) * STEP_UM - surface_um
    coarse = replace(fine, axis=replace(fine.axis, resolution_um=STEP_UM))
    record = replace(
        touches,
        deviation_um=np.round(deviation_um, 3),
        report_us=np.round(outcomes.report_us[0], 3),
        latch_us=np.full(len(touches), np.nan),
    )
    return replace(campaign, nominal=coarse, touches=record)


def test_coordinates_on_lines_are_seen_to_be_counted() -> None:
    campaign = counted(slow(read_campaign(MACHINE)))

    found = with_lines(campaign)

    assert found.nominal.counts_coordinate
    nowhere = replace(campaign.touches, position_mm=np.full(len(campaign.touches), np.nan))
    assert not with_lines(replace(campaign, touches=nowhere)).nominal.counts_coordinate


def test_distances_on_lines_are_distances() -> None:
    """So is all that a fine counter tells, where surfaces lie on lines too."""
    assert not with_lines(read_campaign(MACHINE)).nominal.counts_coordinate


def test_plays_lie_on_the_lines_of_the_record() -> None:
    campaign = with_lines(counted(slow(read_campaign(MACHINE))))
    touches = campaign.touches
    axes = dict.fromkeys(("X", "Y", "Z"), FAR_UM)

    plays = Rig(campaign.nominal, (), FittedDatum(axes)).play(touches, seed=5, replicates=20)

    coordinate_um = plays.deviation_um + above_line_um(campaign.nominal, touches)
    off_um = coordinate_um - np.rint(coordinate_um / STEP_UM) * STEP_UM
    assert np.nanmax(np.abs(off_um)) < 1e-6
    alike = np.nanmean(np.abs(plays.deviation_um - touches.deviation_um) < 0.01)
    assert alike > 0.7


@pytest.mark.long
def test_arrivals_beside_a_coarse_counter_are_no_gap() -> None:
    """A step takes up to 12 ms, and a report half of one: what hides there is said to."""
    found = diagnose(counted(slow(read_campaign(MACHINE))), seed=1)

    assert found.verdict is Verdict.NO_GAP
    step_us = STEP_UM / (100.0 / 60.0) * 1000.0
    assert found.gap["report_after_latch_us"].could_hide > 0.1 * step_us


@pytest.mark.parametrize(("pretravel_um", "least_um"), [(6.0, 0.0), (0.0, -np.inf)])
def test_pretravel_ends_at_0_in_format_1_where_somebody_calibrated_it(
    pretravel_um: float, least_um: float
) -> None:
    campaign = read_campaign(MACHINE)
    probe = replace(campaign.nominal.probe, pretravel_um=pretravel_um)
    nominal = replace(campaign.nominal, probe=probe)

    assert scene_of(replace(campaign, nominal=nominal)).least_pretravel_um == least_um
