"""The beliefs that models are held against: as they are stated, or as they fit beside a model."""

from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import TypeVar

from skiplatch.campaign import Nominal
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.belief_fit import Fitted, fit_beliefs
from skiplatch.diagnosis.fit.beliefs import Belief, uncertain, value_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.parts import Split
from skiplatch.diagnosis.search.scored import PLAIN, Scored
from skiplatch.diagnosis.search.scorer import Scorer
from skiplatch.diagnosis.search.tasks import fit_together
from skiplatch.side_by_side import side_by_side

Task = TypeVar("Task")


class Believer(Scorer):
    """Scores models against beliefs that move."""

    def __init__(
        self,
        scene: Scene,
        parts: Split,
        executor: Executor | None = None,
        materiality: Materiality = DEFAULT,
    ) -> None:
        """Begin with the beliefs as they are stated.

        Args:
            scene: The touches.
            parts: Which of them serve what.
            executor: Fits side by side.
            materiality: From which size on a change matters.
        """
        self._executor = executor
        self._believed = scene
        self.stated = scene.nominal
        """The chain as nominal.toml states it."""
        super().__init__(scene, parts, materiality)

    @property
    def _unlike_noise(self) -> list[Belief]:
        """The beliefs of other than noise."""
        return [b for b in uncertain(self._believed.nominal) if not b.is_noise]

    def beliefs_beside(self, model: Fit | None) -> Fitted:
        """Fit the beliefs, as they stand in nominal.toml, beside a model or none."""
        return self._fit_beside(model, uncertain(self._believed.nominal))

    def _each(self, task: Callable[[Task], Fit], models: Sequence[Task]) -> list[Fit]:
        """Fit models side by side."""
        return side_by_side(self._executor, task, models)

    def together(self, models: Sequence[Fit]) -> list[tuple[Fit, Nominal]]:
        """Fit each model, in the form that it has, together with beliefs of its own.

        Those of other than noise; from the ones that are held.
        """
        beliefs = self._unlike_noise
        tasks = [(self._naming, model, beliefs) for model in models]
        return side_by_side(self._executor, fit_together, tasks)

    def score_beside(self, model: Fit, nominal: Nominal) -> Scored:
        """Score a model beside beliefs of its own, as those that are held beside these."""
        there = Scorer(self._believed.with_nominal(nominal), self.parts, self.materiality)
        own = there.score(model)
        gained = self._unlikely(self.scene.nominal) - self._unlikely(nominal)
        fitted, checked = (a - b for a, b in zip(there.base, self.base, strict=True))
        return replace(own, fitted=own.fitted + fitted + gained, checked=own.checked + checked)

    def _unlikely(self, nominal: Nominal) -> float:
        """Give the nats that a chain is unlikely by, before any touch."""
        beliefs = self._unlike_noise
        return 0.5 * sum(b.uncertainties(value_of(nominal, b.key)) ** 2 for b in beliefs)

    def told_otherwise(self) -> list[Nominal]:
        """Give the chains with beliefs that fit one stream, where it plainly tells other ones.

        All beside no effect; other ones than those held now.
        """
        found: list[Nominal] = []
        for name in self._naming.streams:
            nominal = self._fit_beside(None, self._unlike_noise, {name}).nominal
            own, held = (
                likelihood(part, NOTHING, {name}).total
                for part in (self._naming.with_nominal(nominal), self._naming)
            )
            if own > held + PLAIN and nominal not in found:
                found.append(nominal)
        return found

    def _fit_beside(
        self, model: Fit | None, beliefs: Sequence[Belief], names: Collection[str] | None = None
    ) -> Fitted:
        naming = self._believed.select(self.parts.naming)
        change = model.change(naming) if model else NOTHING
        return fit_beliefs(naming, change, beliefs, self.scene.nominal, names)

    def believe_beside(self, model: Fit | None) -> None:
        """Hold models from now on against the chain with the beliefs that fit beside one.

        What a belief takes up would else be found as an effect of its own. Noise stays as believed:
        it would take up any gap.
        """
        self.believe(self._fit_beside(model, self._unlike_noise).nominal)

    def believe(self, nominal: Nominal) -> None:
        """Hold models from now on against a chain."""
        if nominal != self.scene.nominal:
            self._look_at(self._believed.with_nominal(nominal))
