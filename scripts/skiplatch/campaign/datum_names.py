"""Which touches share one unknown place of the surface, and which way it moves them."""

from functools import reduce

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign.columns import Axis
from skiplatch.campaign.datum import DatumFreedom
from skiplatch.campaign.nominal import Nominal
from skiplatch.campaign.touches import Touches


def datum_names(nominal: Nominal, touches: Touches) -> NDArray[np.str_] | None:
    """Name the datum of each touch, the same in every part of a campaign; shape (n,).

    None where it is known.
    """
    if nominal.datum.free is DatumFreedom.NONE:
        return None
    axes = np.array([*(axis.name for axis in Axis), "axis"])[touches.axis]
    parts = {
        DatumFreedom.CAMPAIGN: [np.where(touches.turns, "campaign rotary", "campaign")],
        DatumFreedom.AXIS: [axes],
        DatumFreedom.AXIS_SENSE: [axes, np.where(touches.sign < 0.0, "-", "+")],
        DatumFreedom.SESSION: [axes],
        DatumFreedom.ZERO: [axes],
    }[nominal.datum.free]
    # What was homed or clamped anew has a datum of its own.
    if len(touches.session_names) > 1:
        sessions = np.array([f" session {name}" for name in touches.session_names])
        parts.append(sessions[touches.session])
    return reduce(np.char.add, parts)


def datum_senses(nominal: Nominal, touches: Touches) -> FloatArray:
    """Give what a µm of datum adds to how far each touch goes along its approach, 1 or -1; (n,)."""
    if not nominal.datum.is_at_rest:
        return np.ones(len(touches))
    return np.where(touches.sign < 0.0, -1.0, 1.0)
