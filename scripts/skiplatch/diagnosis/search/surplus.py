"""Whether each effect is needed: by the beliefs that may move, and by plays of the rig without it.

A belief that moves within its uncertainty may do what an effect does. And the surrogate of an
effect is not its simulation: played without the last effect, a campaign may seem to have it.
"""

from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.forms import anew
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.replay import begun_anywhere, replayed
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.anew import reduced
from skiplatch.diagnosis.search.confirm import AsRig
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import ENOUGH_FIT, PLAIN, Scored, worth
from skiplatch.side_by_side import side_by_side

PLAINLY_NEEDED = 100.0
"""Nats of an effect that no surrogate lacks and no belief can take up."""


def without_surplus(
    judge: Judge,
    finding: Finding,
    as_rig: AsRig,
    *,
    seed: int,
    executor: Executor | None = None,
) -> Finding:
    """Drop effects that are not needed, the least needed first.

    Args:
        judge: Fits and scores on the campaign.
        finding: As the surrogates propose it.
        as_rig: Gives the rig that a fit says it is.
        seed: Of the campaigns that are played without an effect.
        executor: Fits side by side.
    """
    while (model := finding.model) is not None:
        if len(model.ids) == 1:
            is_needed = _beyond_beliefs(judge, model, None) > ENOUGH_FIT
            return (
                finding
                if is_needed
                else replace(finding, model=None, alternatives=(), confidences=())
            )
        fewer = [judge.again_without(model, i) for i in range(len(model.ids))]
        beyond, _, least = min(
            (_beyond_beliefs(judge, model, smaller), i, smaller) for i, smaller in enumerate(fewer)
        )
        if beyond > PLAINLY_NEEDED or (
            beyond > ENOUGH_FIT
            and model.score - least.score
            > _by_nature(judge, model, least, as_rig, seed, executor) + PLAIN
        ):
            return finding
        finding = reduced(judge, least)
    return finding


def _beyond_beliefs(judge: Judge, larger: Scored, smaller: Scored | None) -> float:
    """Give the nats that a model gains over a smaller one, or none, if beliefs move in both."""
    with_it = judge.beliefs_beside(larger.fit).nats
    without = judge.beliefs_beside(smaller.fit if smaller else None).nats
    return with_it - without - worth(larger.fit.size - (smaller.fit.size if smaller else 0))


def _by_nature(
    judge: Judge,
    model: Scored,
    smaller: Scored,
    as_rig: AsRig,
    seed: int,
    executor: Executor | None,
) -> float:
    """Give the nats that a model gains over a smaller one where the smaller one is the truth."""
    scene = judge.scene
    if _binds_scans(model.fit, scene) and not _binds_scans(smaller.fit, scene):
        scene = begun_anywhere(scene, seed=seed)
    campaigns = replayed(scene, judge.parts.naming, as_rig(smaller.fit), seed=seed)
    tasks = [(campaign, smaller.fit, model.fit) for campaign in campaigns]
    return max(side_by_side(executor, _gain, tasks))


def _binds_scans(fit: Fit, scene: Scene) -> bool:
    """Tell whether effects bind touches to the scans."""
    changes = fit.change(scene).at_times(scene.touches.touch)
    return any(change.wait is not None for _, change in changes)


def _gain(task: tuple[Scene, Fit, Fit]) -> float:
    """Give by how much a model, fitted anew, scores better than one with an effect less."""
    campaign, smaller, model = task
    larger = anew(campaign, model.candidates, [np.concatenate(model.parameters)])
    kept = [model.candidates.index(candidate) for candidate in smaller.candidates]
    # What the larger one finds has to be open to the smaller one: a sharp peak is easily missed.
    starts = [
        np.concatenate(smaller.parameters),
        np.concatenate([larger.parameters[i] for i in kept]),
    ]
    return _score(campaign, larger) - _score(campaign, anew(campaign, smaller.candidates, starts))


def _score(campaign: Scene, model: Fit) -> float:
    return likelihood(campaign, model.change(campaign)).total - worth(model.size)
