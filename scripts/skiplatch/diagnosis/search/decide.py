"""Which effects a campaign shows: one after the other, as long as something is left.

A hypothesis is a set of effects. It is extended where it leaves something that can be seen
(`leftover`) or that the likelihood asks for, and only by an effect that gains more than chance on
other touches than it was fitted to.
Several first effects are kept open, for the best of them may be one that takes two for its scatter.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

from skiplatch.diagnosis.search.first import beside_its_beliefs, first_effects
from skiplatch.diagnosis.search.groups import TIED, group_of, ranked_group
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.reform import BETTER, reformed
from skiplatch.diagnosis.search.scored import ENOUGH_FIT, Noticed, Scored, without_twins, worth

MOST_EFFECTS = 4
PLAIN_SECOND = 0.2
"""Gain of a further effect over that of the others where it acts, from which on it is no form of
theirs; one that gains less has to explain touches that they do not reach, shift what no other form
does, or leave nothing in a stream."""
FAINTEST = 0.03
"""The same below which it is not believed beside an effect that needs slack: that much any
approximate model is off by."""
NEXT_BEST = 0.5
"""Share of the best effect's gain from which on another is tried as the first of several."""
BEAM = 2
"""First effects that are kept open."""
MOST_TURNED = 3
"""Pairs that are searched from their second effect as well."""
MOST_SWAPS = 2


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """The effects that were found.

    Attributes:
        model: They and their parameters, or None for no effect.
        alternatives: For each effect, the ids that would do as well.
        confidences: For each effect, how much of the weight of all that was tried it and they have.
        ranking: The models that were tried last, by falling score.
        small: An effect that is there, but too small to matter.
    """

    model: Scored | None
    alternatives: tuple[tuple[str, ...], ...] = ()
    confidences: tuple[float, ...] = ()
    ranking: tuple[Scored, ...] = ()
    small: Scored | None = None

    @property
    def rivals(self) -> tuple[Scored, ...]:
        """The models that cannot be told from the best one, which is the first of them."""
        if self.model is None:
            return ()
        others = [s for s in self.ranking if s is not self.model]
        return (self.model, *(s for s in others if s.score > self.model.score - TIED))


def find(judge: Judge, noticed: Noticed) -> Finding:
    """Search forward, from several first effects, for as many as the touches ask for."""
    finding = _searched(judge, noticed)
    if (model := finding.model) is None:
        return finding
    small = [name for i, name in enumerate(model.ids) if not judge.matters(model, i)]
    if not small:
        return finding
    # The likeliest may be a grid that is too fine to matter: it takes no place from what does.
    judge.leave_out(small)
    return _searched(judge, noticed)


def _searched(judge: Judge, noticed: Noticed) -> Finding:
    ranked = first_effects(judge, noticed)
    if not ranked or not judge.is_significant(ranked[0]):
        return Finding(None, ranking=tuple(ranked))
    ranked = beside_its_beliefs(judge, ranked)
    best = ranked[0]
    if not _asks_for_more(judge, best, noticed):
        return _single(judge, best, ranked)
    best, pairs = _with_second(judge, best, noticed)
    pairs, others = _from_further_on(judge, pairs, best, noticed), []
    if not pairs or judge.is_scatter(best) or noticed(pairs[0]):
        # What scatters, needs slack or leaves something may be two: the next best may be half.
        others = from_next_best(judge, ranked, best, noticed)
        if not pairs or (others and others[0].score > pairs[0].score):
            pairs, others = others, pairs
        if not pairs:
            ranked = [best, *(s for s in ranked if s.ids != best.ids)]
            return _single(judge, best, ranked)
    judge.believe_beside(pairs[0].fit)
    model, tried = judge.score(pairs[0].fit), [judge.score(one.fit) for one in (*pairs, *others)]
    return grown(judge, model, tried, noticed)


def grown(judge: Judge, model: Scored, tried: Sequence[Scored], noticed: Noticed) -> Finding:
    """Extend a model for as long as the touches ask for it; the rivals are what was tried last."""
    while len(model.ids) < MOST_EFFECTS and _asks_for_more(judge, model, noticed):
        better = reformed(judge, model)
        if better is not model:
            model = better
            continue
        further = _from_further_on(judge, _extended(judge, model, noticed), model, noticed)
        if not further:
            break
        judge.believe_beside(further[0].fit)
        model, tried = judge.score(further[0].fit), [judge.score(one.fit) for one in further]
    return several(judge, model, tried) if len(model.ids) > 1 else one_of(judge, model)


