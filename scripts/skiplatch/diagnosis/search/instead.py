"""What may stand in place of a finding that cannot be named.

Surrogates propose, and they are a little off: a model that comes near the best one in likelihood
may be the right one, which plays then show.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

from skiplatch.diagnosis.search.decide import FAINTEST, Finding
from skiplatch.diagnosis.search.groups import TIED, group_of
from skiplatch.diagnosis.search.scored import Scored

MOST_INSTEAD = 2
"""Models that are tried in place of one that cannot be named."""


def instead(finding: Finding) -> Iterator[Finding]:
    """Give a finding with another effect in place of one, as far as a surrogate can be trusted.

    The best of them first. Effects that do just the same need no trial of their own.
    """
    model = finding.model
    if model is None:
        return
    least = model.score - max(TIED, FAINTEST * model.score)
    near = [s for s in finding.ranking if s is not model and s.score > least]
    found = (_exchanged(finding, model, other) for other in near)
    yield from islice((one for one in found if one), MOST_INSTEAD)


def _exchanged(finding: Finding, model: Scored, other: Scored) -> Finding | None:
    """Give a finding another model, if that has one effect in place of one that acts otherwise."""
    new = [c for c in other.fit.candidates if c.id not in model.ids]
    old = [c for c in model.fit.candidates if c.id not in other.ids]
    if len(new) != 1 or len(old) != 1 or new[0].change == old[0].change:
        return None
    groups = zip(finding.alternatives, finding.confidences, strict=True)
    said = dict(zip(model.ids, groups, strict=True))
    group, confidence = said[old[0].id]
    if new[0].id in group:
        group = (old[0].id, *(name for name in group if name != new[0].id))
    else:
        group, confidence = _tied(finding.ranking, other, new[0].id, beside=old[0].id)
    said[new[0].id] = group, confidence
    alternatives, confidences = zip(*(said[name] for name in other.ids), strict=True)
    return replace(finding, model=other, alternatives=alternatives, confidences=confidences)


def _tied(
    ranking: Sequence[Scored], model: Scored, own: str, beside: str
) -> tuple[tuple[str, ...], float]:
    """Name what is tied with an effect of a model, beside one that is out, by what was tried."""
    rest = {*model.ids} - {own}
    alike = [s for s in ranking if len(s.ids) == len(model.ids) and rest < {*s.ids}]
    tried = [(name, s.score) for s in alike for name in s.ids if name not in rest | {beside}]
    return group_of(own, tried)
