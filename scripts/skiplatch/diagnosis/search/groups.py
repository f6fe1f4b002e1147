"""Effects that cannot be told from each other, and how sure such a group is."""

from collections.abc import Iterable, Sequence

import numpy as np

from skiplatch.diagnosis.search.scored import Scored

TEMPER = 0.5
"""How far differences in nats are believed: no real effect has just the form that is fitted."""
TIED = 6.0
"""Nats of difference that do not tell two effects apart: tempered, one in twenty."""


def ranked_group(ranked: Sequence[Scored], position: int) -> tuple[tuple[str, ...], float]:
    """Name the effects tied with that of the best model, the first one, at its position."""
    own = ranked[0].ids[position]
    return group_of(own, [(scored.ids[position], scored.score) for scored in ranked])


def group_of(own: str, tried: Iterable[tuple[str, float]]) -> tuple[tuple[str, ...], float]:
    """Name the effects tied with one, and how sure the group is.

    Args:
        own: The effect.
        tried: It and those tried in its place, with the scores of the models; some more than once.
    """
    scores: dict[str, float] = {}
    for name, score in sorted(tried, key=lambda one: -one[1]):
        scores.setdefault(name, score)
    below = {name: min(score - scores[own], 0.0) for name, score in scores.items()}
    tied = [name for name, nats in below.items() if nats > -TIED]
    weights = {name: float(np.exp(TEMPER * nats)) for name, nats in below.items()}
    confidence = sum(weights[name] for name in tied) / sum(weights.values())
    return tuple(name for name in tied if name != own), confidence
