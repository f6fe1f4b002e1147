"""Which models the recorded columns cannot tell apart: campaigns of one are fitted with another."""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import BoolArray
from skiplatch.diagnosis.fit.fit import Fit, fit
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import replayed
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.side_by_side import side_by_side

MOST_FITTED = 400
"""Touches of a campaign that models are fitted to, to see whether they come apart."""
HOPELESS = 100.0
"""Nats behind, beyond which neither a fit nor another campaign changes the answer."""


@dataclass(frozen=True, slots=True, eq=False)
class Separation:
    """How far a rival is from a model, in nats over all touches that served the naming."""

    rival: Scored
    expected: float
    """Mean over campaigns played with the model."""
    recorded: float

    @property
    def is_told(self) -> bool:
        """The rival should have lost, and has."""
        return min(self.expected, self.recorded) >= TIED


def inseparable(
    scene: Scene,
    rows: BoolArray,
    best: Scored,
    rivals: Sequence[Scored],
    rig: Rig,
    *,
    seed: int,
    executor: Executor | None = None,
) -> list[Separation]:
    """Tell for each rival whether it would lose to the best model if that one were the truth.

    Args:
        scene: The touches.
        rows: Those that served the naming; shape (n,).
        best: The model.
        rivals: Others.
        rig: The one that it says it is.
        seed: Of the campaigns that are played.
        executor: Fits side by side.
    """
    if not rivals:
        return []
    chosen = _some(rows, seed)
    scale = float(rows.sum()) / len(chosen)
    campaigns = replayed(scene, chosen, rig, seed=seed)
    behind = _behind(campaigns, best, rivals, scale, executor)
    return [
        Separation(rival, nats, best.score - rival.score)
        for rival, nats in zip(rivals, behind, strict=True)
    ]


def _some(rows: BoolArray, seed: int) -> "np.ndarray[tuple[int], np.dtype[np.intp]]":
    chosen = np.flatnonzero(rows)
    if len(chosen) > MOST_FITTED:
        rng = np.random.default_rng(seed)
        chosen = np.sort(rng.choice(chosen, MOST_FITTED, replace=False))
    return chosen


def _behind(
    campaigns: Sequence[Scene],
    best: Scored,
    rivals: Sequence[Scored],
    scale: float,
    executor: Executor | None,
) -> list[float]:
    """Mean nats by which each rival, fitted anew, falls behind, over all that served the naming."""
    behind: list[list[float]] = [[] for _ in rivals]
    for campaign in campaigns:
        is_open = [i for i, nats in enumerate(behind) if not _is_settled(nats)]
        own = likelihood(campaign, _without_slack(best.fit).change(campaign)).total
        tasks = [(campaign, rivals[i].fit, own, scale) for i in is_open]
        told = side_by_side(executor, _falls_behind, tasks)
        for i, nats in zip(is_open, told, strict=True):
            behind[i].append(nats)
    return [float(np.mean(nats)) for nats in behind]


def _is_settled(nats: Sequence[float]) -> bool:
    """Tell whether no further campaign is likely to change the answer.

    The difference of two log-likelihoods varies about its mean by the root of twice the mean.
    """
    if not nats:
        return False
    mean = float(np.mean(nats))
    error = np.sqrt(2.0 * max(mean, TIED) / len(nats))
    return abs(mean - TIED) > 2.0 * float(error)


def _falls_behind(task: tuple[Scene, Fit, float, float]) -> float:
    """Give the nats that one model misses, fitted anew where that can matter."""
    campaign, model, own, scale = task
    model = _without_slack(model)
    nats = _scaled(own - likelihood(campaign, model.change(campaign)).total, scale, model.size)
    if nats < TIED or nats > HOPELESS:
        return nats
    start = np.concatenate(model.parameters).tolist()
    anew = fit(campaign, model.candidates, [start], widenings=(0.0,))
    return _scaled(own - likelihood(campaign, anew.change(campaign)).total, scale, anew.size)


def _without_slack(model: Fit) -> Fit:
    """The simulation has just the form of the effect, and no slack."""
    return replace(model, slack=0.0)


def _scaled(nats: float, scale: float, parameters: int) -> float:
    """Carry nats over to more touches; what a fit gains by chance does not grow with them."""
    by_chance = parameters / 2.0
    return (nats + by_chance) * scale - by_chance
