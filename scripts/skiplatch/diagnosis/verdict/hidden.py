"""How large a gap could have hidden: what an acceptance has to know of a campaign without one."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.plays.left import SIGNIFICANT
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.scene.covariates import varying
from skiplatch.diagnosis.scene.scene import Scene, rounding_step
from skiplatch.diagnosis.verdict.gap_observables import observables

POWER = 0.95
"""Chance with which a larger one would have been seen."""
PLAYS = 30
FEWEST = 4
SPREADS_A_STEP = 0.3
"""Scatter over the step of rounding from which on means are known more closely than the step: they
are off by a twentieth of it at the most (Widrow and Kollár, Quantization Noise, 2008)."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """What could have hidden in one observable.

    Attributes:
        size: Of a shift of half of the touches of a path against the other half, in the
            observable's unit: one that goes with a recorded condition and is larger would have been
            left significantly with 95 %. Where rounding leaves no scatter, that is a whole step.
        relative: The same over the scatter of a touch.
    """

    size: float
    relative: float


def could_hide(scene: Scene, rig: Rig, *, seed: int) -> Mapping[str, Hidden]:
    """Give it for every observable that was recorded, on the path that tells most; by name."""
    outcomes = rig.play(scene.touches, seed=seed, replicates=PLAYS)
    setting = Setting(scene, seed)
    found = {}
    for observable in observables(scene, rig, seed):
        recorded = observable.values(scene.touches, scene.contact)
        played = observable.values(outcomes, scene.contact)
        known = ~np.isnan(recorded) & ~np.isnan(played).all(axis=0)
        paths = [known & ~scene.plc, known & scene.plc]
        hidden = [
            _hidden(
                (recorded - _middle(played))[rows],
                played[:, rows],
                _errors(int(rows.sum()), len(varying(setting.known, rows))),
                rounding_step(scene, observable.unit),
            )
            for rows in paths
            if rows.sum() >= FEWEST
        ]
        if hidden:
            found[observable.name] = min(hidden, key=lambda one: one.size)
    return found


def _middle(played: FloatArray) -> FloatArray:
    return np.nanmedian(np.where(np.isnan(played).all(axis=0), 0.0, played), axis=0)


def _errors(touches: int, conditions: int) -> float:
    """Give the standard errors from which on a shift along one of so many is hardly missed.

    What few touches scatter by is known badly: Student's t, whose own scatter grows with it.
    """
    chance, freedom = float(scipy.stats.norm.sf(SIGNIFICANT)) / max(conditions, 1), touches - 2
    least = float(scipy.stats.t.isf(chance / 2.0, freedom))
    wider = float(np.sqrt(1.0 + least**2 / (2.0 * freedom)))
    return least + float(scipy.stats.norm.ppf(POWER)) * wider


def _hidden(off: FloatArray, played: FloatArray, errors: float, step: float) -> Hidden:
    """Two halves of n touches differ by chance by twice the scatter over the root of n."""
    noise = float(np.sqrt(np.nanmedian(np.nanvar(played, axis=0))))
    scatter = max(noise, float(scipy.stats.median_abs_deviation(off, scale="normal")))
    relative = errors * 2.0 / float(np.sqrt(len(off)))
    is_rounded_away = scatter < SPREADS_A_STEP * step
    return Hidden(step if is_rounded_away else relative * scatter, relative)
