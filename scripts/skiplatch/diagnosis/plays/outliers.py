"""Touches far off all that their rig plays: they measure no gap, and no finding rests on them.

They are accidents, then, as latches without a contact are. Accidents go with nothing: what tells
which touches they are is left.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.plays.left import SIGNIFICANT
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.plays.size import far_off
from skiplatch.diagnosis.plays.telling import FEWEST, told_which
from skiplatch.diagnosis.plays.turns import happens_in_turn
from skiplatch.diagnosis.scene.covariates import in_words, varying
from skiplatch.diagnosis.scene.observed import UNITS, observed_evenly, step
from skiplatch.diagnosis.scene.scene import Scene

PLAYS = 500
"""So many that some play shows what happens to one touch in a hundred, at nearly every touch."""
MOST = 0.5
"""Share of touches from which on those far off are what is usual."""
OUTLYING = frozenset({"edge", "latch", "position", "report"})
SEEN_BY = ("feed", "path")
"""What an accident goes with as it is seen: a time is a longer way at a higher feed."""


@dataclass(frozen=True, slots=True)
class Outliers:
    """Touches far off all that a rig plays, and by what matters.

    Attributes:
        touches: Their serial numbers.
        observables: In which they are.
        beyond: How many of them lie beyond their plays in some, as what comes late does.
    """

    touches: Sequence[int] = ()
    observables: Sequence[str] = ()
    beyond: int = 0


def outliers(scene: Scene, rig: Rig, materiality: Materiality = DEFAULT, *, seed: int) -> Outliers:
    """Find them, and latches without a contact, which no rig plays.

    Where more than half of all touches are far off, it is the rig that is off: then none.
    """
    outcomes = rig.play(scene.touches, seed=seed, replicates=PLAYS)
    rng = np.random.default_rng(seed)
    recorded, played = (
        observed_evenly(scene, seen, rig.resolution_um, rng) for seen in (scene.touches, outcomes)
    )
    far, beyond, names = np.zeros(len(scene), bool), np.zeros(len(scene), bool), []
    for name in sorted(OUTLYING & recorded.keys()):
        off = np.zeros(len(scene))
        known = ~np.isnan(recorded[name]) & ~np.isnan(played[name]).all(axis=0)
        for path in (scene.plc, ~scene.plc):
            here = known & path
            if known.sum() >= FEWEST and here.any():
                values = recorded[name][here], played[name][:, here]
                off[here] = _off_all(*values, step(scene, name), materiality, UNITS[name])
        far |= off != 0.0
        beyond |= off > 0.0
        names += [name] if off.any() else []
    if far.mean() > MOST:
        return Outliers()
    far |= scene.false
    return Outliers(scene.touches.touch[far].tolist(), names, int(beyond.sum()))


def gone_with(scene: Scene, numbers: Sequence[int], *, seed: int) -> str:
    """Say what tells which touches, by serial number, are far off; nothing where chance may."""
    setting, far = Setting(scene, seed), np.isin(scene.touches.touch, numbers)
    turn = happens_in_turn(setting.order.serial, far)
    if turn is not None and turn.z > SIGNIFICANT:
        return f"every {turn.apart} touches"
    known = {name: values for name, values in setting.known.items() if name not in SEEN_BY}
    told = told_which(varying(known, np.full(len(far), fill_value=True)), far, seed)
    if told is None or told[-1] <= SIGNIFICANT:
        return ""
    _, names, _ = told
    return " and ".join(dict.fromkeys(map(in_words, names)))


def _off_all(
    recorded: FloatArray, plays: FloatArray, step: float, materiality: Materiality, unit: str
) -> FloatArray:
    """Give how far touches, shape (n,), are off plays, shape (r, n); 0 unless off all by much."""
    middle = np.nanmedian(plays, axis=0)
    off, reach = recorded - middle, np.nanmax(np.abs(plays - middle), axis=0)
    least = materiality.absolute(unit)
    if least is None:
        least = materiality.fraction * np.nanstd(plays, axis=0)
    return np.where((np.abs(off) > least) & far_off(off, reach, step), off, 0.0)
