"""How a probe scatters by touches in a row, where a preset could only guess.

A guess that is too wide takes a small delay or drift for scatter.
"""

from math import sqrt
from pathlib import Path

import numpy as np

from skiplatch.campaign import Campaign, InputPath, Nominal, Touches
from skiplatch.errors import InputError
from skiplatch.importing.model import Figure
from skiplatch.repeatability import repeatability

FINEST = 0.1
"""Of the resolution; less scatter does not show."""
ROUNDED_TO = 3  # decimals of a µm
HALF_OF_95 = 1.96  # standard uncertainties


def told_in_a_row(touches: Touches, guessed: Nominal) -> Figure | None:
    """Give the scatter of a probe that touches show in a row, if it is less than what is guessed.

    One that is larger is a gap, which a diagnosis is to see. None for want of touches, and for
    those of a PLC, whose scans scatter more.
    """
    if np.any(touches.path != InputPath.SKIP):
        return None
    try:
        seen = repeatability(Campaign(guessed, touches, Path())).in_a_row
    except InputError:
        return None
    if seen is None or seen.sigma.value >= guessed.probe.repeatability_um:
        return None
    resolution_um = guessed.axis.resolution_um
    variance = seen.sigma.value**2 - resolution_um**2 / 12.0
    sigma = max(sqrt(max(variance, 0.0)), FINEST * resolution_um)
    u = (seen.sigma.high - seen.sigma.low) / (2.0 * HALF_OF_95)
    source = "by how touches of one surface in a row differ, less their rounding"
    return Figure(round(sigma, ROUNDED_TO), source, round(u, ROUNDED_TO))
