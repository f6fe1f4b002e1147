"""The models that a diagnosis leaves to be told apart."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from skiplatch.diagnosis.reported.schema import whole
from skiplatch.simulator.effects import Effect

if TYPE_CHECKING:
    from skiplatch.diagnosis.reported.diagnosis import Diagnosis

MOST_RIVALS = 6
CLOSE_NATS = 10.0
"""A model so far behind the finding is no rival of it."""

Model = tuple[Effect, ...]
NO_EFFECT: Model = ()


def rivals(diagnosis: "Diagnosis") -> list[Model]:
    """Give the finding and what could be true in its place: its rivals, or a close runner-up."""
    if not diagnosis.effects:
        return []
    finding = tuple(named.effect for named in diagnosis.effects)
    if tied := list(_tied(diagnosis)):
        return _distinct([finding, *tied])[:MOST_RIVALS]
    best = max((ranked.score_nats for ranked in diagnosis.ranking), default=0.0)
    close = [r.effects for r in diagnosis.ranking if r.score_nats > best - CLOSE_NATS]
    return _distinct([finding, *close])[:2]


def models_json(models: list[Model]) -> list[list[dict[str, Any]]]:
    """Give models in plain types, so that an experiment needs no diagnosis anew."""
    return [[{"id": e.id, "params": dict(e.parameters)} for e in model] for model in models]


def models_from_json(document: Any) -> tuple[list[Model], str]:  # noqa: ANN401 - JSON is anything
    """Read them back from the document of a diagnosis, with its verdict.

    Raises:
        ValueError: They are not in it, or not whole.
    """
    read = whole(document, "models", "verdict")
    models = [tuple(Effect(e["id"], e["params"]) for e in model) for model in read["models"]]
    return models, str(read["verdict"])


def _tied(diagnosis: "Diagnosis") -> Iterator[Model]:
    """Give the models that the scores tie with the finding, and those that stand for its groups."""
    yield from (ranked.effects for ranked in diagnosis.rivals[1:])
    own = [named.effect.id for named in diagnosis.effects]
    for position, named in enumerate(diagnosis.effects):
        for other in named.alternatives:
            wanted = sorted([*own[:position], other, *own[position + 1 :]])
            models = (ranked.effects for ranked in diagnosis.ranking)
            yield from (m for m in models if sorted(effect.id for effect in m) == wanted)


def _distinct(models: list[Model]) -> list[Model]:
    """Keep the first of those with the same effects."""
    first: dict[tuple[str, ...], Model] = {}
    for model in models:
        first.setdefault(tuple(sorted(effect.id for effect in model)), model)
    return list(first.values())
