"""What may stand in place of a finding that cannot be named, or that leaves something.

Surrogates propose, and they are a little off: a model that comes near the best one in likelihood
may be the right one, which plays then show.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from typing import Protocol

from skiplatch.diagnosis.search.decide import FAINTEST, Finding
from skiplatch.diagnosis.search.groups import TIED, group_of
from skiplatch.diagnosis.search.scored import Scored

MOST_INSTEAD = 2
"""Models that are tried in place of one that cannot be named."""


class Trial(Protocol):
    """Scores models that differ from one by an effect, by its number."""

    def in_place(self, model: Scored, position: int) -> Sequence[Scored]:
        """Give it with others in place of the effect, which come last."""

    def without(self, model: Scored, position: int) -> Scored:
        """Give it without the effect."""


def instead(finding: Finding, trial: Trial) -> Iterator[Finding]:
    """Give a finding with another effect in place of one, as far as a surrogate can be trusted.

    The best of them first. Effects that do just the same need no trial of their own.
    """
    model = finding.model
    if model is None:
        return
    others = (other for other in finding.ranking if other is not model)
    found = (_exchanged(finding, model, other, trial) for other in others)
    yield from islice((one for one in found if one), MOST_INSTEAD)


def _exchanged(finding: Finding, model: Scored, other: Scored, trial: Trial) -> Finding | None:
    """Give a finding another model, if that has one effect in place of one that acts otherwise.

    It is near by what that effect gains: what the others gain, a surrogate of it cannot spoil. What
    was there is told from the new effect, or not, as it was before; what else is, is tried.
    """
    new = [c for c in other.fit.candidates if c.id not in model.ids]
    old = [c for c in model.fit.candidates if c.id not in other.ids]
    if len(new) != 1 or len(old) != 1 or new[0].change == old[0].change:
        return None
    own, before = new[0].id, old[0].id
    position = other.ids.index(own)
    gained = other.score - trial.without(other, position).score
    if other.score <= model.score - max(TIED, FAINTEST * gained):
        return None
    groups = zip(finding.alternatives, finding.confidences, strict=True)
    said = dict(zip(model.ids, groups, strict=True))
    tied = (before,) if own in said[before][0] else ()
    rivals = trial.in_place(other, position)
    tried = [(s.ids[-1], s.score) for s in rivals if s.ids[-1] != before]
    group, confidence = group_of(own, [(own, other.score), *tried])
    said[own] = (*tied, *group), confidence
    alternatives, confidences = zip(*(said[name] for name in other.ids), strict=True)
    return replace(finding, model=other, alternatives=alternatives, confidences=confidences)
