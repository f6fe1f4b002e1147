"""The effects that a search begins with, each alone, and the beliefs that they stand beside."""

from collections.abc import Sequence

from skiplatch.diagnosis.search.groups import TIED
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Noticed, Scored


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

    Beliefs that fit without any effect may have made up for a part of it, or for its mean, and it
    was given a form that suits those. So it is fitted to the beliefs as they are stated as well.
    """
    best, *others = ranked
    judge.believe_beside(best.fit)
    found = judge.scene.nominal
    if best.fit.is_always and found != judge.stated:
        nats = judge.beliefs_beside(best.fit).nats
        judge.believe(judge.stated)
        again = _fitted_again(judge, best)
        if judge.beliefs_beside(again.fit).nats > nats:
            best = again
            judge.believe_beside(best.fit)
        else:
            judge.believe(found)
    return sorted((judge.score(one.fit) for one in (best, *others)), key=lambda one: -one.score)


def _fitted_again(judge: Judge, single: Scored) -> Scored:
    """Fit an effect alone from its starts again, to the beliefs of now."""
    alike = {*single.ids, *(twin.ids[0] for twin in judge.twins(single, 0))}
    return next(one for one in judge.singles(alike) if one.ids == single.ids)
