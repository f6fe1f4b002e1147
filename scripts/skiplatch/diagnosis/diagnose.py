"""The diagnosis of a campaign: where the gap lies, what causes it, how far it shrinks."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import Campaign, InputPath
from skiplatch.diagnosis.as_effects import as_effects
from skiplatch.diagnosis.beliefs import Belief, Fitted, fit_beliefs, uncertain
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.confirm import Confirmation, settle
from skiplatch.diagnosis.decide import Finding, find
from skiplatch.diagnosis.hidden import could_hide
from skiplatch.diagnosis.intervals import estimates
from skiplatch.diagnosis.judge import Judge, Scored, Split, split
from skiplatch.diagnosis.leftover import left_over, noticed
from skiplatch.diagnosis.look import Left, Memo
from skiplatch.diagnosis.material import DEFAULT, Materiality
from skiplatch.diagnosis.outliers import outliers
from skiplatch.diagnosis.playing import FittedDatum, Rig
from skiplatch.diagnosis.reliability import reliability
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import Fit
from skiplatch.diagnosis.shrink import Gap, shrink
from skiplatch.diagnosis.surplus import without_surplus
from skiplatch.diagnosis.verdict import CHANCE, Evidence, Failure, Verdict, decide
from skiplatch.diagnosis.where import Place, places
from skiplatch.simulator import Effect, effects

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
    whole = Scene.of(campaign)
    scene = _drawn(whole, seed)
    executor = ProcessPoolExecutor(jobs) if jobs > 1 else nullcontext()
    with executor as pool:
        work = _Work(scene, pool, seed, jobs, materiality)
        return replace(_concluded(work, truth), touches=len(whole))


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
        self._memo: Memo = {}

    def fitted(self, fit: Fit | None) -> Fitted:
        """Fit the beliefs along with a hypothesis, on the touches that serve the naming."""
        change = fit.change(self.naming) if fit else Change()
        return fit_beliefs(self.naming, change, self.beliefs)

    def rig(self, fit: Fit | None) -> Rig:
        """Give the rig that a hypothesis says it is."""
        nominal = self.fitted(fit).nominal
        change = fit.change(self.naming) if fit else Change()
        datum = FittedDatum.of(self.naming.with_nominal(nominal), change)
        return Rig(nominal, as_effects(fit) if fit else (), datum)

    def left(self, scene: Scene, rig: Rig) -> list[Left]:
        """Look for what a rig leaves of touches."""
        return left_over(scene, rig, seed=self.seed, jobs=self.jobs, memo=self._memo)

    def noticed(self, model: Scored) -> frozenset[str]:
        """Name the streams in which a hypothesis leaves what is worth a search."""
        return noticed(self.left(self.naming, self.rig(model.fit)), self.materiality)

    def search(self, before: Sequence[Left]) -> tuple[Finding, Confirmation | None]:
        """Find effects where something is noticed, and let plain simulation choose."""
        streams = noticed(before, self.materiality)
        if not streams:
            return Finding(None), None
        judge = Judge(self.scene, self.parts, self.pool, self.materiality, streams)
        finding = find(judge, self.noticed)
        finding = without_surplus(judge, finding, self.rig, seed=self.seed, executor=self.pool)
        return settle(
            self.scene,
            self.parts,
            finding,
            self.rig,
            seed=self.seed,
            jobs=self.jobs,
            executor=self.pool,
        )


def _concluded(work: _Work, truth: Sequence[Effect] | None) -> Diagnosis:
    scene, parts = work.scene, work.parts
    believed = work.rig(None)
    before = work.left(scene, believed)
    finding, confirmed = work.search(before)
    rig = work.rig(finding.model.fit) if finding.model else believed
    known = work.rig(finding.small.fit) if finding.small else rig
    after = before if known is believed else work.left(scene, known)
    named = _named(scene.with_nominal(rig.nominal), finding)
    held_out = parts.shrinking if finding.model else np.full(len(scene), fill_value=True)
    gap = shrink(
        scene,
        held_out,
        believed,
        rig,
        seed=work.seed,
        jobs=work.jobs,
        truth=None if truth is None else replace(rig, effects=truth),
    )
    hidden = could_hide(scene, known, seed=work.seed)
    evidence = Evidence(
        gaps=gap,
        believed=before,
        before=_mattering(before, work.materiality),
        after=_mattering(after, work.materiality),
        hidden=min((one.relative for one in hidden.values()), default=np.inf),
        effects=[one.effect.id for one in named],
        at_limit=[f"{n.effect.id}.{name}" for n in named for name in sorted(n.at_limit)],
        open=[f"{n.effect.id}.{name}" for n in named for name in _open(n)],
        is_loose=finding.model is not None and finding.model.fit.is_loose,
        is_confirmed=confirmed is None or confirmed.holds,
        false=int(scene.false.sum()),
    )
    verdict, failures = decide(evidence)
    is_named = verdict in (Verdict.EXPLAINED, Verdict.PARTLY_EXPLAINED)
    kept = finding if is_named else replace(finding, model=None)
    remains = evidence.after if is_named or known is not rig else evidence.before
    left = [one for one in remains if one.is_significant]
    return Diagnosis(
        verdict=verdict,
        where=places(scene, kept, before, left),
        effects=[_sure(one, verdict) for one in named] if is_named else [],
        gap={
            n: replace(g, could_hide=hidden[n].size if n in hidden else 0.0) for n, g in gap.items()
        },
        ranking=_ranked(finding.ranking),
        rivals=_ranked(kept.rivals),
        left=left,
        touches=len(scene),
        used=len(scene),
        notes=_notes(work, verdict, failures, before),
        materiality=work.materiality,
        believed=believed,
        rig=rig if is_named else believed,
        beliefs=_values(work, rig if is_named else believed),
        outliers=outliers(scene, known, seed=work.seed),
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
        )
        for i, estimate in enumerate(estimates(scene, fit, as_effects(fit)))
    ]


def _at_limit(effect: Effect) -> frozenset[str]:
    """Name the sizes that stand at an end of their range; what is 0, or an angle, is at no limit."""
    return frozenset(
        p.name
        for p in effects()[effect.id].parameters
        if p.unit not in ("deg", "")
        and effect.parameters[p.name] in (p.low, p.high)
        and effect.parameters[p.name] != 0.0
    )


def _open(named: Named) -> list[str]:
    """Name the sizes of which the interval leaves open most of the range, or whether they are any."""
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

    def now(belief: Belief) -> float:
        section, name = belief.key
        return float(getattr(getattr(rig.nominal, section), name))

    return [(belief, now(belief)) for belief in work.beliefs]


def _notes(
    work: _Work, verdict: Verdict, failures: Sequence[Failure], before: Sequence[Left]
) -> list[str]:
    scene = work.scene
    notes: list[str] = []
    if verdict is Verdict.UNKNOWN and _mattering(before, work.materiality):
        first = _mattering(before, work.materiality)[0]
        notes.append(
            f"What it looks like: {first.observable}, {first.path} path: {first.looks_like}."
        )
    if verdict is not Verdict.EXPLAINED:
        notes += [f"Not explained: {failure.words}." for failure in failures]
    for path in InputPath:
        if not (scene.touches.path == path).any():
            name = path.name.lower()
            notes.append(f"No touches on the {name} path: nothing can be said of it.")
    if not scene.has_stamps.any():
        notes.append("No time stamps: what shifts time and what shifts length look alike.")
    notes += _untold(scene)
    return notes


def _untold(scene: Scene) -> list[str]:
    """Say what the touches cannot tell, for want of variety."""
    touches = scene.touches
    notes: list[str] = []
    if not scene.is_machine:
        return notes
    if len(np.unique(touches.feed_mm_min)) == 1:
        notes.append("One feed: a delay and a length look alike; touch at a second feed.")
    for axis in np.unique(touches.axis):
        senses = np.unique(scene.sign[touches.axis == axis])
        if len(senses) == 1:
            notes.append(
                "One sense of motion on an axis: backlash cannot be seen; touch from the other side."
            )
            break
    return notes
