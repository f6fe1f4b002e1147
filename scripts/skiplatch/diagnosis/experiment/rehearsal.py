"""An experiment rehearsed: simulated to its end, and judged as its outcome will be."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Nominal, Status, Touches
from skiplatch.diagnosis.experiment.channels import recordable
from skiplatch.diagnosis.experiment.joint import added_nats, as_fit, some, suited, total
from skiplatch.diagnosis.experiment.rivals import Model
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.playing import Outcomes

REHEARSALS = 2
"""Of an experiment, with each model as the truth: every one costs a fit of every rival."""
APART = 15.0
"""Nats that a rival has to be expected behind: the difference of two log-likelihoods varies by the
root of twice its mean, so that 19 of 20 experiments then leave more than the 6 nats of a tie."""


@dataclass(frozen=True, slots=True, eq=False)
class Rehearsal:
    """Models, and how they suit the campaign that could not tell them apart.

    Attributes:
        models: What the diagnosis left, m of them.
        old: The touches of the campaign.
        fits: The models with the parameters that suit those best.
    """

    models: Sequence[Model]
    old: Scene
    fits: Sequence[Fit]

    @classmethod
    def of(cls, campaign: Campaign, models: Sequence[Model]) -> Self:
        """Fit the models to the campaign."""
        old = some(scene_of(campaign))
        return cls(models, old, [suited([old], as_fit(model)) for model in models])

    def played(self, nominal: Nominal, plan: Touches, *, seed: int, jobs: int) -> list[Outcomes]:
        """Play a plan to its end on a rig with each model."""
        rigs = [Rig(nominal, model) for model in self.models]
        return [rig.play(plan, seed=seed, replicates=REHEARSALS, jobs=jobs) for rig in rigs]

    def groups(
        self,
        plan: Touches,
        played: Sequence[Outcomes],
        columns: frozenset[str],
        nominal: Nominal | None = None,
    ) -> NDArray[np.intp]:
        """Number the groups of models that an experiment is expected to tell apart; shape (m,).

        Rivals are fitted anew: only what no parameters can make up for counts.

        Args:
            plan: The touches of the experiment.
            played: By model, replicates of them.
            columns: Outcomes that are recorded.
            nominal: What is believed of the plan's surfaces, where that is not as of the campaign.
        """
        behind = np.zeros((len(self.models), len(self.models)))
        for truth, outcomes in enumerate(played):
            scenes = _recorded(nominal or self.old.nominal, plan, outcomes, columns)
            behind[truth] = np.mean([self._behind(new, truth) for new in scenes], axis=0)
        tied = np.minimum(behind, behind.T) < APART
        return np.asarray(
            scipy.sparse.csgraph.connected_components(tied, directed=False)[1], dtype=np.intp
        )

    def _behind(self, new: Scene, truth: int) -> FloatArray:
        """Give the nats by which each model expects new touches less than the truth; (m,)."""
        own = added_nats(self.old, new, self.fits[truth])
        return np.array([own - self._most(new, fit, own) for fit in self.fits])

    def _most(self, new: Scene, fit: Fit, own: float) -> float:
        """Give what new touches add to a model, fitted anew only where that can matter."""
        nats = total([self.old, new], fit) - total([self.old], fit)
        return added_nats(self.old, new, fit) if own - nats >= APART else nats


def _recorded(
    nominal: Nominal, plan: Touches, outcomes: Outcomes, columns: frozenset[str]
) -> list[Scene]:
    """Give the scene that each replicate would be."""
    empty = np.full(len(plan), np.nan)
    scenes = []
    for number, ok in enumerate(outcomes.ok):
        shown = {
            name: getattr(outcomes, name)[number] if name in columns else empty
            for name in recordable(nominal)
        }
        status = np.where(ok, Status.OK, Status.MISSED).astype(np.int8)
        made = replace(plan, status=status, **shown)
        scenes.append(Scene(nominal, made.in_order_of_time()))
    return scenes