def one_of(judge: Judge, model: Scored) -> Finding:
    """Give a finding of one effect, beside all that may stand in its place."""
    return _single(judge, model, [model, *_others(model, judge.in_place(model, 0))])


def _asks_for_more(judge: Judge, model: Scored, noticed: Noticed) -> bool:
    """Tell whether a further effect is worth a search.

    Where nothing of it shows, as what comes seldom beside a larger effect, the likelihood tells.
    """
    return bool(noticed(model)) or judge.may_gain(model)


def _where(judge: Judge, model: Scored, noticed: Noticed) -> frozenset[str]:
    """Name streams of which a further effect has to change some: where a model leaves anything.

    And where an effect acts that acts there: it may make up in one for what is off in another.
    """
    left = noticed(model)
    acting = (judge.reaches(model, i) for i in range(len(model.ids)))
    return left.union(*(streams for streams in acting if streams & left))


def finds_any(judge: Judge, noticed: Noticed, likely: Collection[str]) -> bool:
    """Tell whether there is an effect, alone, that gains more than chance and matters.

    Args:
        judge: Fits and scores.
        noticed: Where a model leaves something.
        likely: Ids of effects that are tried before all others.
    """
    judge.believe_beside(None)
    tried_first = judge.singles(likely)
    return any(map(judge.is_enough, tried_first)) or any(
        map(judge.is_enough, first_effects(judge, noticed))
    )


def _single(judge: Judge, best: Scored, ranked: Sequence[Scored]) -> Finding:
    if not judge.is_material(best):
        return Finding(None, ranking=tuple(ranked), small=best)
    group, confidence = ranked_group(ranked, 0)
    return Finding(best, (group,), (confidence,), tuple(ranked))


def _with_second(judge: Judge, best: Scored, noticed: Noticed) -> tuple[Scored, list[Scored]]:
    """Extend the best effect: give it, in a better form if its pairs show one, and the pairs."""
    pairs = _pairs(judge, best, noticed)
    if not pairs:
        return best, pairs
    again = max((judge.again(pairs[0].fit, i) for i in (0, 1)), key=lambda scored: scored.score)
    if again.score > best.score + BETTER:
        return again, _pairs(judge, again, noticed) or pairs
    return best, pairs


def from_next_best(
    judge: Judge, ranked: Sequence[Scored], best: Scored, noticed: Noticed
) -> list[Scored]:
    """Give the best pairs of other first effects, if they beat the best effect; else none."""
    near = [s for s in without_twins(ranked[1:]) if s.score > NEXT_BEST * best.score]
    near = [s for s in near if s.ids[0] != best.ids[0]]
    # Scatter hides best what is none, and so does a form that is as far off as can be.
    near.sort(key=lambda single: (single.fit.is_loose, judge.is_scatter(single)))
    for first in near[: BEAM - 1]:
        pairs = _pairs(judge, first, noticed)
        if not pairs or pairs[0].score <= best.score + TIED:
            continue
        is_further = _is_further(judge, pairs[0], first, noticed)
        if is_further and _passes_in_any_order(judge, pairs[0], best, noticed):
            return pairs
    return []


def _passes_in_any_order(judge: Judge, pair: Scored, best: Scored, noticed: Noticed) -> bool:
    """Tell whether the other effect of a pair that has the best one is a further one of that."""
    if pair.ids[1] != best.ids[0]:
        return True
    fit = pair.fit
    turned = replace(fit, candidates=fit.candidates[::-1], parameters=fit.parameters[::-1])
    return _is_further(judge, judge.score(turned), best, noticed)


def _pairs(judge: Judge, best: Scored, noticed: Noticed) -> list[Scored]:
    """Search further effects of one, with and without the slack that it has alone.

    That may stand for the further one, which then gains nothing beside it, if the two need none.
    """
    streams = _where(judge, best, noticed)
    pairs = judge.pairs(best, streams)
    if best.fit.slack > 0.0:
        stiff = judge.score(replace(best.fit, slack=0.0))
        near = [*pairs[:1], *_stiff(judge.on_top(stiff, streams))]
        models = [(pair, judge.alone(pair, position=1)) for pair in near[:MOST_TURNED]]
        return _better([*pairs, *near, *judge.turned(models)])
    return pairs


