"""A contest of effects on one campaign: which may act there, and which of them fit best."""

from collections.abc import Collection, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import cached_property

from skiplatch.diagnosis.candidates.applicable import acts
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.fit.fit import WORTH_A_REFINEMENT, Fit
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.believer import Believer
from skiplatch.diagnosis.search.parts import Split
from skiplatch.diagnosis.search.scored import Scored, falling, gain_of
from skiplatch.diagnosis.search.tasks import fit_in_forms, fit_plainly, fit_roughly

CONTENDS = 0.4
"""Share of the best gain from which on other forms of an effect are tried."""
MOST_POLISHED = 6
"""Candidates of a contest that are fitted in other forms."""


class Contest(Believer):
    """Fits every effect that a campaign can show, alone or on top of others that stay."""

    def __init__(
        self,
        scene: Scene,
        parts: Split,
        executor: Executor | None = None,
        materiality: Materiality = DEFAULT,
    ) -> None:
        """Prepare to fit models.

        Args:
            scene: The touches.
            parts: Which of them serve what.
            executor: Fits side by side.
            materiality: From which size on a change matters.
        """
        self._left_out: set[str] = set()
        super().__init__(scene, parts, executor, materiality)

    def _look_at(self, scene: Scene) -> None:
        super()._look_at(scene)
        self.__dict__.pop("_applicable", None)

    def leave_out(self, ids: Collection[str]) -> None:
        """Try some effects no more."""
        self._left_out.update(ids)
        self._look_at(self._believed)

    def take_back(self, ids: Collection[str]) -> None:
        """Try them again."""
        self._left_out.difference_update(ids)
        self._look_at(self._believed)

    def singles(self, ids: Collection[str] | None = None) -> list[Scored]:
        """Every candidate, or some effects and what does the same, alone; by falling score."""
        wanted = {c.change for c in self._applicable if ids is None or c.id in ids}
        tried = [c for c in self._candidates() if c.change in wanted]
        return self._with_twins(map(self.score, self._contest(tried, NOTHING)))

    def roughly(self, part: Scene, model: Scored | None = None) -> list[Fit]:
        """Fit every candidate to some touches, no closer than need be; alone, or on top of others.

        The others are a model that stays as it is; it has none of these.
        """
        others = self._others(model) if model else self._candidates()
        given = model.fit.change(part) if model else NOTHING
        return self._each(fit_roughly, [(part, one, given) for one in others])

    def plain(self) -> list[Fit]:
        """Fit every candidate alone to all touches that serve it, no closer than need be."""
        return self.roughly(self._fitting)

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

    @cached_property
    def _applicable(self) -> list[Candidate]:
        """Give the effects that the campaign can show."""
        some = (c for c in catalogue().values() if c.id not in self._left_out)
        return [c for c in some if acts(c.id, self.scene) and c.applies(self.scene)]

    def _others(self, model: Scored) -> list[Candidate]:
        """Give the effects that a model does not have, nor any that does just the same."""
        twins = {twin.ids[i] for i in range(len(model.ids)) for twin in self.twins(model, i)}
        return [c for c in self._candidates() if c.id not in {*model.ids, *twins}]

    def _candidates(self) -> list[Candidate]:
        """Give the effects that have to be fitted: one of those that do just the same."""
        return list({c.change: c for c in reversed(self._applicable)}.values())[::-1]
