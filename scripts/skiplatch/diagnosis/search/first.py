"""The effects that a search begins with, each alone, and the beliefs that they stand beside."""

from collections.abc import Sequence

import numpy as np

from skiplatch.campaign import Nominal
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Noticed, Scored, falling

MOST_AGAIN = 2
"""Effects that are fitted again beside beliefs of their own."""


def first_effects(judge: Judge, noticed: Noticed) -> list[Scored]:
    """Give every effect alone, and those that begin or end where no lasting one will do.

    One that acts for long shows as it is fitted to all touches, one that acts at an end by what any
    that lasts leaves. They stand beside beliefs that fit without any, all that was recorded or one
    observable; by falling score.
    """
    judge.believe_beside(None)
    ranked = _beside_likeliest(judge, judge.singles())
    best = ranked[0] if ranked and judge.is_significant(ranked[0]) else None
    if not ranked or not (judge.may_begin(ranked) or noticed(best)):
        return ranked
    least = ranked[0].score + TIED  # one that lasts will do as well
    begun = [one for one in judge.passing(ranked) if one.score > least]
    return sorted([*begun, *ranked], key=lambda scored: -scored.score)


def _beside_likeliest(judge: Judge, ranked: list[Scored]) -> list[Scored]:
    """Give every effect alone beside the beliefs with which the best of them is likeliest.

    Where one observable tells a belief otherwise than all do, an effect in the others may have
    moved it: what leaves that observable alone is then found beside its own beliefs only.
    """
    beliefs = [*judge.told_otherwise(), *judge.told_along_grid()]
    if not beliefs:
        return ranked
    held = judge.scene.nominal
    nats = judge.beliefs_beside(ranked[0].fit if ranked else None).nats
    for nominal in beliefs:
        judge.believe(nominal)
        others = judge.singles()
        beside = judge.beliefs_beside(others[0].fit if others else None).nats
        if beside > nats + TIED:
            held, ranked, nats = nominal, others, beside
    judge.believe(held)
    return ranked


def beside_its_beliefs(judge: Judge, ranked: Sequence[Scored]) -> list[Scored]:
    """Hold effects alone against the beliefs that fit beside the best of them; by falling score.

    Each counts by the beliefs that it has itself. Those that fit without any effect, or beside
    another one, may have made up for a part of it, or for its mean, and it was given a form that
    suits them.
    """
    best = ranked[0]
    judge.believe_beside(best.fit)
    found = [(best.fit, judge.scene.nominal)]
    found += [_fitted_again(judge, *one) for one in _worth_another_fit(judge, best)]
    scores = [judge.score_beside(*one).score for one in found]
    fit, nominal = found[int(np.argmax(scores))]
    judge.believe(nominal)
    judge.believe_beside(fit)
    own, held = [judge.score_beside(*one) for one in found], [judge.score(s.fit) for s in ranked]
    best_of = {one.ids: one for one in sorted([*held, *own], key=lambda one: one.score)}
    return sorted(best_of.values(), key=lambda one: -one.score)


def _worth_another_fit(judge: Judge, best: Scored) -> list[tuple[str, Nominal]]:
    """Name effects to be fitted again, and the beliefs that these are to be fitted to.

    The best one, to beliefs as they are stated if it has others; and those that come out best if
    they are fitted together with the beliefs that are said to be uncertain, from the stated ones.
    """
    is_moved = best.fit.is_always and judge.scene.nominal != judge.stated
    worth = [(best.ids[0], judge.stated)] if is_moved else []
    if judge.stated.uncertainty:
        judge.believe(judge.stated)
        own = judge.together(judge.roughly())
        scores = [judge.score_beside(*one).score for one in own]
        likely = [own[i] for i in falling(scores)[:MOST_AGAIN]]
        worth += [(fit.candidates[0].id, nominal) for fit, nominal in likely]
    return worth


def _fitted_again(judge: Judge, effect_id: str, nominal: Nominal) -> tuple[Fit, Nominal]:
    """Fit an effect alone, in all its forms, to some beliefs, and then together with these."""
    judge.believe(nominal)
    again = next(one for one in judge.singles({effect_id}) if one.ids == (effect_id,))
    (found,) = judge.together([again.fit])
    return found
