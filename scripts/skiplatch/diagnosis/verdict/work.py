"""A campaign under diagnosis: its rigs, their plays, the search."""

from collections.abc import Collection, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import cached_property

import numpy as np

from skiplatch.campaign import Nominal
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.belief_fit import fit_beliefs
from skiplatch.diagnosis.fit.beliefs import Belief, uncertain
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.intervals import settled
from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.fit.together import together
from skiplatch.diagnosis.plays.left import CHANCE, Left, Memo
from skiplatch.diagnosis.plays.leftover import Beside, left_over, noticed
from skiplatch.diagnosis.plays.playing import Folds, Rig
from skiplatch.diagnosis.plays.rare import rarely_off
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.confirm import Confirmation, contenders, settle
from skiplatch.diagnosis.search.decide import Finding, find, finds_any
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import FOLDS, Split, folds, split
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.search.surplus import without_surplus
from skiplatch.side_by_side import side_by_side


class Work:
    """A campaign under diagnosis: hypotheses are fitted to one part, and seen by all touches."""

    def __init__(
        self,
        scene: Scene,
        pool: Executor | None,
        seed: int,
        jobs: int,
        materiality: Materiality,
    ) -> None:
        self.scene, self.pool, self.seed, self.jobs = scene, pool, seed, jobs
        self.materiality = materiality
        self.parts: Split = split(len(scene), seed)
        self.naming = scene.select(self.parts.naming)
        self.beliefs = uncertain(scene.nominal)
        self.judge = Judge(scene, self.parts, pool, materiality)
        self._memo: Memo = {}
        self._rigs: dict[tuple[object, ...], tuple[Rig, Fit | None]] = {}
        self._besides: dict[int, tuple[Rig, Beside]] = {}
        self._noticed: dict[tuple[object, ...], frozenset[str]] = {}

    def without(self, outliers: Sequence[int]) -> "Work":
        """Give the same campaign without touches, by serial number, that nothing can play."""
        scene = self.scene.select(~np.isin(self.scene.touches.touch, outliers))
        return Work(scene, self.pool, self.seed, self.jobs, self.materiality)

    def rig(self, fit: Fit | None) -> Rig:
        """Give the rig that a hypothesis says it is, by all touches that serve the naming.

        The beliefs are fitted last: they are to make up for no parameter.
        """
        return self._fitted(fit)[0]

    def settled(self, fit: Fit) -> Fit:
        """Give a hypothesis as it is fitted together with the beliefs of its rig."""
        return self._fitted(fit)[1] or fit

    def _fitted(self, fit: Fit | None) -> tuple[Rig, Fit | None]:
        if fit:
            self._settle([fit])
            return self._rigs[fit.key]
        if () not in self._rigs:
            nominal = fit_beliefs(self.naming, NOTHING, self.beliefs).nominal
            self._rigs[()] = self._rig_of(self.naming, nominal, None), None
        return self._rigs[()]

    def _settle(self, fits: Sequence[Fit]) -> None:
        """Fit hypotheses together with the beliefs of their rigs, those that are new."""
        new = [fit for fit in fits if fit.key not in self._rigs]
        settled = self._settled_on([(fit, self.naming) for fit in new])
        for fit, (nominal, there) in zip(new, settled, strict=True):
            self._rigs[fit.key] = self._rig_of(self.naming, nominal, there), there

    def as_noisy(self, rig: Rig, fit: Fit) -> Rig:
        """Give the rig of a hypothesis with the noise that the touches tell, however uncertain."""
        noise = [belief for belief in self.beliefs if belief.is_noise]
        there = self.naming.with_nominal(rig.nominal)
        nominal = fit_beliefs(there, fit.change(there), noise, worth_moving=0.0).nominal
        return replace(rig, nominal=nominal)

    def folds(self, fit: Fit) -> tuple[Folds, Sequence[Fit]]:
        """Give rigs that a hypothesis says it is, each by all touches but those that it plays.

        Returns:
            The rigs; and the hypothesis as it is fitted to the touches of each.
        """
        fold = folds(len(self.scene), self.seed)
        others = [self.scene.select(fold != i) for i in range(FOLDS)]
        fitted = self._settled_on([(fit, part) for part in others])
        rigs = [self._rig_of(part, *one) for part, one in zip(others, fitted, strict=True)]
        return Folds(rigs, fold), [one for _, one in fitted]

    def _rig_of(self, scene: Scene, nominal: Nominal, fit: Fit | None) -> Rig:
        believed = scene.with_nominal(nominal)
        datum = FittedDatum.of(believed, fit.change(believed) if fit else NOTHING)
        rig = Rig(nominal, as_effects(fit) if fit else (), datum)
        return rig.whose_scans_are(scene.touches, seed=self.seed)

    def _settled_on(self, tasks: Sequence[tuple[Fit, Scene]]) -> list[tuple[Nominal, Fit]]:
        """Fit beliefs and parameters of hypotheses, each to a scene."""
        alone = self.rig(None).nominal if tasks else None
        pool = self.pool if len(tasks) > 1 else None
        return side_by_side(pool, _settled_beside, [(*task, self.beliefs, alone) for task in tasks])

    def left(self, scene: Scene, rig: Rig) -> list[Left]:
        """Look for what a rig leaves of touches."""
        return left_over(self.beside(scene, rig), self._memo, self.pool)

    def _noticed_by(self, left: Sequence[Left], beside: Beside) -> frozenset[str]:
        return noticed(left, self.materiality) | rarely_off(beside, self.materiality)

    def beside(self, scene: Scene, rig: Rig) -> Beside:
        """Play a rig beside touches; all of them are looked at more than once."""
        if scene is not self.scene:
            return Beside.of(scene, rig, seed=self.seed, jobs=self.jobs)
        if id(rig) not in self._besides:
            self._besides[id(rig)] = rig, Beside.of(scene, rig, seed=self.seed, jobs=self.jobs)
        return self._besides[id(rig)][1]

    @cached_property
    def is_noticed(self) -> bool:
        """Something stands out of what the believed chain plays, whatever it may be."""
        return bool(self.noticed(None))

    def noticed(self, model: Scored | None) -> frozenset[str]:
        """Name the streams in which a hypothesis, or none, leaves what is worth a search."""
        if model is None:
            return self._noticed_by(self.before, self.beside(self.scene, self.rig(None)))
        key = model.fit.key
        if key not in self._noticed:
            beside = self.beside(self.naming, self.rig(model.fit))
            left = left_over(beside, self._memo, self.pool)
            self._noticed[key] = self._noticed_by(left, beside)
        return self._noticed[key]

    @cached_property
    def before(self) -> Sequence[Left]:
        """What the believed chain leaves of all touches."""
        return self.left(self.scene, self.rig(None))

    def search(self) -> tuple[Finding, Confirmation | None]:
        """Find effects, and let plain simulation choose among what is near."""
        finding = find(self.judge, self.noticed)
        finding = without_surplus(self.judge, finding, self.rig, seed=self.seed, executor=self.pool)
        return self.confirmed(finding)

    def finds_any(self, likely: Collection[str]) -> bool:
        """Tell whether a search would begin with any effect, the likely ones tried first."""
        return finds_any(self.judge, self.noticed, likely)

    def standing(self, finding: Finding) -> tuple[Finding, Confirmation | None]:
        """Play a finding without the models near it: it stays."""
        model = finding.model
        alone = replace(finding, ranking=(model,) if model else ())
        _, confirmation = self.confirmed(alone)
        return finding, confirmation

    def confirmed(self, finding: Finding) -> tuple[Finding, Confirmation | None]:
        """Let plain simulation choose among a finding and what is near it."""
        self._settle([model.fit for model in contenders(finding)])
        return settle(
            self.scene,
            self.parts,
            finding,
            self.rig,
            seed=self.seed,
            jobs=self.jobs,
            executor=self.pool,
        )


def _settled_beside(
    task: tuple[Fit, Scene, Sequence[Belief], Nominal | None],
) -> tuple[Nominal, Fit]:
    """Fit beliefs and parameters of a hypothesis to a scene.

    Args:
        task: The hypothesis, the scene, the beliefs, and the chain with these fitted beside none.
    """
    fit, scene, beliefs, alone = task
    nominal = fit_beliefs(scene, fit.change(scene), beliefs, alone).nominal
    # Parameters would make up for beliefs that are off, and these then for parameters.
    unlike_noise = [belief for belief in beliefs if not belief.is_noise]
    if unlike_noise:
        fit, nominal = together(scene.with_nominal(nominal), fit, unlike_noise)
        nominal = fit_beliefs(scene, fit.change(scene), beliefs, nominal).nominal
    moved = scene.with_nominal(nominal)
    fit = settled(moved, fit)
    return fit_beliefs(scene, fit.change(moved), beliefs, nominal).nominal, fit


def mattering(looks: Sequence[Left], materiality: Materiality) -> list[Left]:
    """Keep what is hardly an accident and large enough to matter."""
    return [one for one in looks if one.z > CHANCE and one.is_material(materiality)]
