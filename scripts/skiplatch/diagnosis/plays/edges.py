"""Touches whose contacts close when a bench closed them."""

from dataclasses import replace

import numpy as np

from skiplatch.campaign import Touches
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.units import US_PER_S

NOISE_EXPLAINS = 1.5
"""Times the noise of the reference instrument, root mean square, that edges may lie off by."""
RESOLVED_US = 0.002  # to which edges are written


def at_given_edges(rig: Rig, conditions: Touches) -> Touches:
    """Start the moves so that contacts close when a bench is known to have closed them.

    What the noise of the reference instrument explains is left: the rig latched the edge, and not
    its reading.
    """
    played = rig.play(conditions, seed=0, replicates=1)
    off_us = conditions.edge_us - played.true_edge_us[0]
    known = off_us[~np.isnan(off_us)]
    noise_us = NOISE_EXPLAINS * rig.nominal.bench.reference_jitter_us + RESOLVED_US
    if not len(known) or np.sqrt(np.mean(known**2)) <= noise_us:
        return conditions
    return replace(conditions, time_s=conditions.time_s + np.nan_to_num(off_us) / US_PER_S)
