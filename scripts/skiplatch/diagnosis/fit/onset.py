"""When an effect begins or ends, if it does not act all the time."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

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
PURE = 1.0 / 3.0
"""Share of the campaign, at either end, in which an effect may act throughout or not at all."""


def ends_of(scene: Scene) -> list[Scene]:
    """Give the first and the last touches, in which what begins or ends may act throughout."""
    count = int(PURE * len(scene))
    order = np.argsort(scene.touches.touch, kind="stable")
    chosen = (np.sort(order[:count]), np.sort(order[len(order) - count :]))
    return [scene.select(rows) for rows in chosen] if count >= FEWEST else []


def proposed(scene: Scene, fits: Iterable[Fit]) -> list[Fit]:
    """Let effects begin or end as they are, at the best of a few touches; the likeliest ones.

    Their form is left open: what fits a few touches just so is off at others. So is the datum where
    they act, for that of these touches is what they were fitted beside.
    """
    few = [_few(spans) for begins in (True, False) if (spans := _spans(scene, begins=begins))]
    moved = {span: _moved(scene, span) for spans in few for span in spans}
    loose = [replace(found, slack=SLACKS[-1]) for found in fits]

    def nats(one: Fit) -> float:
        return _nats(moved[one.candidates[0].span], one)

    roughly = [
        max((_within(found, span) for span in spans), key=nats)
        for found in (*fits, *loose)
        for spans in few
    ]
    best: dict[tuple[str, bool], Fit] = {}
    for one in sorted(roughly, key=lambda one: -nats(one)):
        (acting,) = one.candidates
        best.setdefault((acting.id, acting.span.since is None), one)
    return list(best.values())[:KEPT]


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


def _spans(scene: Scene, *, begins: bool) -> list[Span]:
    """Give the spans that an effect may have, in order; none on too few touches."""
    numbers = np.unique(scene.touches.touch).tolist()
    firsts = range(FEWEST, len(numbers) - FEWEST)
    return [Span(since=numbers[i]) if begins else Span(until=numbers[i - 1]) for i in firsts]


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
    """Give the touches with a datum of their own where a span begins or ends."""
    cut = span.until + 1 if span.until is not None else span.since
    return scene if cut is None else scene.with_datum_moved(cut)


def _cut(scene: Scene, found: Fit) -> Fit:
    """Find the span in which the effect acts: ever closer about the best of a few."""
    spans = _spans(scene, begins=found.candidates[0].span.since is not None)
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
