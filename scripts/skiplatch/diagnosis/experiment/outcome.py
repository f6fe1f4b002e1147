"""What the touches of an experiment say of the models that it was to tell apart."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from skiplatch.campaign import Campaign
from skiplatch.diagnosis.decide import TIED
from skiplatch.diagnosis.experiment.rivals import Model
from skiplatch.diagnosis.law import FloatArray
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import SLACKS, WORTH_A_REFINEMENT, WORST, Fit
from skiplatch.diagnosis.simulated import catalogue

MOST_TOUCHES = 2_000
"""Touches of the first campaign that the parameters are held to."""
EVALUATIONS = 80  # a parameter
ROUNDS = 2
"""Climbs one after the other: the second begins with a simplex of full size again."""


@dataclass(frozen=True, slots=True)
class Standing:
    """How a model stands after the experiment."""

    model: Model
    behind_nats: float
    """By so much it expects the new touches less than the best model does; 0 for that one."""

    @property
    def is_left(self) -> bool:
        """Whether the new touches leave it possible."""
        return self.behind_nats < TIED


def outcome(campaign: Campaign, further: Campaign, models: Sequence[Model]) -> list[Standing]:
    """Hold models against the touches of an experiment, the best one first.

    The first campaign could not tell them apart, so only what the new touches add counts: the
    log-likelihood of both, with the parameters that suit both, less that of the first alone.

    Args:
        campaign: What was diagnosed.
        further: The touches that were made since, as a campaign of its own.
        models: What the diagnosis left; see `rivals`.
    """
    old, new = _some(Scene.of(campaign)), Scene.of(further)
    added = [_added(old, new, model) for model in models]
    best = max(added)
    standings = [Standing(m, best - nats) for m, nats in zip(models, added, strict=True)]
    return sorted(standings, key=lambda standing: standing.behind_nats)


def _some(scene: Scene) -> Scene:
    """Draw touches from a large campaign, in order of time."""
    if len(scene) <= MOST_TOUCHES:
        return scene
    rows = np.random.default_rng(0).choice(len(scene), MOST_TOUCHES, replace=False)
    return scene.select(np.sort(rows))


def _added(old: Scene, new: Scene, model: Model) -> float:
    """Give what the new touches add to a model's log-likelihood."""
    before = _best([old], _fit(model))
    both = _best([old, new], before)
    return _total([old, new], both) - _total([old], before)


def _fit(model: Model) -> Fit:
    candidates = tuple(catalogue()[effect.id] for effect in model)
    parameters = tuple(
        np.array([effect.parameters[name] for name in candidate.names])
        for effect, candidate in zip(model, candidates, strict=True)
    )
    return Fit(candidates, parameters, frozenset())


def _best(scenes: Sequence[Scene], model: Fit) -> Fit:
    """Climb to the parameters that suit all scenes; what is 0 stays so.

    No real effect has just the form that is fitted: slack is tried as well.
    """
    loose = [replace(model, slack=slack) for slack in (0.0, *SLACKS)]
    worth = [_total(scenes, m) - WORTH_A_REFINEMENT * (m.slack > 0.0) for m in loose]
    found = loose[int(np.argmax(worth))]
    if any(candidate.exact for candidate in model.candidates):
        return found
    for _ in range(ROUNDS):
        found = _climb(scenes, found)
    return found


def _climb(scenes: Sequence[Scene], model: Fit) -> Fit:
    start = np.concatenate(model.parameters)
    free = np.flatnonzero(start)
    ends = np.cumsum([len(values) for values in model.parameters])[:-1]

    def moved(values: FloatArray) -> Fit:
        point = start.copy()
        point[free] = values
        return replace(model, parameters=tuple(np.split(point, ends)))

    steps = np.vstack([np.zeros(len(free)), np.diag(0.1 * np.abs(start[free]))])
    found = optimize.minimize(
        lambda values: -_total(scenes, moved(values)),
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


def _total(scenes: Sequence[Scene], model: Fit) -> float:
    total = sum(likelihood(scene, model.change(scene)).total for scene in scenes)
    return total if np.isfinite(total) else -WORST
