"""Models fitted to two campaigns of one rig together: what the second adds to the first."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.candidates.surrogates import turn_of
from skiplatch.diagnosis.experiment.rivals import Model
from skiplatch.diagnosis.fit.climb import WORST
from skiplatch.diagnosis.fit.fit import SLACKS, WORTH_A_REFINEMENT, Fit
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects

MOST_TOUCHES = 2_000
"""Touches of the first campaign that the parameters are held to."""
EVALUATIONS = 40  # a parameter


def some(scene: Scene) -> Scene:
    """Give touches enough of a large campaign, the same ones each time."""
    return scene.drawn(MOST_TOUCHES, seed=0)


def added_nats(old: Scene, new: Scene, before: Fit) -> float:
    """Give what new touches add to the log-likelihood of a model that suits the old ones."""
    both = suited([old, new], before)
    return total([old, new], both) - total([old], before)


def as_fit(model: Model) -> Fit:
    """Give effects as the likelihood takes them."""
    candidates = tuple(catalogue()[effect.id] for effect in model)
    parameters = tuple(
        np.array([effect.parameters.get(name, 0.0) for name in candidate.names])
        for effect, candidate in zip(model, candidates, strict=True)
    )
    return Fit(candidates, parameters, frozenset())


def suited(scenes: Sequence[Scene], model: Fit) -> Fit:
    """Climb to the parameters that suit all scenes; what is 0 stays so.

    No real effect has just the form that is fitted: slack is tried as well.
    """
    loose = [replace(model, slack=slack) for slack in (0.0, *SLACKS)]
    worth = [total(scenes, m) - WORTH_A_REFINEMENT * (m.slack > 0.0) for m in loose]
    found = loose[int(np.argmax(worth))]
    return _climb(scenes, found) if found.candidates else found


def _climb(scenes: Sequence[Scene], model: Fit) -> Fit:
    start = np.concatenate(model.parameters)
    free = np.flatnonzero(start)
    most = np.concatenate([_most(candidate) for candidate in model.candidates])
    ends = np.cumsum([len(values) for values in model.parameters])[:-1]

    def moved(values: FloatArray) -> Fit:
        point = start.copy()
        point[free] = values
        point = np.clip(point, -most, most)
        return replace(model, parameters=tuple(np.split(point, ends)))

    steps = np.vstack([np.zeros(len(free)), np.diag(0.1 * np.abs(start[free]))])

    def minus(values: FloatArray) -> float:
        return -total(scenes, moved(values))

    found = scipy.optimize.minimize(
        minus,
        start[free],
        method="Nelder-Mead",
        options={
            "initial_simplex": start[free] + steps,
            "maxfev": EVALUATIONS * len(free),
            "fatol": 0.02,
            "xatol": 1e-4,
        },
    )
    return moved(found.x)


def _most(candidate: Candidate) -> FloatArray:
    """Give how large each parameter may become: places turn, and an amplitude may be negative."""
    return np.array(
        [
            np.inf if turn_of(parameter) else max(abs(parameter.low), abs(parameter.high))
            for parameter in effects()[candidate.id].parameters
        ]
    )


def total(scenes: Sequence[Scene], model: Fit) -> float:
    """Give the log-likelihood of all scenes."""
    nats = sum(likelihood(scene, model.change(scene)).total for scene in scenes)
    return nats if np.isfinite(nats) else -WORST
