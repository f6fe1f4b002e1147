"""Which effects a campaign shows: forward search, groups that cannot be told apart, strangers."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from skiplatch.diagnosis.candidates import CANDIDATES, Candidate
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.likelihood import MISSED, affected, law_under, likelihood
from skiplatch.diagnosis.scene import BoolArray, Scene
from skiplatch.diagnosis.search import NOTHING, WIDENINGS, Fit, fit

MOST_EFFECTS = 2
ENOUGH_FIT = 5.0
"""Nats that an effect has to gain, beyond what its parameters are worth."""
ENOUGH_CHECK = 1.0
"""Nats of gain on touches that it was not fitted to."""
ENOUGH_A_TOUCH = 0.005
"""Nats a touch below which a gap is not material: a shift by a tenth of the rig's own spread."""
REFINED_PAIRS = 3
FINEST = (0.0,)
SMALLEST_SHIFT = 0.2
"""Shift, root mean square over the rig's own spread, that is material."""
TIED = 3.0
"""Nats of difference that do not tell two effects apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """Which touches serve what; masks of shape (n,) that do not overlap."""

    fitting: BoolArray
    checking: BoolArray
    shrinking: BoolArray

    @property
    def naming(self) -> BoolArray:
        """Fitting and checking together."""
        return self.fitting | self.checking


def split(touches: int, seed: int) -> Split:
    """Draw half of the touches for fitting, a fifth for checking, the rest for the shrink."""
    lot = np.random.default_rng(seed).permutation(touches) / touches
    return Split(lot < 0.5, (lot >= 0.5) & (lot < 0.7), lot >= 0.7)


@dataclass(frozen=True, slots=True, eq=False)
class Scored:
    """A model with what it gains over the unchanged simulation, in nats."""

    fit: Fit
    fitted: float
    checked: float

    @property
    def score(self) -> float:
        """Gain in all, less what so many parameters gain by chance."""
        return self.fitted + self.checked - worth(self.fit.size)

    @property
    def ids(self) -> tuple[str, ...]:
        """Of its effects."""
        return tuple(candidate.id for candidate in self.fit.candidates)


def worth(parameters: int) -> float:
    """Nats that fitting so many parameters, of the best of all candidates, gains by chance."""
    return 2.0 * parameters


class Judge:
    """Fits and scores models on one campaign."""

    def __init__(self, scene: Scene, parts: Split, executor: Executor | None = None) -> None:
        self.scene = scene
        self.parts = parts
        self._fitting = scene.select(parts.fitting)
        self._checking = scene.select(parts.checking)
        self._map: Callable[..., Iterable[Fit]] = executor.map if executor else map
        self._base = [likelihood(part, Change()).total for part in (self._fitting, self._checking)]

    def score(self, model: Fit) -> Scored:
        """Score a fitted model on both parts."""
        gains = [
            likelihood(part, model.change(part)).total - base
            for part, base in zip((self._fitting, self._checking), self._base, strict=True)
        ]
        return Scored(model, *gains)

    def singles(self) -> list[Scored]:
        """Every candidate alone, by falling score."""
        models = [
            (self._fitting, [c], c.starts(self._fitting, NOTHING), NOTHING, WIDENINGS)
            for c in self._candidates()
        ]
        return self._ranked(self._map(_fit, models))

    def pairs(self, first: Scored) -> list[Scored]:
        """The first effect with every other one: one by one on top of it, the best then jointly."""
        given = first.fit.change(self._fitting)
        models = [
            (self._fitting, [c], c.starts(self._fitting, given), given, WIDENINGS)
            for c in self._candidates()
            if c.id not in first.ids
        ]
        on_top = self._ranked(_both(first.fit, second) for second in self._map(_fit, models))
        jointly = [self._refined(pair) for pair in on_top[:REFINED_PAIRS]]
        return sorted(jointly + on_top[REFINED_PAIRS:], key=lambda scored: -scored.score)

    def _refined(self, pair: Scored) -> Scored:
        start = np.concatenate(pair.fit.parameters).tolist()
        refined = fit(self._fitting, pair.fit.candidates, [start], widenings=FINEST)
        return max(pair, self.score(refined), key=lambda scored: scored.score)

    def _ranked(self, fits: Iterable[Fit]) -> list[Scored]:
        return sorted(map(self.score, fits), key=lambda scored: -scored.score)

    def _candidates(self) -> list[Candidate]:
        return [c for c in CANDIDATES.values() if c.applies(self.scene)]

    def is_enough(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether a model is worth naming over a smaller one, or over none."""
        fitted = scored.fitted - (before.fitted if before else 0.0)
        checked = scored.checked - (before.checked if before else 0.0)
        parameters = scored.fit.size - (before.fit.size if before else 0)
        touches = int(self.parts.naming.sum())
        return (
            fitted - worth(parameters) > ENOUGH_FIT
            and checked > ENOUGH_CHECK
            and (fitted + checked) / touches > ENOUGH_A_TOUCH
            and is_material(self._fitting, scored.fit, len(before.ids) if before else 0)
        )


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """The effects that were found.

    Attributes:
        model: They and their parameters, or None for no effect.
        alternatives: For each effect, the ids that would do as well.
        confidences: For each effect, that of it or one of its alternatives being right.
        ranking: The models that were tried last, by falling score.
    """

    model: Scored | None
    alternatives: tuple[tuple[str, ...], ...] = ()
    confidences: tuple[float, ...] = ()
    ranking: tuple[Scored, ...] = ()

    @property
    def rivals(self) -> tuple[Scored, ...]:
        """The models that cannot be told from the best one, which is the first of them."""
        if self.model is None:
            return ()
        others = [s for s in self.ranking if s is not self.model]
        return (self.model, *(s for s in others if s.score > self.model.score - TIED))