def _extended(judge: Judge, model: Scored, noticed: Noticed) -> list[Scored]:
    """Search a further effect of several, with and without the slack that they have.

    That may stand for the further one, which then gains nothing beside it.
    """
    streams = _where(judge, model, noticed)
    larger = judge.pairs(model, streams)
    if model.fit.slack > 0.0:
        stiff = judge.score(replace(model.fit, slack=0.0))
        near = _stiff(judge.on_top(stiff, streams))[:MOST_TURNED]
        return _better([*larger, *judge.jointly(near)])
    return larger


def _stiff(models: Sequence[Scored]) -> list[Scored]:
    """Keep one each of those that do just the same, without slack."""
    return [model for model in without_twins(models) if model.fit.slack == 0.0]


def _better(models: Iterable[Scored]) -> list[Scored]:
    """Take the best one of each that was fitted more than once; by falling score."""
    best: dict[tuple[str, ...], Scored] = {}
    for model in sorted(models, key=lambda one: -one.score):
        best.setdefault(model.ids, model)
    return list(best.values())


def _from_further_on(
    judge: Judge, larger: Sequence[Scored], smaller: Scored, noticed: Noticed
) -> list[Scored]:
    """Give models by falling score from the first on whose last effect is one of its own.

    The likeliest may be a form of the others, which says nothing of the next. None if few are.
    """
    for i, one in enumerate(larger[:BEAM]):
        if _is_further(judge, one, smaller, noticed):
            return list(larger[i:])
    return []


def _is_further(judge: Judge, larger: Scored, smaller: Scored, noticed: Noticed) -> bool:
    """Tell whether the last effect of a model is one of its own, and no form of the others."""
    if not judge.is_enough(larger, smaller):
        return False
    if judge.is_elsewhere(larger, smaller) or judge.is_narrower(larger, smaller):
        return True
    share = judge.share(larger, smaller)
    if larger.fit.is_loose or (share < FAINTEST and smaller.fit.slack > 0.0):
        return False
    if share >= PLAIN_SECOND or judge.is_beyond_reach(larger, smaller):
        return True
    way = judge.own_way(larger)
    if way.beyond_form > ENOUGH_FIT + worth(larger.fit.size - smaller.fit.size):
        return True
    # Or a stream is explained altogether, and not by what another form does.
    is_no_form = larger.score - smaller.score - way.taken_by_form > ENOUGH_FIT
    return is_no_form and bool(noticed(smaller) - noticed(larger))


def several(judge: Judge, model: Scored, tried: Sequence[Scored]) -> Finding:
    """Settle several effects: each is searched for anew, given the others, until none changes."""
    for _ in range(MOST_SWAPS):
        in_place = [judge.in_place(model, i) for i in range(len(model.ids))]
        tried_there = [one for others in in_place for one in others]
        likely = max(tried_there, key=judge.promise, default=model)
        if likely is model or judge.promise(likely) <= model.score + BETTER:
            break
        best = judge.jointly([likely])[0]
        if best.score <= model.score + BETTER:
            break
        model = best
    else:
        in_place = [judge.in_place(model, i) for i in range(len(model.ids))]
    groups = [
        group_of(
            model.ids[i], [(model.ids[i], model.score), *((o.ids[-1], o.score) for o in others)]
        )
        for i, others in enumerate(in_place)
    ]
    names, confidences = zip(*groups, strict=True)
    ranking = [model, *_others(model, [*tried, *(one for others in in_place for one in others)])]
    return Finding(model, names, confidences, tuple(sorted(ranking, key=lambda s: -s.score)))


def _others(model: Scored, tried: Iterable[Scored]) -> list[Scored]:
    """Keep the best model of each other set of effects, by falling score."""
    best: dict[frozenset[str], Scored] = {}
    for other in sorted(tried, key=lambda other: -other.score):
        best.setdefault(frozenset(other.ids), other)
    return [other for ids, other in best.items() if ids != frozenset(model.ids)]
