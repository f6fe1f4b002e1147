"""The nominal motion: when and how fast the axis meets the nominal surface."""

from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Nominal, Touches
from skiplatch.units import S_PER_MIN, US_PER_S


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """The expected contact of n touches with the nominal surface; arrays of shape (n,)."""

    time_us: FloatArray
    """Master clock."""
    speed_mm_s: FloatArray
    """From the contact on: the feed, or what a move shorter than the ramp has reached."""


def expected_contact(nominal: Nominal, touches: Touches) -> Contact:
    """Step 1 of the nominal chain: start from rest, accelerate to the feed, meet the surface."""
    return contact_at(touches, touches.feed_mm_min / S_PER_MIN, nominal.axis.accel_mm_s2)


def contact_at(
    touches: Touches, wanted_mm_s: FloatArray, accel_mm_s2: FloatArray | float
) -> Contact:
    """Give the contact at other speeds, shape (n,), or another acceleration than the nominal."""
    reachable_mm_s = np.sqrt(2.0 * accel_mm_s2 * touches.approach_mm)
    speed_mm_s = np.minimum(wanted_mm_s, reachable_mm_s)
    travel_s = touches.approach_mm / speed_mm_s + speed_mm_s / (2.0 * accel_mm_s2)
    return Contact((touches.time_s + travel_s) * US_PER_S, speed_mm_s)
