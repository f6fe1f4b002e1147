"""When an effect begins or ends, if it does not act all the time."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.fit import FINEST, SLACKS, Fit, fit, starts_of
from skiplatch.diagnosis.fit.forms import polish
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.span import ALWAYS, Span

FEWEST = 8
"""Touches without an effect, and with it, that tell when it begins."""
CUTS = 16
"""First touches that are tried at once; then, between the best one's neighbours, as many again."""
TIMES = 2
"""How often parameters and the touch are fitted in turn: each sharpens the other."""
KEPT = 5
"""Effects that begin or end that are fitted, of all that are proposed."""
PARTS = 3
"""Of the campaign, in one of which an effect that begins or ends may act throughout."""


def parts_of(scene: Scene) -> list[Scene]:
    """Give the first touches, those between, and the last; none where each were too few."""
    order = np.argsort(scene.touches.touch, kind="stable")
    chosen = np.array_split(order, PARTS)
    is_enough = min(map(len, chosen)) >= FEWEST
    return [scene.select(np.sort(rows)) for rows in chosen] if is_enough else []


def proposed(scene: Scene, fits: Iterable[Fit]) -> list[Fit]:
    """Let effects begin or end as they are, at the best of a few touches; the likeliest ones.

    Their form is left open: what fits a few touches just so is off at others. So is the datum where
    they act, for that of these touches is what they were fitted beside.
    """
    few = [_few(spans) for begins in (True, False) if (spans := _spans(scene, begins=begins))]
    moved = cache(partial(_moved, scene))

    def nats(one: Fit) -> float:
        return _nats(moved(one.candidates[0].span), one)

    roughly = []
    for found in [form for one in fits for form in (one, replace(one, slack=SLACKS[-1]))]:
        roughly += [max((_within(found, span) for span in spans), key=nats) for spans in few]
        roughly += [_within(found, span) for span in _stretches(scene, found)]
    best: dict[str, Fit] = {}
    for one in sorted(roughly, key=lambda one: -nats(one)):
        best.setdefault(one.candidates[0].id, one)
    return list(best.values())[:KEPT]


def _stretches(scene: Scene, found: Fit) -> list[Span]:
    """Give the stretch within a campaign in which an effect gains most, if there is one.

    The largest sum of gains of touches in a row (Bentley, Communications of the ACM 27 (1984) 865).
    """
    order = np.argsort(scene.touches.touch, kind="stable")
    with_it, without = (
        likelihood(scene, change).per_touch for change in (found.change(scene), NOTHING)
    )
    sums = np.concatenate([[0.0], np.cumsum((with_it - without)[order])])
    end = int(np.argmax(sums - np.minimum.accumulate(sums)))
    begin = int(np.argmin(sums[: end + 1]))
    if min(begin, end - begin, len(order) - end) < FEWEST:
        return []
    numbers = scene.touches.touch[order]
    return [Span(since=int(numbers[begin]), until=int(numbers[end - 1]))]


def gained_by_an_end(scene: Scene, fits: Sequence[Fit]) -> float:
    """Give the nats by which the best of some effects does better if one begins or ends; 0 if none.

    Effects that last gain hardly anything, for their parameters are those of all touches.
    """
    begun = [_nats(scene, one) for one in proposed(scene, fits)]
    return max(begun) - max(_nats(scene, one) for one in fits) if begun else 0.0


def passing(scene: Scene, found: Fit) -> Fit:
    """Fit the parameters of an effect that begins or ends, and the touch, in turn.

    What it was proposed with is of other touches than those at which it acts.
    """
    found = _cut(scene, found)
    starts = _starts_there(scene, found)
    for _ in range(TIMES):
        starts = [np.concatenate(found.parameters).tolist(), *starts]
        found = _cut(scene, fit(scene, found.candidates, starts, widenings=FINEST))
        starts = []
    return found


def _starts_there(scene: Scene, found: Fit) -> list[list[float]]:
    """Give what an effect would be if there were no other touches than those at which it acts."""
    (acting,) = found.candidates
    there = scene.select(acting.span.holds(scene.touches.touch))
    lasting = replace(acting, span=ALWAYS)
    starts = starts_of(there, lasting, NOTHING)
    return [fit(there, [lasting], starts).parameters[0].tolist()] if starts else []


def polished(scene: Scene, found: Fit) -> Fit:
    """Give such a fit another form, or slack, where that is worth it; and the touch once more."""
    return _cut(scene, polish(scene, found))


def _spans(scene: Scene, *, begins: bool, beside: Span = ALWAYS) -> list[Span]:
    """Give the spans that an effect may have whose other end stays; none on too few touches."""
    numbers = np.unique(scene.touches.touch)
    there = np.flatnonzero(beside.holds(numbers))
    if begins:
        firsts = numbers[FEWEST : there[-1] - FEWEST + 1]
        return [replace(beside, since=int(one)) for one in firsts]
    lasts = numbers[there[0] + FEWEST - 1 : len(numbers) - FEWEST - 1]
    return [replace(beside, until=int(one)) for one in lasts]


def outlives_datum(scene: Scene, found: Fit) -> float:
    """Give the nats that an effect still gains where the surface may have moved as it began.

    Something was moved, then, and nothing else need have changed.
    """

    def gain(candidate: Candidate) -> float:
        moved = _moved(scene, candidate.span)
        changed = likelihood(moved, found.change(moved)).total
        return changed - likelihood(moved, NOTHING).total

    return min(map(gain, found.candidates))


def _moved(scene: Scene, span: Span) -> Scene:
    """Give the touches with a datum of their own from where a span begins, or else ends."""
    cut = span.until + 1 if span.since is None and span.until is not None else span.since
    return scene if cut is None else scene.with_datum_moved(cut)


def _cut(scene: Scene, found: Fit) -> Fit:
    """Find the span in which the effect acts: each end ever closer about the best of a few."""
    for begins in (True, False):
        span = found.candidates[0].span
        if (span.since if begins else span.until) is not None:
            other = replace(span, since=None) if begins else replace(span, until=None)
            found = _cut_at(scene, found, _spans(scene, begins=begins, beside=other))
    return found


def _cut_at(scene: Scene, found: Fit, spans: list[Span]) -> Fit:
    while len(spans) > CUTS:
        few = _few(spans)
        best = few.index(_best(scene, found, few).candidates[0].span)
        ends = few[max(best - 1, 0)], few[min(best + 1, len(few) - 1)]
        spans = spans[spans.index(ends[0]) : spans.index(ends[1]) + 1]
    return _best(scene, found, spans)


def _few(spans: Sequence[Span]) -> list[Span]:
    chosen = np.unique(np.linspace(0, len(spans) - 1, CUTS).astype(np.intp))
    return [spans[i] for i in chosen]


def _best(scene: Scene, found: Fit, spans: Iterable[Span]) -> Fit:
    return max((_within(found, span) for span in spans), key=lambda one: _nats(scene, one))


def _within(found: Fit, span: Span) -> Fit:
    return replace(found, candidates=tuple(replace(c, span=span) for c in found.candidates))


def _nats(scene: Scene, found: Fit) -> float:
    total = likelihood(scene, found.change(scene)).total
    return total if np.isfinite(total) else -np.inf