def find(judge: Judge) -> Finding:
    """Search forward for one effect, then for a second one."""
    ranked = judge.singles()
    if not judge.is_enough(ranked[0]):
        return Finding(None, ranking=tuple(ranked))
    best, rivals = ranked[0], ranked
    pairs = judge.pairs(best)
    if judge.is_enough(pairs[0], before=best):
        second = _group(pairs, position=1)
        swapped = judge.pairs(_alone(judge, pairs[0], position=1))
        first = _group([pairs[0], *(pair for pair in swapped if pair.ids[1] != best.ids[0])], 1)
        names = (first[0], second[0])
        return Finding(pairs[0], names, (first[1], second[1]), tuple(pairs))
    group, confidence = _group(rivals, position=0)
    return Finding(best, (group,), (confidence,), tuple(ranked))


def _alone(judge: Judge, pair: Scored, position: int) -> Scored:
    """Give one effect of a pair with the parameters it has there."""
    model = pair.fit
    single = Fit((model.candidates[position],), (model.parameters[position],), model.reached)
    return judge.score(single)


def _group(ranked: Sequence[Scored], position: int) -> tuple[tuple[str, ...], float]:
    """Name the effects tied with the best of a ranking, and how sure the group is."""
    best = ranked[0]
    scores = np.array([scored.score for scored in ranked])
    weights = np.exp(scores - scores.max())
    tied = scores > scores.max() - TIED
    names = tuple(
        scored.ids[position]
        for scored, is_tied in zip(ranked[1:], tied[1:], strict=True)
        if is_tied and scored.ids[position] != best.ids[position]
    )
    return names, float(weights[tied].sum() / weights.sum())


def is_material(scene: Scene, model: Fit, position: int) -> bool:
    """Tell whether one effect of a model changes more than a small part of the rig's own spread."""
    change = model.candidates[position].change(scene, model.parameters[position])
    for name in affected(scene, change):
        if name == MISSED or name == "lattice":
            return True
        stream = scene.streams[name]
        law = law_under(scene, stream, change)
        if law.extras or not np.allclose(law.spread, stream.law.spread, rtol=SMALLEST_SHIFT):
            return True
        shift = ((law.mean - stream.law.mean) / stream.law.spread)[stream.rows]
        if np.sqrt(np.mean(shift**2)) > SMALLEST_SHIFT:
            return True
    return False


def _both(first: Fit, second: Fit) -> Fit:
    return Fit(
        first.candidates + second.candidates,
        first.parameters + second.parameters,
        first.reached | second.reached,
    )


def _fit(
    model: tuple[Scene, Sequence[Candidate], Sequence[Sequence[float]], Change, Sequence[float]],
) -> Fit:
    return fit(*model)
