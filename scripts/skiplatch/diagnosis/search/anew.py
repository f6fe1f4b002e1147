"""Findings anew, once effects are taken out of one."""

from collections.abc import Collection

from skiplatch.diagnosis.search.decide import Finding, find, grown, one_of, several
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Noticed, Scored


def reduced(judge: Judge, model: Scored) -> Finding:
    """Give a finding with a model that has fewer effects than were found."""
    return several(judge, model, ()) if len(model.ids) > 1 else one_of(judge, model)


def beyond(judge: Judge, model: Scored, left_out: Collection[str], noticed: Noticed) -> Finding:
    """Search on from a model, without effects that stood for what is there, if that is seen."""
    if not noticed(model):
        return reduced(judge, model)
    judge.leave_out(left_out)
    judge.believe_beside(model.fit)
    return grown(judge, judge.score(model.fit), (), noticed)


def found_without(judge: Judge, left_out: Collection[str], noticed: Noticed) -> Finding:
    """Search without effects that hide what is there; in its place they may stand all the same."""
    judge.leave_out(left_out)
    model = find(judge, noticed).model
    judge.take_back(left_out)
    if model is None:
        return Finding(None)
    judge.believe_beside(model.fit)
    return reduced(judge, judge.score(model.fit))
