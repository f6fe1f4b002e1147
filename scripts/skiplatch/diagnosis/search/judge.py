"""Models of a campaign, fitted and scored: candidates alone, and on top of others."""

from collections.abc import Sequence

import numpy as np

from skiplatch.campaign import Nominal
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.fit import WORTH_A_REFINEMENT, Fit
from skiplatch.diagnosis.fit.forms import anew
from skiplatch.diagnosis.fit.onset import gained_by_an_end, outlives_datum, parts_of, proposed
from skiplatch.diagnosis.likelihood.likelihood import affected
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.along_grid import fits_along_grid
from skiplatch.diagnosis.search.contest import Contest
from skiplatch.diagnosis.search.scored import (
    ENOUGH_FIT,
    PLAIN,
    Scored,
    falling,
    gain_of,
    without_twins,
    worth,
)
from skiplatch.diagnosis.search.tasks import (
    both,
    fit_ended,
    fit_in_forms,
    fit_jointly,
    fit_passing,
    fit_turned,
)
from skiplatch.side_by_side import side_by_side

ANY = frozenset[str]()
"""Streams, where it is not known which: each of them."""
ALSO_PASSING = 6
"""Candidates, of those that fit a part of the campaign best, that are tried as passing ones."""
REFINED_PAIRS = 4
NEARLY = 30.0
"""Nats behind the best pair up to which a pair is refined jointly."""
NEARLY_AS_MUCH = 0.5
"""Share of the best second effect's gain from which on it is as well."""


