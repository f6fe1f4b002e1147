"""What a search comes to: the finding, its gaps, and the evidence for a verdict."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from skiplatch.arrays import BoolArray
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.likelihood import affected
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.leftover import STREAMS
from skiplatch.diagnosis.plays.outliers import gone_with, outliers
from skiplatch.diagnosis.plays.playing import Folds, Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.confirm import Confirmation
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.instead import instead
from skiplatch.diagnosis.verdict.accidents import fall_to_either_side, may_be_accidents
from skiplatch.diagnosis.verdict.chance import chance_of, is_chancy
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.gains import nats_of, shares_gained
from skiplatch.diagnosis.verdict.gap_rules import shrinks_for_certain
from skiplatch.diagnosis.verdict.guilty import without_guilty
from skiplatch.diagnosis.verdict.hidden import Hidden, could_hide
from skiplatch.diagnosis.verdict.named import Named, is_vague, named, open_sizes
from skiplatch.diagnosis.verdict.rules import EXPLAINS, NAMES, Rule
from skiplatch.diagnosis.verdict.shrink import Gap, PlayedRigs
from skiplatch.diagnosis.verdict.undoing import undoing
from skiplatch.diagnosis.verdict.verdict import Verdict, decide, failures, shows_too_little
from skiplatch.diagnosis.verdict.wandering import beyond_wandering
from skiplatch.diagnosis.verdict.work import Work, mattering
from skiplatch.simulator.effects import Effect


@dataclass(frozen=True, slots=True, eq=False)
class Conclusion:
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

    @property
    def accidents(self) -> Sequence[int]:
        """The outliers, if they are not too many for accidents, nor anything tells which."""
        seen = self.evidence
        are = may_be_accidents(seen.outlying, seen.touches, told=seen.outlying_with)
        return self.outliers if are else []


def concluded(work: Work, truth: Sequence[Effect] | None) -> Conclusion:
    """Search a campaign for effects and judge what is found, beside the true ones if known."""
    found = _found(work, truth)
    if found.finding.model is None:
        return found
    found = _that_explains(work, found, truth)
    is_nothing = bool(failures(NAMES, found.evidence)) and not work.is_noticed
    if is_nothing or _is_of_outliers(work, found):
        return _conclusion(work, Finding(None), None, truth)
    return found


def _is_of_outliers(work: Work, found: Conclusion) -> bool:
    """Tell whether touches far off alone are what something was found by.

    They are far off the plays of what was found; or, where no gap is seen to shrink, off those of
    the beliefs, and to either side: what comes late is off to one, and so is what one cause has.
    """
    model = found.finding.model
    likely = model.ids if model else ()
    if found.outliers and not work.without(found.outliers).finds_any(likely):
        return True
    if shrinks_for_certain(found.evidence):
        return False
    far = _accidents_of_beliefs(work)
    return bool(far and failures(NAMES, _found(work.without(far), None).evidence))


def _accidents_of_beliefs(work: Work) -> Sequence[int]:
    """Give the touches far off the plays of the beliefs, if these may be accidents."""
    far = outliers(work.scene, work.rig(None), work.materiality, seed=work.seed)
    number = len(far.touches)
    if not fall_to_either_side(number, far.beyond):
        return ()
    told = gone_with(work.scene, far.touches, seed=work.seed)
    return far.touches if may_be_accidents(number, len(work.scene), told=told) else ()


def _found(work: Work, truth: Sequence[Effect] | None) -> Conclusion:
    """Search; what cannot be named gives way to what comes near it, or is taken out.

    Either is worth it only if the rest then can be named. What was taken out is searched for anew
    once: what comes of that only gives way.
    """
    finding, confirmed = work.search()
    searches_on = True
    whole = found = _conclusion(work, finding, confirmed, truth)
    while failures(NAMES, found.evidence):
        if (rival := _rival(work, found, NAMES, truth)) is not None:
            return rival
        noticed = work.noticed if searches_on else None
        kept = without_guilty(work.judge, found.finding, found.evidence, noticed)
        if kept is None:
            return whole
        searches_on = False
        found = _conclusion(work, *work.confirmed(kept), truth)
    return found


def _that_explains(work: Work, found: Conclusion, truth: Sequence[Effect] | None) -> Conclusion:
    """Let what leaves something give way to what comes near it and leaves nothing.

    Where much is shifted, the likelihood hardly tells slack from a scatter that is there; plays do.
    """
    seen = found.evidence
    if not seen.is_held_out or decide(seen)[0] is not Verdict.PARTLY_EXPLAINED:
        return found
    return _rival(work, found, (*NAMES, *EXPLAINS), truth) or found


def _rival(
    work: Work, found: Conclusion, rules: Sequence[Rule], truth: Sequence[Effect] | None
) -> Conclusion | None:
    """Give what comes near a finding and keeps some rules, if anything does."""
    for other in instead(found.finding, work.judge):
        rival = _conclusion(work, *work.standing(other), truth)
        if not failures(rules, rival.evidence):
            return rival
    return None


def _conclusion(
    work: Work,
    finding: Finding,
    confirmed: Confirmation | None,
    truth: Sequence[Effect] | None,
) -> Conclusion:
    scene, believed, before = work.scene, work.rig(None), work.before
    fit = finding.model.fit if finding.model else None
    rig = work.rig(fit)
    # One that is too small to matter is played where something is seen without it.
    known = work.rig(finding.small.fit) if finding.small and work.is_noticed else rig
    found = named(scene.with_nominal(rig.nominal), finding, work.beliefs, work.pool)
    true_rig = None if truth is None else replace(rig, effects=truth)
    far_off = outliers(scene, known, work.materiality, seed=work.seed)
    odd = far_off.touches
    # What is far off all plays says nothing of one rig or the other, nor for a finding. What tells
    # which touches are, no accident does; and too many of them are what the believed chain leaves.
    odd_with = gone_with(scene, odd, seed=work.seed)
    are_many = finding.model is None and not may_be_accidents(len(odd), len(scene))
    is_left = bool(odd_with) or are_many
    usual = ~np.isin(scene.touches.touch, [] if is_left else odd)
    seen = scene if usual.all() else scene.select(usual)
    after = before if known is believed else work.left(seen, known)

    def played(after: Rig | Folds) -> PlayedRigs:
        return PlayedRigs.of(scene, believed, after, seed=work.seed, jobs=work.jobs, truth=true_rig)

    plays = played(rig)
    everywhere = plays.gaps(usual)
    held_out = work.parts.shrinking & usual
    gap = plays.gaps(held_out) if fit else everywhere
    hidden = could_hide(scene, known, seed=work.seed)
    leaves_to_chance, told = _of_chance(work, fit, rig)
    evidence = Evidence(
        gaps=gap,
        everywhere=everywhere,
        is_chancy=leaves_to_chance,
        chance=mattering(told, work.materiality),
        before=mattering(before, work.materiality),
        after=mattering(after, work.materiality),
        hidden=min((one.relative for one in hidden.values()), default=np.inf),
        unreached=_unreached(scene, fit) if fit else frozenset(),
        effects=[one.effect.id for one in found],
        at_limit=[f"{n.effect.id}.{name}" for n in found for name in sorted(n.at_limit)],
        undoing=undoing(scene, work.settled(fit)) if fit else [],
        vague=[n.effect.id for n in found if is_vague(n)],
        open=[f"{n.effect.id}.{name}" for n in found for name in open_sizes(n)],
        is_loose=fit is not None and fit.is_loose,
        nats=_likelier(scene, held_out, believed, rig, fit) if fit else 0.0,
        gains=_gains(work, usual, rig, fit) if fit else {},
        is_confirmed=confirmed is None or confirmed.holds,
        outlying=len(odd),
        outlying_in=far_off.observables,
        outlying_with=odd_with,
        touches=len(scene),
    )
    if fit and shows_too_little(evidence):
        folds, fits = work.folds(fit)
        gap = played(folds).gaps(usual)
        nats = _likelier_in_turn(scene, usual, believed, folds, fits)
        evidence = replace(evidence, gaps=gap, nats=nats, is_held_out=False)
    if fit and _may_wander(fit, evidence):
        evidence = replace(evidence, beyond_wandering=_beyond_wandering(work, rig, fit))
    return Conclusion(finding, rig, known, found, gap, hidden, odd, evidence)


def _may_wander(fit: Fit, evidence: Evidence) -> bool:
    """Tell whether a finding may be something slow: it leaves something, or ends and explains not.

    What begins or ends is as slow as can be.
    """
    return bool(evidence.after) or (not fit.is_always and bool(failures(EXPLAINS, evidence)))


def _of_chance(work: Work, fit: Fit | None, rig: Rig) -> tuple[bool, list[Left]]:
    """Tell whether a finding leaves anything to chance, and give what tells how that fell.

    Effects answer for what they add to the beliefs that they were found with: without them a larger
    noise may be believed, in place of theirs.
    """
    if fit is None:
        return False, []
    found, believed = (work.beside(work.scene, one) for one in (rig, replace(rig, effects=())))
    return is_chancy(found, believed), chance_of(found, believed, fit.slack, work.pool)


def _unreached(scene: Scene, fit: Fit) -> frozenset[str]:
    """Name the streams that the effects of a finding leave as they are."""
    return frozenset().union(*STREAMS.values()) - affected(scene, fit.change(scene))


def _gains(work: Work, rows: BoolArray, rig: Rig, fit: Fit) -> Mapping[str, float]:
    rigs, settled = (work.rig(None), rig), work.settled(fit)
    shares = shares_gained(work.scene, rows, rigs, settled, seed=work.seed)
    if all(share == 1.0 for share in shares.values()):
        return shares
    # Plays of less noise than the record has are told better: that is no fault of an effect's.
    noisy = rigs[0], work.as_noisy(rig, settled)
    return shares_gained(work.scene, rows, noisy, settled, seed=work.seed)


def _beyond_wandering(work: Work, rig: Rig, fit: Fit) -> Mapping[str, float]:
    return beyond_wandering(work.scene.with_nominal(rig.nominal), work.settled(fit))


def _likelier(scene: Scene, rows: BoolArray, believed: Rig, rig: Rig, fit: Fit) -> float:
    """Give the nats by which touches are likelier under a finding than without it."""
    if not rows.any():
        return 0.0
    part = scene.select(rows)
    return nats_of(part, rig, fit) - nats_of(part, believed, None)


def _likelier_in_turn(
    scene: Scene, rows: BoolArray, believed: Rig, folds: Folds, fits: Sequence[Fit]
) -> float:
    """Give the same of touches that the others judge: the mean of the likelihood's ratios.

    A mean of such ratios means the same as one of them (Wasserman, Ramdas and Balakrishnan, eq. 7).
    """
    pairs = zip(folds.rigs, fits, strict=True)
    nats = [
        _likelier(scene, rows & (folds.fold == i), believed, rig, fit)
        for i, (rig, fit) in enumerate(pairs)
    ]
    return float(scipy.special.logsumexp(nats) - np.log(len(nats)))
