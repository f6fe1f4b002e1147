"""Parameters drawn as often as the touches bear them out, all effects together."""

from collections.abc import Sequence

import numpy as np

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.diagnosis.candidates.surrogates import SWITCHES, turn_of
from skiplatch.diagnosis.fit.weighted_samples import Cloud
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.simulator.effects import parameter_of


def samples(found: Sequence[Named], draws: int, seed: int) -> dict[str, FloatArray]:
    """Draw from the samples that the intervals are of, each as likely as any other.

    What was not sampled is drawn evenly from its interval: a switch, what the touches tie to a
    grid, and what they tell nothing of.

    Args:
        found: The effects.
        draws: How many.
        seed: Picks them.

    Returns:
        By ``effect.parameter``; of an effect that comes again, by ``effect[2].parameter``.
        Shape (1, draws), for one chain.
    """
    rng = np.random.default_rng(seed)
    rows = _resampled(found[0].cloud, draws, rng) if found else np.zeros(0, dtype=np.intp)
    drawn: dict[str, FloatArray] = {}
    seen: list[str] = []
    for one in found:
        seen.append(one.effect.id)
        again = seen.count(one.effect.id)
        called = one.effect.id if again == 1 else f"{one.effect.id}[{again}]"
        for column, name in enumerate(one.effect.parameters):
            values = _values(one, column, name, rows, rng)
            drawn[f"{called}.{name}"] = values.reshape(1, draws)
    return drawn


def _values(
    one: Named, column: int, name: str, rows: IndexArray, rng: np.random.Generator
) -> FloatArray:
    low, high = one.intervals[name]
    is_sampled = one.cloud is not None and column in one.cloud.sampled
    if one.cloud is None or not is_sampled or name in one.idle:
        if name in SWITCHES:
            return rng.integers(int(low), int(high) + 1, len(rows)).astype(np.float64)
        return rng.uniform(low, high, len(rows))
    values = one.cloud.points[rows, column]
    turn = turn_of(parameter_of(one.effect.id, name))
    return np.asarray(values % turn if turn and high - low >= turn else values)


def _resampled(cloud: Cloud | None, draws: int, rng: np.random.Generator) -> IndexArray:
    """Take points evenly along their weights, in an order that means nothing; shape (draws,)."""
    if cloud is None:
        return np.zeros(draws, dtype=np.intp)
    places = (rng.uniform() + np.arange(draws)) / draws
    taken = np.searchsorted(np.cumsum(cloud.weights), places)
    return np.asarray(rng.permutation(np.minimum(taken, len(cloud.weights) - 1)))
