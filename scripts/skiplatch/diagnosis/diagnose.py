"""The diagnosis of a campaign: where the gap lies, what causes it, how far it shrinks."""

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial

from threadpoolctl import threadpool_limits

from skiplatch.campaign import Campaign, fingerprint
from skiplatch.campaign.plausibility import oddities
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.belief_fit import WORTH_MOVING
from skiplatch.diagnosis.fit.beliefs import Belief, value_of
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.fit.directions import UNDIRECTED
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum, met_at
from skiplatch.diagnosis.reported.diagnosis import Diagnosis, Ranked
from skiplatch.diagnosis.reported.notes import first_touch, notes
from skiplatch.diagnosis.reported.wanting import MOST_TOUCHES
from skiplatch.diagnosis.reported.where import places
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.verdict.conclude import Conclusion, concluded
from skiplatch.diagnosis.verdict.named import sure
from skiplatch.diagnosis.verdict.reliability import standing
from skiplatch.diagnosis.verdict.verdict import Verdict, decide
from skiplatch.diagnosis.verdict.work import Work
from skiplatch.progress import Counted
from skiplatch.side_by_side import processes
from skiplatch.simulator.effects import Effect
from skiplatch.ways import Ways


def diagnose(
    campaign: Campaign,
    *,
    seed: int,
    jobs: int = 1,
    materiality: Materiality = DEFAULT,
    truth: Sequence[Effect] | None = None,
    is_shown: bool = False,
) -> Diagnosis:
    """Diagnose a recorded campaign; what is not material is no gap.

    Args:
        campaign: What was recorded.
        seed: Of the split of the touches, and of the plays.
        jobs: Processes and threads; the result does not depend on it.
        materiality: From which size on a gap is one.
        truth: The effects of a simulated campaign, for an oracle beside the shrink.
        is_shown: A terminal shows how much is done.
    """
    whole = scene_of(campaign)
    scene = whole.drawn(MOST_TOUCHES, seed)
    executor = processes(jobs) if jobs > 1 else nullcontext()
    counted = partial(Counted, title="diagnosing") if is_shown else nullcontext
    # Products here are small: threads that wait for them take a processor from others.
    with threadpool_limits(1), executor as started, counted(started) as pool:
        work, surface = _begun(Work(scene, pool, seed, jobs, materiality))
        found = _diagnosis(work, concluded(work, truth))
    believed, rig = (
        replace(one, datum=one.datum.beyond(surface)) for one in (found.believed, found.rig)
    )
    odd = [oddity.line for oddity in oddities(campaign)]
    if not whole.is_directed:
        odd.append(UNDIRECTED)
    odd += first_touch(campaign)
    return replace(
        found,
        believed=believed,
        rig=rig,
        touches=len(whole),
        notes=[*odd, *found.notes],
        fingerprint=campaign.fingerprint or fingerprint(campaign.touches),
    )


def _begun(work: Work) -> tuple[Work, FittedDatum]:
    """Begin with surfaces where touches without stamps say that they are, if that is all there is.

    On its ramp the axis has its speed by its way, so that a surface tells where it is by more than
    a coordinate that is off. Effects have a mean as well: these are looked for on the way believed.
    """
    scene = work.scene
    surface = FittedDatum(FittedDatum.of(scene, NOTHING).coordinate_um)
    if scene.has_stamps.any() or not surface.surface_um:
        return work, FittedDatum()
    surface_um, _ = surface.sizes_um(scene.nominal, scene.touches)
    met = replace(scene, touches=met_at(scene.touches, surface_um))
    gained = likelihood(met, NOTHING).total - likelihood(scene, NOTHING).total
    there = Work(met, work.pool, work.seed, work.jobs, work.materiality)
    is_all = gained > WORTH_MOVING and not there.is_noticed
    return (there, surface) if is_all else (work, FittedDatum())


def _diagnosis(work: Work, found: Conclusion) -> Diagnosis:
    scene, evidence, finding = work.scene, found.evidence, found.finding
    believed, before = work.rig(None), work.before
    verdict, failures = decide(evidence)
    is_named = verdict in (Verdict.EXPLAINED, Verdict.PARTLY_EXPLAINED)
    stands = standing(verdict, [failure.rule for failure in failures], len(found.named))
    kept = finding if is_named else replace(finding, model=None)
    remains = evidence.before if finding.model and not is_named else evidence.after
    left = [one for one in remains if one.is_significant]
    rig = found.rig if is_named else believed
    closest = finding.model.ids if finding.model and not is_named else ()
    return Diagnosis(
        verdict=verdict,
        where=places(scene.with_nominal(rig.nominal), kept, before, left),
        effects=[sure(one, stands) for one in found.named] if is_named else [],
        gap={
            name: replace(gap, could_hide=found.hidden[name].size if name in found.hidden else 0.0)
            for name, gap in found.gap.items()
        },
        ranking=_ranked(finding.ranking),
        rivals=_ranked(kept.rivals),
        left=left,
        touches=len(scene),
        used=len(scene),
        notes=notes(
            scene,
            verdict,
            failures,
            evidence.before,
            evidence.effects if is_named else (),
            closest,
        ),
        believed=believed,
        rig=rig,
        materiality=work.materiality,
        beliefs=_values(work, rig),
        outliers=found.accidents,
        failures=failures,
        closest=closest,
        ways=Ways.of(scene.touches),
        ways_of_paths=Ways.of_paths(scene.touches),
    )


def _ranked(models: Sequence[Scored]) -> list[Ranked]:
    return [Ranked(tuple(as_effects(model.fit)), model.score) for model in models]


def _values(work: Work, rig: Rig) -> list[tuple[Belief, float]]:
    """Give the beliefs that were fitted, where they are now."""
    said = {belief.key for belief in work.beliefs if not belief.box}
    listed = [belief for belief in work.beliefs if not (belief.box and belief.key in said)]
    return [(belief, value_of(rig.nominal, belief.key)) for belief in listed]