class Judge(Contest):
    """Fits and scores models on one campaign."""

    def _look_at(self, scene: Scene) -> None:
        super()._look_at(scene)
        self._reaches: dict[str, frozenset[str]] = {}
        self._on_top: dict[tuple[object, ...], list[Scored]] = {}

    def told_along_grid(self) -> list[Nominal]:
        """Give the chains with beliefs that fit beside effects that shift the grid of the scans."""
        fits = fits_along_grid(self._naming, self._candidates())
        return [self.beliefs_beside(one).nominal for one in fits]

    def may_begin(self, singles: Sequence[Scored]) -> bool:
        """Tell whether any effect, just as it is, does better if it begins or ends at a touch."""
        fits = [scored.fit for scored in without_twins(singles)[:ALSO_PASSING]]
        return gained_by_an_end(self._fitting, fits) > WORTH_A_REFINEMENT

    def _best_in(self, part: Scene, model: Scored | None = None) -> list[Fit]:
        """Fit every candidate to some touches, roughly: those that gain most there."""
        given = model.fit.change(part) if model else NOTHING
        there = self.roughly(part, model)
        gains = [gain_of(part, one, given) for one in there]
        return [there[i] for i in falling(gains)[:ALSO_PASSING] if gains[i] > WORTH_A_REFINEMENT]

    def passing(self, singles: Sequence[Scored]) -> list[Scored]:
        """Candidates that begin or end within the campaign, by falling score.

        Proposed by how they fit throughout, and how they fit each third of it.
        """
        fits = [scored.fit for scored in without_twins(singles)[:ALSO_PASSING]]
        for part in parts_of(self._fitting):
            fits += self._best_in(part)
        # Where one acts, another may do better, which it hid in all that was fitted to more.
        for one in proposed(self._fitting, fits)[:1]:
            span = one.candidates[0].span
            fits += self._best_in(self._fitting.select(span.holds(self._fitting.touches.touch)))
        tasks = [(self._fitting, one) for one in proposed(self._fitting, fits)]
        # One that gains less than a lasting effect is none.
        lasting = max((scored.fitted for scored in singles), default=0.0)
        scored = map(self.score, self._in_forms(self._each(fit_passing, tasks), beside=lasting))
        return self._with_twins(one for one in scored if self._is_no_datum(one))

    def _is_no_datum(self, scored: Scored) -> bool:
        """Tell whether an effect that begins is more than a surface that was moved then."""
        nats = sum(outlives_datum(part, scored.fit) for part in (self._fitting, self._checking))
        return nats - worth(scored.fit.size) > PLAIN

    def pairs(self, first: Scored, streams: frozenset[str] = ANY) -> list[Scored]:
        """A model with every other effect: one by one on top of it, the best then jointly.

        Args:
            first: The model.
            streams: In which something is left that the other one has to change.
        """
        on_top = without_twins(self.on_top(first, streams))
        if not on_top:
            return []
        promises = {pair: self.promise(pair) for pair in on_top}
        by_promise = sorted(on_top, key=lambda pair: -promises[pair])
        most = promises[by_promise[0]]
        least = most - max(NEARLY, (1.0 - NEARLY_AS_MUCH) * (most - first.score))
        near = [pair for pair in by_promise[:REFINED_PAIRS] if promises[pair] > least]
        return self._with_twins(self.jointly(near) + by_promise[len(near) :])

    def turned(self, pairs: Sequence[tuple[Scored, Scored]]) -> list[Scored]:
        """Fit pairs the other way round, their second effects first.

        Args:
            pairs: Each two effects, and the second one alone, with the form that it has there.
        """
        models = [(self._fitting, pair.fit.candidates[0], second.fit) for pair, second in pairs]
        return self._with_twins(map(self.score, self._each(fit_turned, models)))

    def jointly(self, models: Sequence[Scored]) -> list[Scored]:
        """Fit the effects of each model together, from where they are."""
        refined = self._each(fit_jointly, [(self._fitting, model.fit) for model in models])
        return [
            max(model, self.score(joint), key=lambda scored: scored.score)
            for model, joint in zip(models, refined, strict=True)
        ]

    def formed(self, parts: Sequence[tuple[Fit, Fit]]) -> list[Fit]:
        """Give effects, each beside others that stay as they are, the form that is best there."""
        there = self._fitting
        return self._each(fit_in_forms, [(there, one, rest.change(there)) for one, rest in parts])

    def ended(self, models: Sequence[tuple[Fit, int]]) -> list[Scored]:
        """Let one effect of each model begin or end, by its number, where that is worth it."""
        found = side_by_side(self._executor, fit_ended, [(self._fitting, *one) for one in models])
        return [self.score(one) for one in found if one is not None]

    def passing_on_top(self, model: Scored) -> list[Scored]:
        """A model with every other effect that begins or ends, by falling score.

        Proposed by how they fit each third of the campaign on top of it.
        """
        proposed: dict[str, Fit] = {}
        for part in parts_of(self._fitting):
            for one in self._best_in(part, model):
                proposed.setdefault(one.candidates[0].id, one)
        pairs = [(both(model.fit, one), len(model.ids)) for one in proposed.values()]
        return self._with_twins(self.ended(pairs))

    def on_top(self, first: Scored, streams: frozenset[str] = ANY) -> list[Scored]:
        """Every other effect on top of a model that stays as it is, by falling score."""
        key = (*first.fit.key, streams)
        if key not in self._on_top:
            given = first.fit.change(self._fitting)
            others = self._acting_in(self._others(first), streams)
            on_top = [both(first.fit, second) for second in self._contest(others, given)]
            self._on_top[key] = self._with_twins(map(self.score, on_top))
        return self._on_top[key]

    def may_gain(self, model: Scored) -> bool:
        """Tell whether any other effect may be a further one: by fits that are only to propose."""
        given = model.fit.change(self._fitting)
        fits = self.roughly(self._fitting, model)
        return any(gain_of(self._fitting, one, given) > ENOUGH_FIT for one in fits)

    def alone(self, model: Scored, position: int) -> Scored:
        """Give one effect of a model with the parameters it has there."""
        return self.score(model.fit.alone(position))

    def without(self, model: Scored, position: int) -> Scored:
        """Give a model without one of its effects, the others as they are."""
        return self.score(model.fit.without(position))

    def in_place(self, model: Scored, position: int) -> list[Scored]:
        """Give a model with others in place of one effect, which come last; by falling score.

        Only what acts where that effect does can stand in its place.
        """
        there = self._reach(model.fit.candidates[position])
        return self.on_top(self.without(model, position), there)

    def again(self, model: Fit, position: int) -> Scored:
        """Fit one effect of a model alone, from the parameters that it has there."""
        candidates, starts = (model.candidates[position],), [model.parameters[position]]
        return self.score(anew(self._fitting, candidates, starts))

    def again_without(self, model: Scored, position: int) -> Scored:
        """Fit a model without one of its effects, from where the others are."""
        left = model.fit.without(position)
        return self.score(anew(self._fitting, left.candidates, [np.concatenate(left.parameters)]))

    def _acting_in(
        self, candidates: Sequence[Candidate], streams: frozenset[str]
    ) -> list[Candidate]:
        """Keep the effects that change some of the streams."""
        if streams == ANY:
            return list(candidates)
        return [c for c in candidates if self._reach(c) & streams]

    def _reach(self, candidate: Candidate) -> frozenset[str]:
        """Name the streams that an effect can change."""
        if candidate.id not in self._reaches:
            starts = map(np.array, candidate.starts(self._fitting, NOTHING))
            changes = (candidate.change(self._fitting, start) for start in starts)
            reached = (affected(self._fitting, change) for change in changes)
            self._reaches[candidate.id] = frozenset().union(*reached)
        return self._reaches[candidate.id]
