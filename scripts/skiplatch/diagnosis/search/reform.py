"""Another form of an effect that is there already, which comes before a further effect.

What an effect alone did not need, as a scatter of its own, it may need once another one has taken
what hid it; to name something else for that would be wrong.
"""

from dataclasses import replace

from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.span import ALWAYS

BETTER = 2.0
"""Nats by which a form found in company has to be better than the one found alone."""


def reformed(judge: Judge, model: Scored) -> Scored:
    """Give a model with one of its effects in the form that is best beside the others.

    The same if none does better; what begins or ends stays as it is. Slack is left out to begin
    with, as it stands for such forms.
    """
    stiff = replace(model.fit, slack=0.0)
    lasting = [i for i, candidate in enumerate(stiff.candidates) if candidate.span == ALWAYS]
    formed = judge.formed([(stiff.alone(i), stiff.without(i)) for i in lasting])
    models = [judge.score(_with(stiff, i, one)) for i, one in zip(lasting, formed, strict=True)]
    likely = [one for one in models if one.fit.key != stiff.key]
    best = max(judge.jointly(likely), key=lambda one: one.score, default=model)
    return best if best.score > model.score + BETTER else model


def _with(model: Fit, position: int, effect: Fit) -> Fit:
    """Put another form of an effect in its place, with the slack that it needs."""
    parameters = list(model.parameters)
    (parameters[position],) = effect.parameters
    return replace(model, parameters=tuple(parameters), slack=effect.slack)
