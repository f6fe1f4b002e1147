"""What nobody stated of the positions, and only the touches tell: how they scatter, in which steps.

Without either, all scatter would be a gap, and the steps of the positions a coarse encoder.
"""

from dataclasses import replace
from math import sqrt

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Campaign, InputPath, Kind
from skiplatch.campaign.steps import common_step
from skiplatch.diagnosis.fit.beliefs import REPEATABILITY, believing
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.errors import InputError
from skiplatch.repeatability import repeatability
from skiplatch.units import ARCSEC_PER_MILLIDEGREE

RESOLUTION = ("axis", "resolution_um")
FEWEST_ALIKE = 5
"""Touches that have a middle which most of them are about."""
FEWEST = 12
"""Of such touches, that tell what an axis scatters by."""
MOST = 0.8
"""Share of them that nothing but scatter moves."""


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
    """Give what surfaces that were touched once scatter by, on the axis that scatters least.

    About the middle of those of an axis, a sense and a session, and of a feed where so many have
    one, beside what is believed. Most of them have the scatter of the probe, on an axis that has no
    other.
    """
    scene = Scene.of(campaign)
    touches = scene.touches
    off_um = touches.deviation_um - scene.pretravel_um - scene.speed * scene.wait_us
    known = ~np.isnan(off_um) & ~touches.false
    surface = np.column_stack([touches.axis, touches.sign, touches.session])
    scattered = [
        _of_most(found)
        for axis in np.unique(touches.axis)
        for alike in (surface, np.column_stack([surface, touches.feed_mm_min]))
        if len(found := _about_middles(off_um, alike, known & (touches.axis == axis))) >= FEWEST
    ]
    return min(scattered, default=0.0)


def _of_most(off: FloatArray) -> float:
    """Give the standard deviation of a normal law of which most values, shape (m,), are.

    A median of them would be that of a step or of two, where these are coarse.
    """
    reach = float(scipy.stats.norm.ppf((1.0 + MOST) / 2.0))
    most = np.sort(np.abs(off))[: round(MOST * len(off))]
    return float(np.sqrt(np.mean(most**2)) / scipy.stats.truncnorm.std(-reach, reach))


def _about_middles(values: FloatArray, alike: FloatArray, rows: BoolArray) -> FloatArray:
    """Give what some values, shape (n,), are off the medians of those alike, shape (n, c)."""
    _, group = np.unique(np.nan_to_num(alike[rows]), axis=0, return_inverse=True)
    group = group.ravel()
    off = [values[rows][group == one] - np.median(values[rows][group == one]) for one in set(group)]
    return np.concatenate([np.zeros(0), *(one for one in off if len(one) >= FEWEST_ALIKE)])
