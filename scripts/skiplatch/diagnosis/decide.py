"""Which effects a campaign shows: forward search, groups that cannot be told apart, strangers."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.diagnosis.judge import ENOUGH_FIT, NEARLY, PLAIN, Judge, Scored, without_twins

BETTER = 2.0
"""Nats by which a form found in a pair has to be better than the one found alone."""
PLAIN_SECOND = 0.2
"""Gain of a second effect over that of the first, whose form is never just the one fitted.

One that gains less is believed only where it mends all that the first one leaves, or goes with a
condition that the first one does not go with."""
FAINTEST_SECOND = 0.03
"""The same below which it is not believed, unless the first one's form leaves nothing: that much
any form is off."""
SMALLEST_LEFT = 0.1
"""The same of what no effect explains."""
NEXT_BEST = 0.5
"""Share of the best effect's gain from which on another is tried as the first of two."""
MOST_NEXT_BEST = 2
MOST_SWAPS = 2
MOST_TURNED = 3
"""Pairs that are searched from their second effect as well."""
MIMICRY = 0.99
"""Share of a family's gain that an effect has to reach to be named in its place."""
MAY_HIDE = 0.9
"""Share of an effect's gain from which on a family may be two effects that hide each other."""
LEFT_OVER = 1.5
"""What a family may gain on top of an effect, as a share of the effect's own gain."""
TEMPER = 0.5
"""How far differences in nats are believed: no real effect has just the form that is fitted."""
TIED = 6.0
"""Nats of difference that do not tell two effects apart: tempered, one in twenty."""


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """The effects that were found.

    Attributes:
        model: They and their parameters, or None for no effect.
        alternatives: For each effect, the ids that would do as well.
        confidences: For each effect, that of it or one of its alternatives being right.
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


def find(judge: Judge) -> Finding:
    """Search forward for one effect, then for a second one."""
    ranked = judge.singles()
    best = ranked[0]
    if not judge.is_significant(best):
        return Finding(None, ranking=tuple(ranked))
    pairs = _pairs(judge, best, ranked)
    if judge.is_scatter(best) or not _mends_all(judge, pairs[0]):
        # Scatter leaves nothing to any family; loose pairs are never believed.
        hidden = _hidden(judge, ranked, (best if pairs[0].fit.is_loose else pairs[0]).score)
        if hidden:
            return hidden
    again = max((judge.again(pairs[0].fit, i) for i in (0, 1)), key=lambda scored: scored.score)
    if again.score > best.score + BETTER:
        # The pair has shown the way to a better form of one of its effects alone.
        best = again
        ranked = [best, *(scored for scored in ranked if scored.ids != best.ids)]
        pairs = _pairs(judge, best, ranked)
    tied = (pair for pair in pairs if pair.score > pairs[0].score - TIED)
    has_second = any(_is_second(judge, pair, best) for pair in tied)
    if not judge.is_material(best):
        # What is too small to matter may still hide what is not.
        if has_second:
            return _second(judge, pairs)
        return Finding(None, ranking=tuple(ranked), small=best)
    if has_second:
        return _two(judge, pairs)
    group, confidence = _ranked_group(ranked, 0)
    return Finding(best, (group,), (confidence,), tuple(ranked))


def _pairs(judge: Judge, best: Scored, ranked: Sequence[Scored]) -> list[Scored]:
    """Search the second effects of the best one, with and without the slack that it has alone.

    That may stand for the second one, which then gains nothing beside it, if the two need none.
    """
    pairs = judge.pairs(best)
    if best.fit.slack > 0.0:
        stiff = judge.score(replace(best.fit, slack=0.0))
        near = [pair for pair in without_twins(judge.on_top(stiff)) if pair.fit.slack == 0.0]
        models = [(pair, judge.alone(pair, position=1)) for pair in near[:MOST_TURNED]]
        turned = judge.turned(models)
        pairs = _better(pairs, [pair for pair in turned if pair.fit.slack == 0.0])
    return _both_ways(judge, pairs, ranked)


def _both_ways(judge: Judge, pairs: list[Scored], ranked: Sequence[Scored]) -> list[Scored]:
    """Search the best pairs from their second effects as well, where the first one has slack.

    An effect that has to stand for two takes a form from which the way to its own may be lost.
    """
    alone = {scored.ids[0]: scored for scored in ranked}
    near = [pair for pair in without_twins(pairs) if pair.score > pairs[0].score - TIED]
    near = [pair for pair in near if pair.fit.slack > 0.0]
    near = [pair for pair in near if alone[pair.ids[1]].score > SMALLEST_LEFT * pair.score]
    turned = judge.turned([(pair, alone[pair.ids[1]]) for pair in near[:MOST_TURNED]])
    return _better(pairs, turned)


def _better(pairs: Sequence[Scored], others: Sequence[Scored]) -> list[Scored]:
    """Take the better one of each pair that was fitted twice; by falling score."""
    by_ids = {pair.ids: pair for pair in others}
    better = [max(pair, by_ids.get(pair.ids, pair), key=lambda p: p.score) for pair in pairs]
    return sorted(better, key=lambda pair: -pair.score)


def _hidden(judge: Judge, ranked: Sequence[Scored], score: float) -> Finding | None:
    """Find two effects behind one that takes what both do for scatter, or for slack of its form.

    The next best ones, each of which is mended less by itself, may do far better together. So may
    one that is nearly as good: beside it the best one may have another form than alone.

    Args:
        judge: Fits and scores.
        ranked: The effects alone, by falling score.
        score: Of what is found with the best one.
    """
    best = ranked[0]
    is_scatter = judge.is_scatter(best)
    is_mended = is_scatter or best.fit.is_loose
    least = NEXT_BEST * best.score if is_mended else best.score - NEARLY
    near = [s for s in without_twins(ranked[1:]) if least < s.score < best.score - TIED]
    if is_scatter:
        near.sort(key=judge.is_scatter)  # scatter hides best what is none
    found = []
    for first in near[:MOST_NEXT_BEST]:
        if is_scatter and best.ids[0] in judge.on_top(first)[0].ids:
            continue  # the search that begins with the best one finds this pair
        pairs = judge.pairs(first)
        is_new = is_scatter or pairs[0].fit.slack == 0.0
        is_better = pairs[0].score > score + PLAIN and judge.is_enough(pairs[0], best)
        if is_new and is_better and _is_second(judge, pairs[0], first):
            found.append(pairs)
    return _two(judge, max(found, key=lambda pairs: pairs[0].score)) if found else None


def only(judge: Judge, single: Scored) -> Finding:
    """Name one effect of the two that were found."""
    ranked = [single, *(scored for scored in judge.singles() if scored.ids != single.ids)]
    group, confidence = _ranked_group(ranked, 0)
    return Finding(single, (group,), (confidence,), tuple(ranked))


def _is_second(judge: Judge, pair: Scored, first: Scored) -> bool:
    """Tell whether the second effect of a pair is one of its own, and no form of the first."""
    if not judge.is_enough(pair, first):
        return False
    if judge.is_elsewhere(pair, first):
        # The first one may well have another form: it cannot be that of what shows elsewhere.
        return not _is_a_form(judge, pair, ENOUGH_FIT, instead_of=(1,))
    share = judge.share(pair, first)
    is_faint = share < FAINTEST_SECOND and not _mends_all(judge, first)
    if is_faint or pair.fit.is_loose:
        return False
    if _mends_all(judge, pair):
        return not _is_a_form(judge, pair, 0.0)
    is_plain = share >= PLAIN_SECOND or judge.goes_its_own_way(pair)
    return is_plain and not _is_a_form(judge, pair, -TIED)


def _mends_all(judge: Judge, model: Scored) -> bool:
    """Tell whether a model needs no slack and leaves nothing that another form could be.

    A second effect that but mends the first one's form seldom gets there.
    """
    return model.fit.slack == 0.0 and judge.generic(model.fit)[0].score <= model.score


def _is_a_form(
    judge: Judge, pair: Scored, margin: float, instead_of: Sequence[int] = (0, 1)
) -> bool:
    """Tell whether a family in place of one of the effects does better than a pair by a margin.

    One that has the first effect among its own forms does as well in its place: it has to do
    clearly better.
    """
    margins = (max(margin, ENOUGH_FIT), margin)
    return any(
        judge.generic(judge.alone(pair, 1 - position).fit)[0].score > pair.score + margins[position]
        for position in instead_of
    )


def weigh(judge: Judge, finding: Finding) -> tuple[Finding, str]:
    """Hold a finding against the families that name no effect.

    Returns:
        The finding, without a model if a family does clearly better than it, and the family that
        is left over, alone or on top of the finding; empty for none.
    """
    generic = judge.generic()
    plain = next((g for g in generic if judge.is_enough(g)), None)
    if finding.model is None:
        # An effect too small to matter explains as well what a family does with more.
        is_new = plain is not None and plain.score > finding.ranking[0].score
        return finding, plain.ids[0] if plain and is_new else ""
    score = finding.model.score
    if plain and plain.score > MAY_HIDE * score:
        is_beaten = plain.score > score + ENOUGH_FIT and score < MIMICRY * plain.score
        is_single = len(finding.model.ids) == 1
        hidden = _behind(judge, plain, score) if is_beaten or is_single else None
        if hidden or is_beaten:
            return hidden or Finding(None, ranking=finding.ranking), "" if hidden else plain.ids[0]
    on_top = _left_over(judge, finding.model)
    if on_top and on_top[0].score - score > score * LEFT_OVER:
        return Finding(None, ranking=finding.ranking), on_top[0].ids[-1]
    return finding, on_top[0].ids[-1] if on_top else ""


def _left_over(judge: Judge, model: Scored) -> list[Scored]:
    """Give the families that a model leaves something to, by falling score."""
    on_top = judge.generic(model.fit)
    return [
        g for g in on_top if judge.is_enough(g, model) and judge.share(g, model) >= SMALLEST_LEFT
    ]


def with_third(judge: Judge, finding: Finding, left_over: str) -> tuple[Finding, str]:
    """Add a third effect to two that leave something where neither of them reaches.

    There they have no form that could be mended; of what they leave elsewhere that cannot be said.

    Args:
        judge: Fits and scores.
        finding: As it was weighed.
        left_over: The family that it leaves something to; empty for none.

    Returns:
        The finding, and what it leaves now.
    """
    two = finding.model
    if two is None or len(two.ids) == 1 or not judge.is_left_elsewhere(two):
        return finding, left_over
    ranked = next((r for r in _by_streams(judge, two) if _is_third(judge, r[0], two)), None)
    if ranked is None:
        return finding, left_over
    three = judge.jointly(ranked[:1])[0]
    ranking = (three, *ranked[1:])
    # What the third one explains may have decided between the first two and others.
    groups = [_group_in_place(judge, three, position) for position in range(2)]
    names, confidences = zip(*groups, _ranked_group(ranking, 2), strict=True)
    still = _left_over(judge, three)
    return Finding(three, names, confidences, ranking), still[0].ids[-1] if still else ""


def _group_in_place(judge: Judge, model: Scored, position: int) -> tuple[tuple[str, ...], float]:
    """Name the effects tied with one of a model, the others as they are."""
    own = model.ids[position]
    tried = judge.on_top(judge.without(model, position))
    return _group(own, [(own, model.score), *((s.ids[-1], s.score) for s in tried)])


def _by_streams(judge: Judge, two: Scored) -> Iterator[list[Scored]]:
    """Give the effects on top of two, parted by the streams where they show, by falling score."""
    reached = ((model, judge.reached(model)) for model in judge.on_top(two))
    rest = [(model, where) for model, where in reached if where]
    while rest:
        there = rest[0][1]
        yield [model for model, where in rest if where & there]
        rest = [(model, where) for model, where in rest if not where & there]


def _is_third(judge: Judge, three: Scored, two: Scored) -> bool:
    """Tell whether an effect on top of two is one of its own, and no family does better there."""
    if not (judge.is_enough(three, two) and judge.is_elsewhere(three, two)):
        return False
    there = judge.reached(three)
    families = (family for family in judge.generic(two.fit) if judge.reached(family) & there)
    return all(family.score <= three.score + ENOUGH_FIT for family in families)


def _behind(judge: Judge, family: Scored, score: float) -> Finding | None:
    """Find two effects that look like a family together, each hiding what the other looks like.

    On top of the family the stronger of them shows, for the family stands for the other one. That
    two effects leave nothing, and do far better than one of them with the family, is no accident.

    Args:
        judge: Fits and scores.
        family: It does nearly as well as what was found, or better.
        score: Of what was found.
    """
    shown = judge.on_top(family)[0]
    if not judge.is_enough(shown, family):
        return None
    first = judge.alone(shown, position=1)
    pairs = judge.pairs(first)
    best = pairs[0]
    is_better = best.score > max(shown.score, score) + PLAIN and judge.is_enough(best, first)
    return _two(judge, pairs) if is_better and _mends_all(judge, best) else None


def _second(judge: Judge, pairs: list[Scored]) -> Finding:
    """Name only the second effect of the best pair."""
    alone = judge.alone(pairs[0], position=1)
    group, confidence = _ranked_group(pairs, 1)
    return Finding(alone, (group,), (confidence,), tuple(pairs))


def _two(judge: Judge, pairs: list[Scored]) -> Finding:
    """Settle two effects: each is searched for anew, given the other, until neither changes."""
    best, other = pairs[0], pairs
    for _ in range(MOST_SWAPS):
        swapped = judge.pairs(judge.alone(best, position=1))
        if set(swapped[0].ids) == set(best.ids) or swapped[0].score <= best.score:
            break
        best, other = swapped[0], swapped
    else:
        swapped = judge.pairs(judge.alone(best, position=1))
    second = _group(best.ids[1], [(pair.ids[1], pair.score) for pair in (best, *other)])
    alike = [(twin.ids[0], twin.score) for twin in (best, *judge.twins(best, 0))]
    first = _group(best.ids[0], [*alike, *((pair.ids[1], pair.score) for pair in swapped)])
    return Finding(best, (first[0], second[0]), (first[1], second[1]), tuple(other))


def _ranked_group(ranked: Sequence[Scored], position: int) -> tuple[tuple[str, ...], float]:
    """Name the effects tied with that of the best model, the first one, at its position."""
    own = ranked[0].ids[position]
    return _group(own, [(scored.ids[position], scored.score) for scored in ranked])


def _group(own: str, tried: Iterable[tuple[str, float]]) -> tuple[tuple[str, ...], float]:
    """Name the effects tied with one, and how sure the group is.

    Args:
        own: The effect.
        tried: It and those tried in its place, with the scores of the models; some more than once.
    """
    scores: dict[str, float] = {}
    for name, score in sorted(tried, key=lambda one: -one[1]):
        scores.setdefault(name, score)
    below = {name: min(score - scores[own], 0.0) for name, score in scores.items()}
    tied = [name for name, nats in below.items() if nats > -TIED]
    weights = {name: float(np.exp(TEMPER * nats)) for name, nats in below.items()}
    confidence = sum(weights[name] for name in tied) / sum(weights.values())
    return tuple(name for name in tied if name != own), confidence
