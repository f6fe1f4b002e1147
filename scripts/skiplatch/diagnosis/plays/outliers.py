"""Touches far off all that their rig plays: they measure no gap, and no finding rests on them."""

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.size import far_off
from skiplatch.diagnosis.plays.telling import FEWEST
from skiplatch.diagnosis.scene.observed import UNITS, observed, step
from skiplatch.diagnosis.scene.scene import Scene

PLAYS = 500
"""So many that some play shows what happens to one touch in a hundred, at nearly every touch."""
MOST = 0.5
"""Share of touches from which on those far off are what is usual."""
OUTLYING = frozenset({"edge", "latch", "position", "report"})


def outliers(scene: Scene, rig: Rig, materiality: Materiality = DEFAULT, *, seed: int) -> list[int]:
    """List the touches, by serial number, that are far off all that a rig plays, and material.

    Where more than half of them are it is the rig that is off, and none is told from the others.
    """
    outcomes = rig.play(scene.touches, seed=seed, replicates=PLAYS)
    recorded, played = observed(scene, scene.touches), observed(scene, outcomes)
    far = np.full(len(scene), fill_value=False)
    for name in OUTLYING & recorded.keys():
        known = ~np.isnan(recorded[name]) & ~np.isnan(played[name]).all(axis=0)
        for path in (scene.plc, ~scene.plc):
            here = known & path
            if known.sum() >= FEWEST and here.any():
                values = recorded[name][here], played[name][:, here]
                far[here] |= _are_far(*values, step(scene, name), materiality, UNITS[name])
    return [] if far.mean() > MOST else scene.touches.touch[far].tolist()


def _are_far(
    recorded: FloatArray, plays: FloatArray, step: float, materiality: Materiality, unit: str
) -> BoolArray:
    """Tell which touches, shape (n,), are far off their plays, shape (r, n), by what matters."""
    middle = np.nanmedian(plays, axis=0)
    off, reach = recorded - middle, np.nanmax(np.abs(plays - middle), axis=0)
    least = materiality.absolute(unit)
    if least is None:
        least = materiality.fraction * np.nanstd(plays, axis=0)
    return (np.abs(off) > least) & far_off(off, reach, step)
