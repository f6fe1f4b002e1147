"""The diagnosis of a campaign: where the gap lies, what causes it, how far it shrinks."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from skiplatch.arrays import BoolArray
from skiplatch.campaign import Campaign
from skiplatch.campaign.plausibility import oddities
from skiplatch.diagnosis.as_effects import as_effects
from skiplatch.diagnosis.axes import idle
from skiplatch.diagnosis.beliefs import Belief, fit_beliefs, uncertain, value_of
from skiplatch.diagnosis.believed import scene_of
from skiplatch.diagnosis.chance import chance_of
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.confirm import Confirmation, settle
from skiplatch.diagnosis.decide import Finding, find
from skiplatch.diagnosis.directions import UNDIRECTED
from skiplatch.diagnosis.guilty import without_guilty
from skiplatch.diagnosis.hidden import Hidden, could_hide
from skiplatch.diagnosis.intervals import estimates, settled
from skiplatch.diagnosis.judge import FOLDS, Judge, Scored, Split, folds, split
from skiplatch.diagnosis.leftover import (
    NOTICED,
    Beside,
    left_over,
    noticed,
)
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.look import Left, Memo
from skiplatch.diagnosis.material import DEFAULT, Materiality
from skiplatch.diagnosis.notes import first_touch, notes
from skiplatch.diagnosis.outliers import outliers
from skiplatch.diagnosis.playing import FittedDatum, Folds, Rig
from skiplatch.diagnosis.reliability import reliability
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import Fit
from skiplatch.diagnosis.shrink import Gap, shrink
from skiplatch.diagnosis.surplus import without_surplus
from skiplatch.diagnosis.verdict import (
    CHANCE,
    Evidence,
    Failure,
    Verdict,
    decide,
    may_be_accidents,
    shows_too_little,
)
from skiplatch.diagnosis.where import Place, places
from skiplatch.simulator import Effect, Parameter, effects
from skiplatch.span import Span

MOST_OF_RANGE = 0.9
"""Share of a range that an interval leaves open, from which on it tells nothing."""
MOST_TOUCHES = 4_000
"""Touches that the search looks at; a larger campaign is drawn from."""


@dataclass(frozen=True, slots=True)
class Named:
    """An effect that was found."""

    effect: Effect
    stage: str
    intervals: Mapping[str, tuple[float, float]]
    """Of 90 %, the other parameters being as open."""
    alternatives: tuple[str, ...]
    confidence: float
    at_limit: frozenset[str] = frozenset()
    """Parameters at an end of their range."""
    when: str = ""
    """Since or until which touch it acts, in words; empty for one that always does."""
    idle: frozenset[str] = frozenset()
    """Parameters by which no touch of the campaign differs."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """A model that was tried: its effects, and how much better than no effect it does."""

    effects: tuple[Effect, ...]
    score_nats: float
    """Gain in log-likelihood, less what so many parameters gain by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """All that is said of a campaign."""

    verdict: Verdict
    where: Sequence[Place]
    effects: Sequence[Named]
    gap: Mapping[str, Gap]
    ranking: Sequence[Ranked]
    """The models tried last, by falling score."""
    rivals: Sequence[Ranked]
    """What the recorded columns do not tell from the finding, which is the first; may be empty."""
    left: Sequence[Left]
    """What no effect of the catalogue accounts for, if it is significant and matters."""
    touches: int
    used: int
    """Touches that the search looked at."""
    notes: Sequence[str]
    """What the campaign does not allow to say."""
    believed: Rig
    """The rig as it was believed to be, but for its datum and the uncertainty of the beliefs."""
    rig: Rig
    """The rig with the effects named."""
    materiality: Materiality = DEFAULT
    """From which size on a gap was one."""
    beliefs: Sequence[tuple[Belief, float]] = ()
    """Beliefs that were fitted, and their values now."""
    outliers: Sequence[int] = ()
    """Serial numbers of touches that are far off what the finding plays."""
    failures: Sequence[Failure] = ()
    """The rules that candidates failed, and by how much."""


def diagnose(
    campaign: Campaign,
    *,
    seed: int,
    jobs: int = 1,
    materiality: Materiality = DEFAULT,
    truth: Sequence[Effect] | None = None,
) -> Diagnosis:
    """Diagnose a recorded campaign; what is not material is no gap.

    Args:
        campaign: What was recorded.
        seed: Of the split of the touches, and of the plays.
        jobs: Processes and threads; the result does not depend on it.
        materiality: From which size on a gap is one.
        truth: The effects of a simulated campaign, for an oracle beside the shrink.
    """
    whole = scene_of(campaign)
    scene = _drawn(whole, seed)
    executor = ProcessPoolExecutor(jobs) if jobs > 1 else nullcontext()
    with executor as pool:
        work = _Work(scene, pool, seed, jobs, materiality)
        found = _concluded(work, truth)
    odd = [oddity.line for oddity in oddities(campaign)]
    if not whole.is_directed:
        odd.append(UNDIRECTED)
    odd += first_touch(campaign)
    return replace(found, touches=len(whole), notes=[*odd, *found.notes])


