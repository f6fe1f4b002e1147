"""A pair that is found from one of its effects has to be one that the other leads to as well."""

from typing import cast

import pytest

from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.search.decide import from_next_best
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Scored

SCALE, WAVE, LAG = "scale_error", "transmission_error", "following_error"


def scored(*ids: str, nats: float) -> Scored:
    """Give a model of effects with what it gains."""
    candidates = tuple(catalogue()[name] for name in ids)
    return Scored(Fit(candidates, (), frozenset()), nats / 2.0, nats / 2.0)


class Judged:
    """Stands for a judge: finds one pair, in which some effects are further ones of others."""

    def __init__(self, pair: Scored, *further: tuple[str, str]) -> None:
        self._pair, self._further = pair, further

    def pairs(self, first: Scored, _streams: frozenset[str]) -> list[Scored]:
        return [self._pair] if self._pair.ids[0] == first.ids[0] else []

    def is_scatter(self, _scored: Scored) -> bool:
        return False

    def score(self, model: Fit) -> Scored:
        return Scored(model, self._pair.fitted, self._pair.checked)

    def is_enough(self, larger: Scored, smaller: Scored) -> bool:
        return (smaller.ids[0], larger.ids[-1]) in self._further

    def is_elsewhere(self, _larger: Scored, _smaller: Scored) -> bool:
        return True


@pytest.mark.parametrize(
    ("second", "further", "is_found"),
    [
        (SCALE, [(WAVE, SCALE), (SCALE, WAVE)], True),
        # What the scale refuses beside it, as a form of its own, is not reached from behind.
        (SCALE, [(WAVE, SCALE)], False),
        # A pair without the best effect says nothing of what goes with that.
        (LAG, [(WAVE, LAG)], True),
        (LAG, [], False),
    ],
)
def test_a_pair_passes_in_any_order_of_its_effects(
    second: str, further: list[tuple[str, str]], is_found: bool
) -> None:
    best, wave = scored(SCALE, nats=400.0), scored(WAVE, nats=390.0)
    pair = scored(WAVE, second, nats=500.0)
    judge = cast(Judge, Judged(pair, *further))

    found = from_next_best(judge, [best, wave], best, lambda _model: frozenset({"position"}))

    assert found == ([pair] if is_found else [])
