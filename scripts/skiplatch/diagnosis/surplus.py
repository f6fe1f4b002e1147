"""Whether a second effect is needed: played with the first alone, a campaign may seem to have it.

The surrogate of an effect is not its simulation, and what it lacks another effect may make up for.
"""

from concurrent.futures import Executor

import numpy as np

from skiplatch.diagnosis.confirm import AsEffects
from skiplatch.diagnosis.decide import Finding, only
from skiplatch.diagnosis.judge import PLAIN, Judge, worth
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.replay import replayed
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import Fit, anew

PLAINLY_NEEDED = 100.0
"""Nats of a second effect that no surrogate lacks."""


def without_surplus(
    judge: Judge,
    finding: Finding,
    as_effects: AsEffects,
    *,
    seed: int,
    executor: Executor | None = None,
) -> Finding:
    """Drop the second effect unless it gains clearly more than where there is none.

    Args:
        judge: Fits and scores on the campaign.
        finding: As the surrogates propose it.
        as_effects: Gives a fit as the simulator takes it.
        seed: Of the campaigns that are played with one effect.
        executor: Fits side by side.
    """
    pair = finding.model
    if pair is None or len(pair.ids) == 1:
        return finding
    single = max((judge.again(pair.fit, i) for i in (0, 1)), key=lambda scored: scored.score)
    gained = pair.score - single.score
    if gained > PLAINLY_NEEDED:
        return finding
    campaigns = replayed(judge.scene, judge.parts.naming, as_effects(single.fit), seed)
    tasks = [(campaign, single.fit, pair.fit) for campaign in campaigns]
    by_nature = executor.map(_gain, tasks) if executor else map(_gain, tasks)
    return finding if gained > max(by_nature) + PLAIN else only(judge, single)


def _gain(task: tuple[Scene, Fit, Fit]) -> float:
    """Give by how much a pair, fitted anew, scores better than one of its effects."""
    campaign, single, pair = task
    pair_anew = anew(campaign, pair.candidates, [np.concatenate(pair.parameters)])
    position = pair.candidates.index(single.candidates[0])
    # What the pair finds has to be open to the single one: a sharp peak is easily missed.
    starts = [single.parameters[0], pair_anew.parameters[position]]
    single_anew = anew(campaign, single.candidates, starts)
    return _score(campaign, pair_anew) - _score(campaign, single_anew)


def _score(campaign: Scene, model: Fit) -> float:
    return likelihood(campaign, model.change(campaign)).total - worth(model.size)
