"""Scores of held-out touches against plays, a cell of path and feed at a time; see ``shrink``."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
import scipy
from scoringrules import crps_ensemble  # type: ignore[import-untyped]

from skiplatch.arrays import FloatArray, calmed
from skiplatch.campaign import InputPath
from skiplatch.comparison.gap import RESOLVABLE

MOST_POOLED = 400
HALF_A_STEP = 3.0
"""Of rounding, over the noise floor of what is known but for that: a sixth of a step."""


@dataclass(frozen=True, slots=True, eq=False)
class TouchScores:
    """Touches and what a simulation scores on them; arrays of shape (m,)."""

    scores: FloatArray
    floor: FloatArray
    """What it scores on its own plays."""


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """Held-out touches of one path and feed under each simulation."""

    path: InputPath
    before: TouchScores
    after: TouchScores
    truth: TouchScores | None
    recorded: FloatArray = field(default_factory=lambda: np.empty(0))
    ensembles: Sequence["Ensemble"] = ()
    """Plays without the effects and with them, and those of the truth, where it is known."""

    @classmethod
    def of(cls, path: InputPath, recorded: FloatArray, ensembles: Sequence["Ensemble"]) -> Self:
        """Score touches, shape (m,)."""
        before, after, *truth = (ensemble.scored(recorded) for ensemble in ensembles)
        return cls(path, before, after, truth[0] if truth else None, recorded, ensembles)

    def unit(self, least: float) -> float:
        """Give what scores count in: the noise floor, which is at least `least`."""
        return max(float(self.after.floor.mean()), least)

    def beside(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Give what the record and a play of the effects score on their other plays; (m,) each.

        Were the effects the truth, the two would differ by luck alone.
        """
        after = self.ensembles[1]
        one, another = (after.scored(v, but=k).scores for v in (self.recorded, after.plays[k]))
        return one, another

    def lost_beside(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Give by how much each of them scores worse than without the effects; (m,) each."""
        before, played = self.ensembles[0], self.ensembles[1].plays[k]
        one, another = self.beside(k)
        return one - before.scored(self.recorded).scores, another - before.scored(played).scores


@dataclass(frozen=True, slots=True, eq=False)
class Ensemble:
    """Plays of m touches, each moved and scaled alike; arrays of shape (m,), plays of (r, m).

    Attributes:
        plays: Of each touch; one that was not latched has another play's outcome.
        scale: Turns their unit into that of the observable.
        is_pooled: A touch is held against the plays of all. All touches of a campaign share the
            phase of one scan, and so do those of a replicate: its own plays alone show a touch no
            more phases than there are replicates, and to all of them the same.
        has_places: Pooled plays lie about the mean of each touch's own: what plays know of it, as
            where in a wave it lies, is in that.
    """

    plays: FloatArray
    scale: FloatArray
    is_pooled: bool
    has_places: bool = False

    @classmethod
    def of(
        cls, plays: FloatArray, scale: FloatArray, *, is_pooled: bool, has_places: bool = False
    ) -> Self:
        """Fill in what was not latched; some play of each touch was."""
        filled = plays.copy()
        for i in np.flatnonzero(np.isnan(plays).any(axis=0)):
            filled[:, i] = np.resize(plays[~np.isnan(plays[:, i]), i], len(plays))
        return cls(filled, scale, is_pooled, has_places)

    def scored(self, recorded: FloatArray, but: int | None = None) -> TouchScores:
        """Score touches, shape (m,), in units of the plays, by all replicates but one."""
        plays = self.plays if but is None else np.delete(self.plays, but, axis=0)
        if self.is_pooled:
            middle = _middles(plays) if self.has_places else np.zeros(plays.shape[1])
            pool = np.sort((plays - middle).ravel())
            chosen = np.linspace(0, len(pool) - 1, min(MOST_POOLED, len(pool)))
            ensemble = middle[:, None] + pool[np.rint(chosen).astype(int)]
        else:
            ensemble = plays.T
        return TouchScores(self.scale * _crps(recorded, ensemble), self.scale * floor_of(ensemble))


@dataclass(frozen=True, slots=True, eq=False)
class CellScores:
    """Scores of the touches of some cells, in units of their noise floors; shape (m,)."""

    units: FloatArray
    before: FloatArray
    after: FloatArray
    floor: FloatArray
    nominal_floor: FloatArray
    truth: FloatArray | None

    @classmethod
    def of(cls, cells: Sequence[Cell], least: float) -> Self:
        """Put cells together; `least` is the noise floor of what is known but for its rounding."""
        floors = [_but_for_rounding(cell.after.floor, least) for cell in cells]
        nominal_floors = [_but_for_rounding(cell.before.floor, least) for cell in cells]
        units = np.concatenate([np.full(len(cell.after.floor), cell.unit(least)) for cell in cells])

        def together(scores: Iterable[FloatArray]) -> FloatArray:
            return np.asarray(np.concatenate(list(scores)) / units)

        truth = [cell.truth.scores for cell in cells if cell.truth]
        return cls(
            units=units,
            before=together(cell.before.scores for cell in cells),
            after=together(cell.after.scores for cell in cells),
            floor=together(floors),
            nominal_floor=together(nominal_floors),
            truth=together(truth) if truth else None,
        )

    def is_clear(self, limit: float) -> bool:
        """Tell whether there is a gap, or one that the effects made or took away.

        Each simulation is held against its own noise floor. One that scatters hides any gap by it:
        where the two differ, the worse is held against the lower floor as well, for two of which
        neither misses the touches differ by how their plays happen to be rounded.
        """
        floors = (self.floor, self.nominal_floor)
        worse = max(self.before, self.after, key=np.mean)
        return (
            _exceed(self.before, self.nominal_floor) < limit
            or _exceed(self.after, self.floor) < limit
            or (
                _differ(self.before, self.after) < limit
                and _exceed(worse, min(floors, key=np.mean)) < limit
            )
        )


def _middles(plays: FloatArray) -> FloatArray:
    """Give where each touch lies by its own plays, as far as these tell it from others; (m,).

    Their means differ by the phases that its plays happened to have, too: by that much less.
    """
    within = float(np.mean(np.var(plays, axis=0, ddof=1)))
    return calmed(plays.mean(axis=0), within / len(plays))


def _but_for_rounding(floor: FloatArray, least: float) -> FloatArray:
    """Add to a noise floor, shape (m,), what rounding may cost plays that all round alike.

    They do not tell where within a step they are: what was recorded may round the other way, and
    is then off by a step. Of all the places that there are, that is half a step on average.
    """
    return floor + HALF_A_STEP * np.maximum(least - floor, 0.0)


def _differ(one: FloatArray, another: FloatArray) -> float:
    """Give the p-value of two simulations that score touches equally well, shape (m,) each.

    Which one does better by luck is as likely the one as the other, by any amount (Wilcoxon,
    Biometrics Bulletin 1 (1945) 80); a few that both miss by far drown no others.
    """
    differences = one - another
    if np.max(np.abs(differences)) < RESOLVABLE:
        return 1.0
    return float(scipy.stats.wilcoxon(differences, zero_method="zsplit", method="approx").pvalue)


def _crps(recorded: FloatArray, ensemble: FloatArray) -> FloatArray:
    return np.asarray(crps_ensemble(recorded, ensemble, estimator="pwm", backend="numpy"))


def floor_of(ensemble: FloatArray) -> FloatArray:
    """Give half of the mean difference between two plays of a touch; shape (m,)."""
    ordered = np.sort(ensemble, axis=1)
    r = ordered.shape[1]
    return np.asarray(ordered @ (2.0 * np.arange(1, r + 1) - r - 1.0) / (r * (r - 1.0)))


def _exceed(scores: FloatArray, floor: FloatArray) -> float:
    """Give the p-value of scores no greater on average than a floor, by Student's t."""
    differences = scores - floor
    if np.ptp(differences) < RESOLVABLE:
        return float(differences.mean() < RESOLVABLE)
    return float(scipy.stats.ttest_1samp(differences, 0.0, alternative="greater").pvalue)
