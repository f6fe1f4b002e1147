"""Giving effects another form than the one that was fitted, or slack, where that is worth it."""

from collections.abc import Sequence

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.candidate import Candidate, Refinement
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.fit.climb import climb
from skiplatch.diagnosis.fit.fit import (
    FINEST,
    SLACKS,
    WORTH_A_REFINEMENT,
    Fit,
    Target,
    fit,
    fit_form,
)
from skiplatch.diagnosis.fit.least_squares import by_least_squares
from skiplatch.diagnosis.scene.scene import Scene

SHORT_STEPS = (0.01, 0.001)
"""First steps of climbs that follow one with long steps, as shares of the parameters."""
CLOSE = 0.1
"""By which the logarithm of a slack may be off."""
AFAR = 1.0
"""Widening by all that touches are off."""


def anew(scene: Scene, candidates: Sequence[Candidate], starts: Sequence[FloatArray]) -> Fit:
    """Fit effects from parameters that are close already, and give them another form or slack."""
    begun = [start.tolist() for start in starts]
    return polish(scene, fit(scene, candidates, begun, widenings=FINEST))


def refine(scene: Scene, found: Fit) -> Fit:
    """Fit effects jointly, from where they are."""
    start = np.concatenate(found.parameters)
    target = Target(scene, found.candidates, [start], NOTHING)
    best = _sharpened(target, _nearby(target, start))
    return target.fit(_loosened(target, best))


def given_way(scene: Scene, found: Fit) -> Fit:
    """Let all parameters of effects give way to each other, as far as least squares lead."""
    start = np.concatenate(found.parameters)
    target = Target(scene, found.candidates, [start], NOTHING)
    target.slack = found.slack
    return target.fit(by_least_squares(target, start))


def _sharpened(target: Target, best: FloatArray) -> FloatArray:
    """Climb on with smaller and smaller steps, as long as that is worth it.

    Two effects that make up for each other share a ridge, along which a climb with long steps ends
    too soon.
    """
    for step in SHORT_STEPS:
        further = climb(target, best, 0.0, step)
        gained = target(best, 0.0) - target(further, 0.0)
        best = further if gained > 0.0 else best
        if gained < WORTH_A_REFINEMENT:
            break
    return best


def polish(scene: Scene, found: Fit, given: Change = NOTHING) -> Fit:
    """Give a fit of one effect another form, and any fit slack, where that is worth it."""
    best = np.concatenate(found.parameters)
    target = Target(scene, found.candidates, [best], given)
    if len(found.candidates) > 1:
        return target.fit(_loosened(target, best))
    (candidate,) = found.candidates
    # Forms come first: slack would swallow what a jitter of its own explains.
    best = _loosened(target, _refined(target, candidate, best))
    return target.fit(_pruned(target, candidate, best) if target.slack > 0.0 else best)


def _loosened(target: Target, best: FloatArray) -> FloatArray:
    """Let the effect have another form than the one fitted, if that is worth it."""
    plain = target(best, 0.0)
    target.slack = _likeliest_slack(target, best)
    found = climb(target, best, 0.0)
    target.slack = _likeliest_slack(target, found)  # it stood for what was off before
    if target(found, 0.0) < plain - WORTH_A_REFINEMENT and target.takes_away(found):
        return found
    target.slack = 0.0
    return best


def _likeliest_slack(target: Target, point: FloatArray) -> float:
    """Find slack as closely as parameters are: what is short of it asks for a further effect."""

    def cost(slack: float) -> float:
        target.slack = slack
        return target(point, 0.0)

    costs = [cost(slack) for slack in SLACKS]
    i = int(np.argmin(costs))
    low, high = SLACKS[max(i - 1, 0)], SLACKS[min(i + 1, len(SLACKS) - 1)]
    found = scipy.optimize.minimize_scalar(
        lambda exponent: cost(float(np.exp(exponent))),
        bounds=(float(np.log(low)), float(np.log(high))),
        method="bounded",
        options={"xatol": CLOSE},
    )
    return float(np.exp(found.x)) if found.fun < costs[i] else SLACKS[i]


def _refined(target: Target, candidate: Candidate, best: FloatArray) -> FloatArray:
    """Give it other forms, the most worthwhile first, as long as that is worth it."""

    def cost(values: FloatArray) -> float:
        return target(values, 0.0) + WORTH_A_REFINEMENT * np.count_nonzero(values)

    promising = [r for r in candidate.refinements if not target.taken_up(candidate) & r.keys()]
    while promising:
        starts = [_freed(target, best, refinement) for refinement in promising]
        found = [_nearby(target, start) if start.any() else best for start in starts]
        costs = [cost(values) for values in found]
        promising = [r for r, c in zip(promising, costs, strict=True) if c < cost(best)]
        if promising:
            best = found[int(np.argmin(costs))]
    return best


def _nearby(target: Target, start: FloatArray) -> FloatArray:
    """Fit from a start that is nearly right: no search from afar does better."""
    return fit_form(target, [by_least_squares(target, start)], FINEST)


def _pruned(target: Target, candidate: Candidate, best: FloatArray) -> FloatArray:
    """Take parameters away that slack has made worthless: what they shift would have some, too."""
    for index in sorted({index for refinement in candidate.refinements for index in refinement}):
        less = best.copy()
        less[index] = 0.0
        if less.any() and target(less, 0.0) <= target(best, 0.0) + WORTH_A_REFINEMENT:
            best = less
    return best


def _freed(target: Target, values: FloatArray, refinement: Refinement) -> FloatArray:
    """Give parameters that matter a first value; all 0 where none of them stood at 0."""
    start = values.copy()
    for index, value in refinement.items():
        start[index] = value(values) if callable(value) else start[index] or value
    for index in refinement:
        less = start.copy()
        less[index] = values[index]
        # That of an axis without a touch changes nothing, seen from as far as may be.
        start = less if target(less, AFAR) == target(start, AFAR) else start
    return np.zeros_like(start) if np.array_equal(start, values) else start
