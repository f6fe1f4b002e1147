"""Models of a campaign, fitted and scored: candidates alone, and on top of others."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from skiplatch.campaign import Nominal
from skiplatch.diagnosis.candidates.applicable import acts
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.fit.fit import WORTH_A_REFINEMENT, Fit
from skiplatch.diagnosis.fit.forms import anew
from skiplatch.diagnosis.fit.onset import gained_by_an_end, outlives_datum, parts_of, proposed
from skiplatch.diagnosis.likelihood.likelihood import affected
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.along_grid import fits_along_grid
from skiplatch.diagnosis.search.believer import Believer
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
    fit_in_forms,
    fit_jointly,
    fit_passing,
    fit_plainly,
    fit_roughly,
    fit_turned,
)

ANY = frozenset[str]()
"""Streams, where it is not known which: each of them."""
CONTENDS = 0.4
"""Share of the best gain from which on other forms of an effect are tried."""
MOST_POLISHED = 6
"""Candidates of a contest that are fitted in other forms."""
ALSO_PASSING = 6
"""Candidates, of those that fit a part of the campaign best, that are tried as passing ones."""
REFINED_PAIRS = 4
NEARLY = 30.0
"""Nats behind the best pair up to which a pair is refined jointly."""
NEARLY_AS_MUCH = 0.5
"""Share of the best second effect's gain from which on it is as well."""


class Judge(Believer):
    """Fits and scores models on one campaign."""

    _left_out = frozenset[str]()
    """Ids of the effects that are not tried."""

    def _look_at(self, scene: Scene) -> None:
        super()._look_at(scene)
        self._reaches: dict[str, frozenset[str]] = {}
        self._on_top: dict[tuple[object, ...], list[Scored]] = {}
        self.__dict__.pop("_applicable", None)

    def leave_out(self, ids: Collection[str]) -> None:
        """Try some effects no more."""
        self._left_out = self._left_out.union(ids)
        self._look_at(self._believed)

    def take_back(self, ids: Collection[str]) -> None:
        """Try them again."""
        self._left_out = self._left_out.difference(ids)
        self._look_at(self._believed)

    def singles(self, ids: Collection[str] | None = None) -> list[Scored]:
        """Every candidate, or some effects and what does the same, alone; by falling score."""
        wanted = {c.change for c in self._applicable if ids is None or c.id in ids}
        tried = [c for c in self._candidates() if c.change in wanted]
        return self._with_twins(map(self.score, self._contest(tried, NOTHING)))

    def roughly(self, part: Scene | None = None) -> list[Fit]:
        """Fit every candidate alone, no closer than need be, to some touches or all that serve."""
        there = self._fitting if part is None else part
        return self._each(fit_roughly, [(there, c, NOTHING) for c in self._candidates()])

    def told_along_grid(self) -> list[Nominal]:
        """Give the chains with beliefs that fit beside effects that shift the grid of the scans."""
        fits = fits_along_grid(self._naming, self._candidates())
        return [self.beliefs_beside(one).nominal for one in fits]

    def may_begin(self, singles: Sequence[Scored]) -> bool:
        """Tell whether any effect, just as it is, does better if it begins or ends at a touch."""
        fits = [scored.fit for scored in without_twins(singles)[:ALSO_PASSING]]
        return gained_by_an_end(self._fitting, fits) > WORTH_A_REFINEMENT

    def _best_in(self, part: Scene) -> list[Fit]:
        """Fit every candidate alone to some touches, roughly: those that gain most there."""
        there = self.roughly(part)
        gains = [gain_of(part, one, NOTHING) for one in there]
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

    def _contest(self, candidates: Sequence[Candidate], given: Change) -> list[Fit]:
        """Fit all candidates plainly, and those that come near the best of them in other forms."""
        fits = self._each(fit_plainly, [(self._fitting, c, given) for c in candidates])
        return self._in_forms(fits, given)

    def _in_forms(
        self, fits: Sequence[Fit], given: Change = NOTHING, beside: float = 0.0
    ) -> list[Fit]:
        """Give fits that come near the best of them, or near what else gains, other forms."""
        gains = [gain_of(self._fitting, found, given) for found in fits]
        least = max(WORTH_A_REFINEMENT, CONTENDS * max(beside, *gains, 0.0))
        near = [i for i in falling(gains)[:MOST_POLISHED] if gains[i] >= least]
        formed = self._each(fit_in_forms, [(self._fitting, fits[i], given) for i in near])
        better = dict(zip(near, formed, strict=True))
        return [better.get(i, found) for i, found in enumerate(fits)]

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
        tasks = [(self._fitting, other, given) for other in self._others(model)]
        fits = self._each(fit_roughly, tasks)
        return any(gain_of(self._fitting, one, given) > ENOUGH_FIT for one in fits)

    def twins(self, model: Scored, position: int) -> list[Scored]:
        """Give a model with other effects, that do just the same, in place of one of it."""
        own, found = model.fit.candidates[position], []
        for other in self._applicable:
            if other.change == own.change and other.id != own.id:
                candidates = list(model.fit.candidates)
                candidates[position] = replace(other, span=own.span)
                found.append(self.score(replace(model.fit, candidates=tuple(candidates))))
        return found

    def _with_twins(self, models: Iterable[Scored]) -> list[Scored]:
        """Add models with twins of the last effect; by falling score."""
        found = [twin for model in models for twin in (model, *self.twins(model, -1))]
        return sorted(found, key=lambda scored: -scored.score)

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

    @cached_property
    def _applicable(self) -> list[Candidate]:
        """Give the effects that the campaign can show."""
        some = (c for c in catalogue().values() if c.id not in self._left_out)
        return [c for c in some if acts(c.id, self.scene) and c.applies(self.scene)]

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

    def _others(self, model: Scored) -> list[Candidate]:
        """Give the effects that a model does not have, nor any that does just the same."""
        twins = {twin.ids[i] for i in range(len(model.ids)) for twin in self.twins(model, i)}
        return [c for c in self._candidates() if c.id not in {*model.ids, *twins}]

    def _candidates(self) -> list[Candidate]:
        """Give the effects that have to be fitted: one of those that do just the same."""
        return list({c.change: c for c in reversed(self._applicable)}.values())[::-1]
