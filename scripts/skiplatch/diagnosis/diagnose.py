"""The diagnosis of a campaign: where the gap lies, what causes it, how far it shrinks."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import Campaign
from skiplatch.campaign.plausibility import oddities
from skiplatch.diagnosis.as_effects import as_effects
from skiplatch.diagnosis.beliefs import Belief, value_of
from skiplatch.diagnosis.believed import scene_of
from skiplatch.diagnosis.conclude import Conclusion, concluded
from skiplatch.diagnosis.directions import UNDIRECTED
from skiplatch.diagnosis.left import Left
from skiplatch.diagnosis.material import DEFAULT, Materiality
from skiplatch.diagnosis.named import Named, sure
from skiplatch.diagnosis.notes import first_touch, notes
from skiplatch.diagnosis.playing import Rig
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.scored import Scored
from skiplatch.diagnosis.shrink import Gap
from skiplatch.diagnosis.verdict import (
    Failure,
    Verdict,
    decide,
    may_be_accidents,
)
from skiplatch.diagnosis.where import Place, places
from skiplatch.diagnosis.work import Work
from skiplatch.simulator.effects import Effect

MOST_TOUCHES = 4_000
"""Touches that the search looks at; a larger campaign is drawn from."""


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
        work = Work(scene, pool, seed, jobs, materiality)
        found = _diagnosis(work, concluded(work, truth))
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


def _diagnosis(work: Work, found: Conclusion) -> Diagnosis:
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
        effects=[sure(one, verdict) for one in found.named] if is_named else [],
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


def _ranked(models: Sequence[Scored]) -> list[Ranked]:
    return [Ranked(tuple(as_effects(model.fit)), model.score) for model in models]


def _values(work: Work, rig: Rig) -> list[tuple[Belief, float]]:
    """Give the beliefs that were fitted, where they are now."""
    said = {belief.key for belief in work.beliefs if not belief.box}
    listed = [belief for belief in work.beliefs if not (belief.box and belief.key in said)]
    return [(belief, value_of(rig.nominal, belief.key)) for belief in listed]
