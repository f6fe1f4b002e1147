"""Touches far off all that their rig plays: listed by number; no gap is measured by them."""

import numpy as np

from skiplatch.diagnosis.look import FEWEST, scatter
from skiplatch.diagnosis.observed import observed, step
from skiplatch.diagnosis.playing import Rig
from skiplatch.diagnosis.scene import Scene

PLAYS = 60
OUTLYING = frozenset({"edge", "latch", "position", "report"})
FAR = 6.0
"""Standard deviations beyond all plays that make a touch an outlier."""
MOST_OUTLIERS = 0.05
"""Share of touches up to which those far off are outliers; more are something else."""


def outliers(scene: Scene, rig: Rig, *, seed: int) -> list[int]:
    """List the touches, by serial number, that are far off what a rig plays, if they are few."""
    outcomes = rig.play(scene.touches, seed=seed, replicates=PLAYS)
    recorded, played = observed(scene, scene.touches), observed(scene, outcomes)
    far = np.full(len(scene), fill_value=False)
    for name in OUTLYING & recorded.keys():
        rows = ~np.isnan(recorded[name]) & ~np.isnan(played[name]).all(axis=0)
        if rows.sum() < FEWEST:
            continue
        plays = played[name][:, rows]
        middle, off = np.nanmedian(plays, axis=0), np.zeros(len(scene))
        off[rows] = recorded[name][rows] - middle
        reach = np.zeros(len(scene))
        reach[rows] = np.nanmax(np.abs(plays - middle), axis=0)
        for path in (scene.plc, ~scene.plc):
            here = rows & path
            if here.any():
                usual = FAR * max(scatter(off[here]), step(scene, name))
                far |= here & (np.abs(off) > 2.0 * reach + usual)
    found = scene.touches.touch[far]
    return found.tolist() if len(found) <= MOST_OUTLIERS * len(scene) else []
