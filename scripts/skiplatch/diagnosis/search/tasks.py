"""Fits that may run in processes of their own: functions of one argument that can travel."""

from collections.abc import Sequence
from dataclasses import replace

from skiplatch.campaign import Nominal
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.beliefs import Belief
from skiplatch.diagnosis.fit.fit import NARROWER, Fit, fit, starts_of
from skiplatch.diagnosis.fit.forms import polish, refine
from skiplatch.diagnosis.fit.onset import passing, polished
from skiplatch.diagnosis.fit.together import together
from skiplatch.diagnosis.scene.scene import Scene

ROUGH = (NARROWER,)
"""Widening of a fit that is only to propose: the first of a search, coarse to fine."""


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


def fit_together(model: tuple[Scene, Fit, Sequence[Belief]]) -> tuple[Fit, Nominal]:
    """Fit effects of a scene together with beliefs, from where both are."""
    return together(*model)


def fit_in_forms(model: tuple[Scene, Fit, Change]) -> Fit:
    """Give a fit other forms, on a scene, on top of a change that stays."""
    scene, found, given = model
    return polish(scene, found, given) if found.is_always else polished(scene, found)


def fit_plainly(model: tuple[Scene, Candidate, Change]) -> Fit:
    """Fit a candidate from its starts, on a scene, on top of a change that stays."""
    scene, candidate, given = model
    return fit(scene, [candidate], starts_of(scene, candidate, given), given)


def fit_roughly(model: tuple[Scene, Candidate, Change]) -> Fit:
    """Do the same, no closer than a proposal has to be."""
    scene, candidate, given = model
    return fit(scene, [candidate], starts_of(scene, candidate, given), given, widenings=ROUGH)
