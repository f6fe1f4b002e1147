"""Lines of a coarse counter: those of the axis coordinate, where a record shows that.

A counter counts the axis, and not how far it is from a surface. That tells nothing apart where
surfaces lie on lines, as they do with a fine counter; where they lie between two, all touches of
one are rounded alike, and those of others otherwise.
"""

from dataclasses import replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Nominal, Touches
from skiplatch.diagnosis.scene.pitches import is_on_grid
from skiplatch.units import UM_PER_MM

WRITTEN = 0.05
"""Share of a step by which numbers on a line may be written off it."""


def with_lines(campaign: Campaign) -> Campaign:
    """Take positions as counts of the coordinate, if all of these lie on lines and they do not."""
    nominal, touches = campaign.nominal, campaign.touches
    step_um = nominal.axis.resolution_um
    known = touches.select(~np.isnan(touches.deviation_um + touches.position_mm))
    if not len(known) or is_on_grid(known.deviation_um, step_um, WRITTEN * step_um):
        return campaign
    counted_um = known.deviation_um + _of_surfaces_um(known)
    is_counted = is_on_grid(counted_um, step_um, WRITTEN * step_um)
    return replace(campaign, nominal=replace(nominal, counts_coordinate=is_counted))


def above_line_um(nominal: Nominal, touches: Touches) -> FloatArray:
    """Give how far beyond a line the surface of each touch is believed to lie; shape (n,)."""
    if not nominal.counts_coordinate:
        return np.zeros(len(touches))
    step_um, surfaces_um = nominal.axis.resolution_um, np.nan_to_num(_of_surfaces_um(touches))
    return np.asarray(surfaces_um - np.rint(surfaces_um / step_um) * step_um)


def _of_surfaces_um(touches: Touches) -> FloatArray:
    """Give their coordinates along the motion, shape (n,)."""
    return np.asarray(np.nan_to_num(touches.sign, nan=1.0) * touches.position_mm * UM_PER_MM)
