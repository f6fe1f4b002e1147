"""What tells values of touches: a forest of all that is known of them, or one thing by rank."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, compress
from operator import attrgetter

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.scene.covariates import PAIRED

TREES = 60
LEAF = 5
"""Touches in a leaf, at least."""
NAMED = 3
"""Covariates that are named at most."""
FEWEST = 8
"""Touches from which on anything can be seen."""
FEWEST_HAPPENED = 5
"""Touches to which something happened, or not, from which on it is told to which."""
FEWEST_LEVELS = 3
"""Values of a condition from which on it says more than its order."""
TOUCHES_A_LEVEL = 3
"""In the mean, from which on its values are few."""
SMALLEST = 1e-4


def told_by_forest(
    columns: Mapping[str, FloatArray], targets: FloatArray, seed: int
) -> tuple[FloatArray, tuple[str, ...]]:
    """Predict targets, shape (m,) or (m, k), from columns, and name what that goes by most."""
    from sklearn.ensemble import RandomForestRegressor  # type: ignore[import-untyped]

    forest = RandomForestRegressor(
        TREES,
        min_samples_leaf=LEAF,
        max_features=1.0 / 3.0,
        oob_score=True,
        random_state=seed,
    ).fit(np.column_stack(list(columns.values())), np.squeeze(targets))
    names = list(columns)
    strongest = [names[i] for i in np.argsort(-forest.feature_importances_)]
    return np.reshape(forest.oob_prediction_, targets.shape), tuple(strongest[:NAMED])


def told_which(
    columns: Mapping[str, FloatArray], happened: BoolArray, seed: int
) -> tuple[FloatArray, tuple[str, ...], float] | None:
    """Predict to which touches something happened, shape (m,): how likely, by what, and errors.

    None where it happened to too few or too many of them, or nothing is known that tells.
    """
    n, count = len(happened), int(happened.sum())
    if not columns or not FEWEST_HAPPENED <= count <= n - FEWEST_HAPPENED:
        return None
    predicted, names = told_by_forest(columns, happened.astype(float), seed)
    if np.ptp(predicted) == 0.0:
        return None
    return predicted, names, float(np.corrcoef(predicted, happened)[0, 1] * np.sqrt(n))


@dataclass(frozen=True, slots=True, eq=False)
class Ranked:
    """The condition that goes most with a target.

    Attributes:
        chance: Of as much by accident, all that were tried counted (Bonferroni).
        names: Of the condition, or of the two that act together.
        values: What goes with the target, shape (m,): the condition, how far its ranks are off
            their middle, or the means of the target at its values, or the product of two.
    """

    chance: float
    names: tuple[str, ...]
    values: FloatArray


def told_by_one(columns: Mapping[str, FloatArray], target: FloatArray) -> list[Ranked]:
    """Find what tells a target, shape (m,), by its order, by its few values, and with another."""
    ways = best_ranked, best_levelled, best_paired
    found = [way(columns, target) for way in ways]
    return [best for best in found if best is not None]


def best_ranked(columns: Mapping[str, FloatArray], target: FloatArray) -> Ranked | None:
    """Find the column, shape (m,), with whose ranks a target goes most, straight or bent.

    None where none tells two of the touches apart that it has a value of.
    """
    alike: dict[bytes, list[str]] = {}
    for name, values in columns.items():
        alike.setdefault(np.isnan(values).tobytes(), []).append(name)
    found: list[Ranked] = []
    for names in alike.values():
        known = ~np.isnan(columns[names[0]])
        if known.sum() < FEWEST or np.ptp(target[known]) == 0.0:
            continue
        values = np.array([columns[name][known] for name in names])
        varying = np.ptp(values, axis=1) > 0.0
        if not varying.any():
            continue
        ranks = scipy.stats.rankdata(values[varying], axis=1)
        shapes = np.vstack([ranks, _bent(ranks)])
        shown = np.ptp(shapes, axis=1) > SMALLEST  # two values do not bend
        tried = compress(2 * list(compress(names, varying)), shown)
        chances = scipy.stats.pearsonr(shapes[shown], target[known][None, :], axis=1).pvalue
        for chance, name, shape in zip(chances.tolist(), tried, shapes[shown], strict=True):
            found.append(Ranked(chance, (name,), _at(known, shape)))
    return _most_telling(found)


def best_paired(columns: Mapping[str, FloatArray], target: FloatArray) -> Ranked | None:
    """Find the two conditions, shape (m,), with the product of whose ranks a target goes most.

    One may act only where the other is large, or the other way round, and neither tell by itself.
    None where less than two of them are known of all touches.
    """
    names = [name for name in PAIRED if name in columns and not np.isnan(columns[name]).any()]
    pairs = list(combinations(names, 2))
    if not pairs or len(target) < FEWEST or np.ptp(target) == 0.0:
        return None
    ranks = {name: scipy.stats.rankdata(columns[name]) for name in names}
    off = {name: values - values.mean() for name, values in ranks.items()}
    products = np.array([off[one] * off[other] for one, other in pairs])
    shown = np.ptp(products, axis=1) > SMALLEST
    if not shown.any():
        return None
    chances = scipy.stats.pearsonr(products[shown], target[None, :], axis=1).pvalue
    least = int(np.argmin(chances))
    pair = list(compress(pairs, shown))[least]
    return Ranked(float(chances[least]) * len(chances), pair, products[shown][least])


def best_levelled(columns: Mapping[str, FloatArray], target: FloatArray) -> Ranked | None:
    """Find the column, shape (m,), between whose few values a target differs most.

    By an analysis of variance, which knows no order of the values: what comes about at one feed or
    place alone is neither straight nor bent. None where no column has so few values.
    """
    found: list[Ranked] = []
    for name, values in columns.items():
        known = ~np.isnan(values)
        _, level, count = np.unique(values[known], return_inverse=True, return_counts=True)
        levels, there = len(count), target[known]
        if levels < FEWEST_LEVELS or len(there) < TOUCHES_A_LEVEL * levels:
            continue
        means = np.bincount(level, there) / count
        between = float(count @ (means - there.mean()) ** 2) / (levels - 1)
        within = float(np.sum((there - means[level]) ** 2)) / (len(there) - levels)
        chance = float(
            scipy.stats.f.sf(between / max(within, SMALLEST), levels - 1, len(there) - levels)
        )
        found.append(Ranked(chance, (name,), _at(known, means[level])))
    return _most_telling(found)


def _at(known: BoolArray, values: FloatArray) -> FloatArray:
    """Give values to the touches of a mask, shape (m,), and NaN to the others."""
    full = np.full(len(known), np.nan)
    full[known] = values
    return full


def _most_telling(found: Sequence[Ranked]) -> Ranked | None:
    """Give the best of some columns, each with its own chance, with all of them counted."""
    best = min(found, key=attrgetter("chance"), default=None)
    return None if best is None else replace(best, chance=best.chance * len(found))


def _bent(ranks: FloatArray) -> FloatArray:
    """Give how far ranks are off their middle, squared, less what goes straight; shape (k, m)."""
    off = ranks - ranks.mean(axis=1, keepdims=True)
    off /= off.std(axis=1, keepdims=True)
    squares = off**2 - 1.0
    return np.asarray(squares - off * np.mean(off * squares, axis=1, keepdims=True))