def _drawn(scene: Scene, seed: int) -> Scene:
    """Draw touches from a large campaign, in order of time."""
    if len(scene) <= MOST_TOUCHES:
        return scene
    rows = np.random.default_rng(seed).choice(len(scene), MOST_TOUCHES, replace=False)
    return scene.select(np.sort(rows))


class _Work:
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
        self.judge: Judge | None = None
        self._memo: Memo = {}
        self._rigs: dict[tuple[object, ...], Rig] = {}
        self._besides: dict[tuple[int, int], tuple[Scene, Rig, Beside]] = {}
        self._noticed: dict[tuple[object, ...], frozenset[str]] = {}

    def without(self, outliers: Sequence[int]) -> "_Work":
        """Give the same campaign without touches, by serial number, that nothing can play."""
        scene = self.scene.select(~np.isin(self.scene.touches.touch, outliers))
        return _Work(scene, self.pool, self.seed, self.jobs, self.materiality)

    def rig(self, fit: Fit | None) -> Rig:
        """Give the rig that a hypothesis says it is, by all touches that serve the naming.

        The beliefs are fitted last: they are to make up for no parameter.
        """
        key = fit.key if fit else ()
        if key not in self._rigs:
            self._rigs[key] = self._fitted_rig(fit, self.naming)
        return self._rigs[key]

    def folds(self, fit: Fit) -> Folds:
        """Give rigs that a hypothesis says it is, each by all touches but those that it plays."""
        fold = folds(len(self.scene), self.seed)
        others = [self.scene.select(fold != i) for i in range(FOLDS)]
        return Folds([self._fitted_rig(fit, part) for part in others], fold)

    def _fitted_rig(self, fit: Fit | None, scene: Scene) -> Rig:
        change = fit.change(scene) if fit else Change()
        nominal = fit_beliefs(scene, change, self.beliefs).nominal
        if fit:
            # Parameters would make up for beliefs that are off, and these then for parameters.
            moved = scene.with_nominal(nominal)
            fit = settled(moved, fit)
            change = fit.change(moved)
            nominal = fit_beliefs(scene, change, self.beliefs).nominal
        datum = FittedDatum.of(scene.with_nominal(nominal), change)
        return Rig(nominal, as_effects(fit) if fit else (), datum)

    def left(self, scene: Scene, rig: Rig) -> list[Left]:
        """Look for what a rig leaves of touches."""
        believed = self.beside(scene, self.rig(None))
        return left_over(self.beside(scene, rig), self._memo, believed)

    def beside(self, scene: Scene, rig: Rig) -> Beside:
        """Play a rig beside touches; all of them and the believed rig are looked at again."""
        key = id(scene), id(rig)
        if key in self._besides:
            return self._besides[key][-1]
        beside = Beside.of(scene, rig, seed=self.seed, jobs=self.jobs)
        if scene is self.scene or rig is self.rig(None):
            self._besides[key] = scene, rig, beside
        return beside

    def noticed(self, model: Scored) -> frozenset[str]:
        """Name the streams in which a hypothesis leaves what is worth a search."""
        key = model.fit.key
        if key not in self._noticed:
            left = self.left(self.naming, self.rig(model.fit))
            self._noticed[key] = noticed(left, self.materiality)
        return self._noticed[key]

    def may_begin(self, model: Scored | None) -> bool:
        """Tell whether what a hypothesis leaves may have begun or ended: it is no condition's."""
        left = self._left_to_name(model)
        return any(one.goes_with_time or not one.is_predicted for one in left)

    def passes(self, model: Scored | None) -> bool:
        """Tell whether what a hypothesis leaves comes and goes, by no accident."""
        return any(one.goes_with_time and one.z > CHANCE for one in self._left_to_name(model))

    def _left_to_name(self, model: Scored | None) -> list[Left]:
        left = self.left(self.naming, self.rig(model.fit)) if model else self.before
        return [one for one in left if one.z > NOTICED and one.is_material(self.materiality)]

    @cached_property
    def before(self) -> Sequence[Left]:
        """What the believed chain leaves of all touches."""
        return self.left(self.scene, self.rig(None))

    def search(self) -> tuple[Finding, Confirmation | None]:
        """Find effects where something is noticed, and let plain simulation choose."""
        streams = noticed(self.before, self.materiality)
        if not streams:
            return Finding(None), None
        self.judge = Judge(self.scene, self.parts, self.pool, self.materiality, streams)
        finding = find(self.judge, self.noticed, self.may_begin, self.passes)
        finding = without_surplus(self.judge, finding, self.rig, seed=self.seed, executor=self.pool)
        return self.confirmed(finding)

    def confirmed(self, finding: Finding) -> tuple[Finding, Confirmation | None]:
        """Let plain simulation choose among a finding and what is near it."""
        return settle(
            self.scene,
            self.parts,
            finding,
            self.rig,
            seed=self.seed,
            jobs=self.jobs,
            executor=self.pool,
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Conclusion:
    """A finding with all that its verdict rests on."""

    finding: Finding
    rig: Rig
    known: Rig
    """The same with an effect that is too small to matter."""
    named: Sequence[Named]
    gap: Mapping[str, Gap]
    hidden: Mapping[str, Hidden]
    outliers: Sequence[int]
    evidence: Evidence


def _concluded(work: _Work, truth: Sequence[Effect] | None) -> Diagnosis:
    found = _found(work, truth)
    if found.finding.model and found.outliers:
        # They may be what it was found by: something has to be found without them as well.
        again, _ = work.without(found.outliers).search()
        if again.model is None:
            found = _conclusion(work, Finding(None), None, truth)
    return _diagnosis(work, found)


def _found(work: _Work, truth: Sequence[Effect] | None) -> "_Conclusion":
    """Search, and take out what keeps others from being named."""
    finding, confirmed = work.search()
    found = _conclusion(work, finding, confirmed, truth)
    while kept := work.judge and without_guilty(work.judge, found.finding, found.evidence):
        finding, confirmed = work.confirmed(kept)
        found = _conclusion(work, finding, confirmed, truth)
    return found


def _conclusion(
    work: _Work,
    finding: Finding,
    confirmed: Confirmation | None,
    truth: Sequence[Effect] | None,
) -> _Conclusion:
    scene, believed, before = work.scene, work.rig(None), work.before
    rig = work.rig(finding.model.fit) if finding.model else believed
    known = work.rig(finding.small.fit) if finding.small else rig
    named = _named(scene.with_nominal(rig.nominal), finding)
    true_rig = None if truth is None else replace(rig, effects=truth)
    odd = outliers(scene, known, work.materiality, seed=work.seed)
    # What is far off all plays says nothing of one rig or the other, nor for a finding. Too many to
    # be accidents are what is left of the believed chain.
    is_left = finding.model is None and not may_be_accidents(len(odd), len(scene))
    usual = ~np.isin(scene.touches.touch, [] if is_left else odd)
    seen = scene if usual.all() else scene.select(usual)
    after = before if known is believed else work.left(seen, known)

    def gaps(rows: BoolArray, after: Rig | Folds) -> Mapping[str, Gap]:
        rows = rows & usual
        return shrink(scene, rows, believed, after, seed=work.seed, jobs=work.jobs, truth=true_rig)

    everywhere = np.full(len(scene), fill_value=True)
    gap = gaps(work.parts.shrinking if finding.model else everywhere, rig)
    hidden = could_hide(scene, known, seed=work.seed)
    told: Sequence[Left] = ()
    if finding.model:
        told = chance_of(work.beside(scene, rig), work.beside(scene, believed))
    evidence = Evidence(
        gaps=gap,
        chance=_mattering(told, work.materiality),
        before=_mattering(before, work.materiality),
        after=_mattering(after, work.materiality),
        hidden=min((one.relative for one in hidden.values()), default=np.inf),
        effects=[one.effect.id for one in named],
        at_limit=[f"{n.effect.id}.{name}" for n in named for name in sorted(n.at_limit)],
        open=[f"{n.effect.id}.{name}" for n in named for name in _open(n)],
        is_loose=finding.model is not None and finding.model.fit.is_loose,
        nats=_likelier(scene, work.parts.shrinking & usual, believed, rig, finding),
        is_confirmed=confirmed is None or confirmed.holds,
        false=int(scene.false.sum()),
        outlying=len(odd),
        touches=len(scene),
    )
    if finding.model and shows_too_little(evidence):
        gap = gaps(everywhere, work.folds(finding.model.fit))
        evidence = replace(evidence, gaps=gap, is_held_out=False)
    return _Conclusion(finding, rig, known, named, gap, hidden, odd, evidence)


def _likelier(scene: Scene, rows: BoolArray, believed: Rig, rig: Rig, finding: Finding) -> float:
    """Give the nats by which touches are likelier under a finding than without it."""
    if finding.model is None or not rows.any():
        return 0.0
    part = scene.select(rows)
    found = part.with_nominal(rig.nominal)
    with_it = likelihood(found, finding.model.fit.change(found)).total
    return with_it - likelihood(part.with_nominal(believed.nominal), Change()).total


def _diagnosis(work: _Work, found: _Conclusion) -> Diagnosis:
    scene, evidence, finding = work.scene, found.evidence, found.finding
    believed, before = work.rig(None), work.before
    verdict, failures = decide(evidence)
    is_named = verdict in (Verdict.EXPLAINED, Verdict.PARTLY_EXPLAINED)
    kept = finding if is_named else replace(finding, model=None)
    is_small = found.known is not found.rig
    remains = evidence.after if is_named or is_small else evidence.before
    left = [one for one in remains if one.is_significant]
    rig = found.rig if is_named else believed
    return Diagnosis(
        verdict=verdict,
        where=places(scene.with_nominal(rig.nominal), kept, before, left),
        effects=[_sure(one, verdict) for one in found.named] if is_named else [],
        gap={
            name: replace(gap, could_hide=found.hidden[name].size if name in found.hidden else 0.0)
            for name, gap in found.gap.items()
        },
        ranking=_ranked(finding.ranking),
        rivals=_ranked(kept.rivals),
        left=left,
        touches=len(scene),
        used=len(scene),
        notes=notes(scene, verdict, failures, evidence.before),
        believed=believed,
        rig=rig,
        materiality=work.materiality,
        beliefs=_values(work, rig),
        outliers=found.outliers if may_be_accidents(len(found.outliers), evidence.touches) else [],
        failures=failures,
    )


def _mattering(looks: Sequence[Left], materiality: Materiality) -> list[Left]:
    """Keep what is hardly an accident and large enough to matter."""
    return [one for one in looks if one.z > CHANCE and one.is_material(materiality)]


def _named(scene: Scene, finding: Finding) -> list[Named]:
    if finding.model is None:
        return []
    fit = finding.model.fit
    return [
        Named(
            effect=estimate.effect,
            stage=effects()[estimate.effect.id].stage,
            intervals=estimate.intervals,
            alternatives=finding.alternatives[i],
            confidence=finding.confidences[i],
            at_limit=_at_limit(estimate.effect),
            when=_when(scene, estimate.effect.span),
            idle=idle(scene.touches, estimate.effect),
        )
        for i, estimate in enumerate(estimates(scene, fit, as_effects(fit)))
    ]


def _when(scene: Scene, span: Span) -> str:
    """Say when an effect begins or ends: by the touch, and the time of it in the campaign."""

    def at(touch: int) -> str:
        (row,) = np.flatnonzero(scene.touches.touch == touch)[:1]
        return f"touch {touch}, at {scene.touches.time_s[row]:.6g} s"

    words = [] if span.since is None else [f"since {at(span.since)}"]
    return ", ".join(words if span.until is None else [*words, f"until {at(span.until)}"])


def _at_limit(effect: Effect) -> frozenset[str]:
    """Name the sizes that stand at an end of their range; no angle does, none, or all."""

    def is_end(p: Parameter) -> bool:
        value = effect.parameters[p.name]
        is_natural = value == 0.0 or p.unit == "deg" or (p.unit == "1" and value == 1.0)
        return value in (p.low, p.high) and not is_natural

    return frozenset(p.name for p in effects()[effect.id].parameters if is_end(p))


def _open(named: Named) -> list[str]:
    """Name the sizes of which the interval leaves open most of the range."""
    found = []
    for p in effects()[named.effect.id].parameters:
        low, high = named.intervals[p.name]
        if named.effect.parameters[p.name] and high - low >= MOST_OF_RANGE * (p.high - p.low):
            found.append(p.name)
    return found


def _sure(named: Named, verdict: Verdict) -> Named:
    share = reliability(verdict)
    return replace(named, confidence=named.confidence * share)


def _ranked(models: Sequence[Scored]) -> list[Ranked]:
    return [Ranked(tuple(as_effects(model.fit)), model.score) for model in models]


def _values(work: _Work, rig: Rig) -> list[tuple[Belief, float]]:
    """Give the beliefs that were fitted, where they are now."""
    said = {belief.key for belief in work.beliefs if not belief.box}
    listed = [belief for belief in work.beliefs if not (belief.box and belief.key in said)]
    return [(belief, value_of(rig.nominal, belief.key)) for belief in listed]
