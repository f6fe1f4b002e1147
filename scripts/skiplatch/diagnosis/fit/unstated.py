"""What nobody stated of the positions, and only the touches tell: how they scatter, in which steps.

Without either, all scatter would be a gap, and the steps of the positions a coarse encoder.
"""

from dataclasses import replace
from math import sqrt

import numpy as np

from skiplatch.campaign import Campaign, InputPath, Kind
from skiplatch.campaign.steps import common_step
from skiplatch.diagnosis.fit.beliefs import REPEATABILITY, believing
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.errors import InputError
from skiplatch.repeatability import repeatability
from skiplatch.statistics import robust_deviation
from skiplatch.units import ARCSEC_PER_MILLIDEGREE

RESOLUTION = ("axis", "resolution_um")
FEWEST = 5
"""Touches that have a middle which most of them are about."""


def with_unstated(campaign: Campaign) -> Campaign:
    """Give a machine's campaign the step and the scatter of its touches, where it states none.

    Surfaces that were touched once may lie anywhere; but then, too, most scatter is the rig's own.

    Touches of a PLC scatter by its scans, and tell neither.
    """
    nominal = campaign.nominal
    latched = campaign.touches.select(campaign.touches.path == InputPath.SKIP)
    if nominal.kind is not Kind.MACHINE or not len(latched):
        return campaign
    step_um = common_step(latched.deviation_um) if RESOLUTION in nominal.unknown else None
    if step_um is not None:
        nominal = believing(nominal, {RESOLUTION: step_um})
    if REPEATABILITY in nominal.unknown:
        scatter_um = _scatter_um(replace(campaign, nominal=nominal, touches=latched))
        nominal = believing(nominal, {REPEATABILITY: scatter_um})
    return replace(campaign, nominal=nominal)


def _scatter_um(campaign: Campaign) -> float:
    """Give the standard deviation of touches of one surface, less their rounding; 0 if unknown."""
    try:
        found = repeatability(campaign)
    except InputError:
        sigma_um = _about_middles_um(campaign)
    else:
        sigma = found.in_a_row.sigma if found.in_a_row else found.sigma
        per_um = ARCSEC_PER_MILLIDEGREE if found.unit == "arcsec" else 1.0
        sigma_um = sigma.value / per_um
    rounding_um = campaign.nominal.axis.resolution_um / sqrt(12.0)
    return sqrt(max(sigma_um**2 - rounding_um**2, 0.0))


def _about_middles_um(campaign: Campaign) -> float:
    """Give what surfaces that were touched once scatter by, with whatever else moves most of them.

    About the middle of those of an axis, a sense, a session and a feed, beside what is believed.
    """
    scene = Scene.of(campaign)
    touches = scene.touches
    alike = np.column_stack([touches.axis, touches.sign, touches.session, touches.feed_mm_min])
    _, group = np.unique(np.nan_to_num(alike), axis=0, return_inverse=True)
    off_um = touches.deviation_um - scene.pretravel_um - scene.speed * scene.wait_us
    known = ~np.isnan(off_um) & ~touches.false
    off_um, group = off_um[known], group.ravel()[known]
    middles = [np.median(off_um[group == one]) for one in group]
    often = np.bincount(group, minlength=1)[group] >= FEWEST
    return robust_deviation((off_um - middles)[often]) if often.any() else 0.0
