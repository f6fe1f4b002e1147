"""Scans that a logic analyser stamps, a thousand times finer than the scans themselves scatter."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.fit import fit
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene

TICK_US = 0.001
SCANS_US = 4000.0
BELIEVED_US = 1000.0
LATE_US = 2.0
"""Each scan begins anywhere within so much."""


def stamped(believed_us: float) -> Scene:
    """Touches of the PLC alone, of scans that are believed to come after another time."""
    campaign = read_campaign(BENCH)
    touches = campaign.touches.select(np.flatnonzero(campaign.touches.on_plc))
    scans = np.ceil(touches.edge_us / SCANS_US)
    late_us = np.random.default_rng(3).uniform(0.0, LATE_US, len(touches))
    stamps_us = np.round(SCANS_US * scans + late_us, 3)
    nominal = replace(
        campaign.nominal,
        skip=replace(campaign.nominal.skip, tick_us=TICK_US),
        plc=replace(campaign.nominal.plc, scan_us=believed_us),
    )
    return Scene.of(
        replace(campaign, nominal=nominal, touches=replace(touches, latch_us=stamps_us))
    )


@pytest.mark.parametrize("late_us", [0.5 * LATE_US, LATE_US, 8.0 * LATE_US])
def test_a_grid_is_as_likely_as_its_scatter_is_narrow(late_us: float) -> None:
    """Of a box that holds all stamps each says the logarithm of its share of the period."""
    scene = stamped(SCANS_US)
    jitter = CANDIDATES["scan_jitter"].change(scene, np.array([late_us, 0.0, 0.0]))

    told = likelihood(scene, jitter).streams["lattice"][scene.streams["lattice"].rows]

    usual = np.log(SCANS_US / late_us)
    assert (np.mean(told) == pytest.approx(usual, abs=0.1)) == (late_us >= LATE_US)
    assert told.max() < usual + 0.1


def test_a_scatter_far_narrower_than_the_stamps_have_is_no_likelier() -> None:
    scene = stamped(SCANS_US)
    jitter = CANDIDATES["scan_jitter"]
    wide, narrow = (
        likelihood(scene, jitter.change(scene, np.array(p)), names=["lattice"]).total
        for p in ([LATE_US, 0.0, 0.0], [0.0005, 0.0041, 0.0])
    )

    assert narrow < wide


def test_a_period_is_told_by_all_stamps_and_not_by_how_their_neighbours_scatter() -> None:
    scene, period = stamped(BELIEVED_US), CANDIDATES["scan_period"]

    found = fit(scene, [period], period.starts(scene, Change()))

    scans = np.ptp(scene.touches.latch_us) / SCANS_US
    off_us = found.parameters[0][0] - (SCANS_US - BELIEVED_US)
    assert abs(off_us) * scans < LATE_US
