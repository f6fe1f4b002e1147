"""Which of several effects keep a finding from being named.

What one effect leaves speaks against that one, and not against the others: these stand or fall by
themselves.
"""

from collections.abc import Iterable, Iterator, Mapping

from skiplatch.diagnosis.plays.leftover import STREAMS, streams_of
from skiplatch.diagnosis.search.anew import beyond, found_without, reduced
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Noticed, Scored
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.gap_rules import growing, too_wide
from skiplatch.diagnosis.verdict.mostly import mostly_left
from skiplatch.diagnosis.verdict.rules import gains_too_little, told_of_chance, wandering

SHOWN_IN: Mapping[str, frozenset[str]] = {
    "deviation_um": frozenset((*STREAMS["position"], *STREAMS["latch"])),
    "deviation_beyond_stamp_um": frozenset(STREAMS["position"]),
    "edge_after_contact_us": frozenset(STREAMS["edge"]),
    "latch_after_edge_us": frozenset(STREAMS["latch"]),
    "latch_after_contact_us": frozenset(STREAMS["latch"]),
    "latch_off_scan_grid_us": frozenset(STREAMS["grid"]),
    "report_after_latch_us": frozenset(STREAMS["report"]),
}
"""Streams of the likelihood that show what a gap is of."""


def without_guilty(
    judge: Judge, finding: Finding, evidence: Evidence, noticed: Noticed | None
) -> Finding | None:
    """Take out the effects that speak against a finding themselves.

    They are those that gain too little; or no more than anything slow would; or that are at a
    limit; or that may be almost anything; or that undo each other; or that scatter where their
    chance can be told, or where the record does so far less; or that change anything at all where
    much of what there was is left; or the one that is missed least, of those that change what a gap
    grows in. Where one scatters so, whatever else scatters there would stand for the same, and hide
    what does not.

    Args:
        judge: Fits what is left of the finding anew.
        finding: Of one effect or more.
        evidence: For and against it.
        noticed: Where a model leaves something, to search on without those; None for no search.

    Returns:
        The others, with what is found beside them then; None where it is no effect, or all of them.
    """
    model = finding.model
    if model is None:
        return None
    scattered = _scattered(evidence)
    hiding = set(_scattering(judge, finding.ranking, scattered)) if noticed else set()
    are_scattered = [bool(judge.scatters(model, i) & scattered) for i in range(len(model.ids))]
    for guilty in _accused(judge, model, evidence):
        if 0 < len(guilty) < len(model.ids):
            left_out = {model.ids[i] for i in guilty}
            if all(are_scattered[i] for i in guilty):
                left_out |= hiding
            for i in reversed(guilty):
                model = judge.again_without(model, i)
            return beyond(judge, model, left_out, noticed) if noticed else reduced(judge, model)
    if noticed and all(are_scattered):
        return found_without(judge, {*model.ids, *hiding}, noticed)
    return None


def _scattering(judge: Judge, tried: Iterable[Scored], streams: frozenset[str]) -> Iterator[str]:
    """Name the effects, of those that were tried last, that leave more to chance in streams."""
    for one in tried:
        if judge.scatters(one, len(one.ids) - 1) & streams:
            yield one.ids[-1]


def _scattered(evidence: Evidence) -> frozenset[str]:
    """Name the streams in which an effect stands for something that does not scatter."""
    told = map(streams_of, told_of_chance(evidence))
    return frozenset().union(*told, *(SHOWN_IN[name] for name in too_wide(evidence)))


def _accused(judge: Judge, model: Scored, evidence: Evidence) -> Iterator[list[int]]:
    """Number the effects of a model that are accused, for one reason after the other."""
    slow_or_small = gains_too_little(evidence), wandering(evidence)
    for ids in (*slow_or_small, evidence.effects_at_limit, evidence.vague, evidence.undoing):
        yield [i for i, name in enumerate(model.ids) if name in ids]
    for streams, acts in (
        (map(streams_of, told_of_chance(evidence)), judge.scatters),
        ((SHOWN_IN[name] for name in too_wide(evidence)), judge.scatters),
        (map(streams_of, mostly_left(evidence)), judge.reaches),
    ):
        there = frozenset[str]().union(*streams)
        yield [i for i in range(len(model.ids)) if acts(model, i) & there]
    there = frozenset[str]().union(*(SHOWN_IN[name] for name in growing(evidence)))
    acting = [i for i in range(len(model.ids)) if judge.reaches(model, i) & there]
    yield sorted(acting, key=lambda i: -judge.without(model, i).score)[:1]
