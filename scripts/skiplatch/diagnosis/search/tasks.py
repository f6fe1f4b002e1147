"""Fits that may run in processes of their own: functions of one argument that can travel."""

from dataclasses import replace

import numpy as np

from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.fit import Fit, fit
from skiplatch.diagnosis.fit.forms import polish, refine
from skiplatch.diagnosis.fit.onset import passing
from skiplatch.diagnosis.scene.scene import Scene


def both(first: Fit, second: Fit) -> Fit:
    """Put the effects of two fits together."""
    return Fit(
        first.candidates + second.candidates,
        first.parameters + second.parameters,
        first.reached | second.reached,
        max(first.slack, second.slack),
    )


def fit_passing(model: tuple[Scene, Fit]) -> Fit:
    """Fit when an effect begins or ends, on a scene."""
    return passing(*model)


def fit_turned(model: tuple[Scene, Candidate, Fit]) -> Fit:
    """Fit a candidate on top of a second effect, on a scene, and then both; the candidate first."""
    scene, candidate, second = model
    given = second.change(scene)
    first = polish(scene, fit_plainly((scene, candidate, given)), given)
    found = refine(scene, both(second, first))
    return replace(found, candidates=found.candidates[::-1], parameters=found.parameters[::-1])


def fit_jointly(model: tuple[Scene, Fit]) -> Fit:
    """Fit the effects of a scene together, from where they are."""
    return refine(*model)


def fit_in_forms(model: tuple[Scene, Fit, Change]) -> Fit:
    """Give a fit other forms, on a scene, on top of a change that stays."""
    return polish(*model)


def fit_plainly(model: tuple[Scene, Candidate, Change]) -> Fit:
    """Fit a candidate from its starts, on a scene, on top of a change that stays."""
    scene, candidate, given = model
    taken = list(candidate.taken_up(scene))
    starts = [np.array(start, dtype=float) for start in candidate.starts(scene, given)]
    for start in starts:
        start[taken] = 0.0
    return fit(scene, [candidate], [start.tolist() for start in starts if start.any()], given)
