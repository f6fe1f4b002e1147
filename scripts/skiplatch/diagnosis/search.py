"""Finding the parameters of an effect, and the effects of a campaign."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import optimize, stats

from skiplatch.diagnosis.candidates import Candidate
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.law import FloatArray
from skiplatch.diagnosis.likelihood import affected, likelihood
from skiplatch.diagnosis.scene import Scene

WIDENINGS = (1.0, 0.1, 0.01, 0.0)
WORST = 1e300
NOTHING = Change()
CONFIDENCE = 0.9
SMALLEST_STEP = 1e-6
MOST_DOUBLINGS = 40
KEPT_STARTS = 2
EVALUATIONS = 150  # a parameter


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Effects with their best parameters."""

    candidates: tuple[Candidate, ...]
    parameters: tuple[FloatArray, ...]
    reached: frozenset[str]
    """Names of the streams that they can reach."""

    def change(self, scene: Scene) -> Change:
        """What they make of the physics."""
        total = Change()
        for candidate, parameters in zip(self.candidates, self.parameters, strict=True):
            total = total.joined(candidate.change(scene, parameters))
        return total

    @property
    def size(self) -> int:
        """Number of parameters."""
        return sum(len(parameters) for parameters in self.parameters)


def _split(candidates: Sequence[Candidate], values: FloatArray) -> tuple[FloatArray, ...]:
    ends = np.cumsum([len(candidate.names) for candidate in candidates])
    return tuple(np.split(values, ends[:-1]))


class _Target:
    """Minus the log-likelihood of parameters, counting only the streams they can reach."""

    def __init__(
        self,
        scene: Scene,
        candidates: Sequence[Candidate],
        starts: Sequence[FloatArray],
        given: Change,
    ) -> None:
        self._scene = scene
        self._given = given
        self._candidates = tuple(candidates)
        self._names = frozenset[str]()
        self._names = frozenset[str]().union(
            *(affected(scene, self.fit(start).change(scene)) for start in starts)
        )

    def fit(self, values: FloatArray) -> Fit:
        return Fit(self._candidates, _split(self._candidates, values), self._names)

    def __call__(self, values: FloatArray, widening: float) -> float:
        change = self._given.joined(self.fit(values).change(self._scene))
        total = likelihood(self._scene, change, widening, self._names).total
        return -total if np.isfinite(total) else WORST


def _simplex(start: FloatArray) -> FloatArray:
    """Nelder-Mead's first steps: a third of each parameter, or something where that is 0."""
    steps = np.where(np.abs(start) > 0.0, 0.3 * np.abs(start), 1.0)
    return np.vstack([start, start + np.diag(steps)])


def _climb(target: _Target, start: FloatArray, widening: float) -> FloatArray:
    found = optimize.minimize(
        target,
        start,
        args=(widening,),
        method="Nelder-Mead",
        options={
            "initial_simplex": _simplex(start),
            "maxfev": EVALUATIONS * len(start),
            "xatol": 1e-4,
            "fatol": 0.02,
        },
    )
    return np.asarray(found.x)


def fit(
    scene: Scene,
    candidates: Sequence[Candidate],
    starts: Iterable[Sequence[float]],
    given: Change = NOTHING,
    widenings: Sequence[float] = WIDENINGS,
) -> Fit:
    """Fit parameters from several starts, coarse to fine, on top of what is given."""
    points = begun = [np.asarray(start, dtype=float) for start in starts]
    target = _Target(scene, candidates, points, given)
    for stage, widening in enumerate(widenings):
        kept = KEPT_STARTS if stage == 0 else 1
        points = sorted(points, key=lambda point: target(point, widening))[:kept]
        if not all(candidate.exact for candidate in candidates):
            points = [_climb(target, point, widening) for point in points]
    # A start may sit on a peak too sharp to be found by climbing.
    return target.fit(min([*points, *begun], key=lambda point: target(point, 0.0)))


def intervals(scene: Scene, found: Fit) -> list[list[tuple[float, float]]]:
    """Tell for each parameter of each effect how far it can go down and up.

    Up to where the log-likelihood has fallen by half the 90 % quantile of chi-squared with one
    degree of freedom, the other parameters as they are.
    """
    values = np.concatenate(found.parameters)
    target = _Target(scene, found.candidates, [values], NOTHING)
    limit = target(values, 0.0) + float(stats.chi2.ppf(CONFIDENCE, 1)) / 2.0
    ends = [
        (_reach(target, values, i, -1.0, limit), _reach(target, values, i, 1.0, limit))
        for i in range(len(values))
    ]
    counts = np.cumsum([len(parameters) for parameters in found.parameters])[:-1]
    return [ends[a:b] for a, b in zip([0, *counts], [*counts, len(ends)], strict=True)]


def _reach(target: _Target, values: FloatArray, index: int, sense: float, limit: float) -> float:
    """How far one parameter goes before the target passes the limit."""

    def excess(step: float) -> float:
        moved = values.copy()
        moved[index] += sense * step
        return target(moved, 0.0) - limit

    step = SMALLEST_STEP * max(abs(float(values[index])), 1.0)
    for _ in range(MOST_DOUBLINGS):
        if excess(step) > 0.0:
            return float(optimize.brentq(excess, 0.0, step, rtol=1e-2))
        step *= 2.0
    return step
