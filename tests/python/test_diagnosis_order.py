"""In which order several effects are found, and what else is kept in mind."""

from dataclasses import replace
from typing import cast

import pytest

from scored_models import scored
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.search import decide
from skiplatch.diagnosis.search.decide import (
    Finding,
    _extended,
    _from_further_on,
    _pairs,
    from_next_best,
    several,
)
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.scored import Scored

SCALE, WAVE, LAG = "scale_error", "transmission_error", "following_error"
HOLD, STEPS, LATE = "servo_hold", "encoder_quantisation", "scan_jitter"


class Judged:
    """Stands for a judge: finds one pair, in which some effects are further ones of others."""

    def __init__(self, pair: Scored, *further: tuple[str, str]) -> None:
        self._pair, self._further = pair, further

    def pairs(self, first: Scored, _streams: frozenset[str]) -> list[Scored]:
        return [self._pair] if self._pair.ids[0] == first.ids[0] else []

    def reaches(self, _model: Scored, _position: int) -> frozenset[str]:
        return frozenset()

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


class Opening(Judged):
    """Knows the best pair of each first effect, and no better form of these."""

    def __init__(self, *pairs: Scored) -> None:
        self._pairs = {pair.ids[0]: pair for pair in pairs}

    def pairs(self, first: Scored, _streams: frozenset[str]) -> list[Scored]:
        return [self._pairs[first.ids[0]]]

    def again(self, _model: Fit, _position: int) -> Scored:
        return scored(SCALE, nats=0.0)

    def is_significant(self, _scored: Scored) -> bool:
        return True

    def is_enough(self, _larger: Scored, _smaller: Scored) -> bool:
        return True

    def believe_beside(self, _fit: Fit) -> None:
        pass

    def score(self, model: Fit) -> Scored:
        return self._pairs[model.candidates[0].id]


@pytest.mark.parametrize("leaves", [True, False])
def test_another_first_effect_is_opened_where_the_pairs_of_the_best_leave_something(
    leaves: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    best, lag = scored(SCALE, nats=400.0), scored(LAG, nats=390.0)
    of_best, of_next = scored(SCALE, WAVE, nats=450.0), scored(LAG, HOLD, nats=500.0)
    judge = cast(Judge, Opening(of_best, of_next))
    monkeypatch.setattr(decide, "first_effects", lambda *_: [best, lag])
    monkeypatch.setattr(decide, "beside_its_beliefs", lambda _judge, ranked: ranked)
    monkeypatch.setattr(decide, "grown", lambda _judge, model, *_: Finding(model))

    def noticed(model: Scored | None) -> frozenset[str]:
        return frozenset({"position"} if leaves or model is not of_best else ())

    assert decide._searched(judge, noticed).model is (of_next if leaves else of_best)


def test_the_next_effect_is_asked_if_the_likeliest_is_a_form_of_the_others() -> None:
    model = scored(LAG, nats=100.0)
    form, own, other = (scored(LAG, name, nats=200.0) for name in (HOLD, LATE, STEPS))
    judge = cast(Judge, Judged(form, (LAG, LATE), (LAG, STEPS)))

    def asked(*larger: Scored) -> list[Scored]:
        return _from_further_on(judge, larger, model, lambda _model: frozenset({"position"}))

    assert asked(form, own, other) == [own, other]
    assert asked(own, form) == [own, form]
    assert asked(form) == []


class Slackened(Judged):
    """Finds a further effect without the slack of others, which takes its place."""

    def __init__(self, with_slack: Scored, without: Scored) -> None:
        self._with_slack, self._without = with_slack, without

    def pairs(self, _model: Scored, _streams: frozenset[str]) -> list[Scored]:
        return [self._with_slack, replace(self._without, fitted=1.0, checked=1.0)]

    def score(self, model: Fit) -> Scored:
        assert model.slack == 0.0
        return Scored(model, 1.0, 1.0)

    def on_top(self, _stiff: Scored, _streams: frozenset[str]) -> list[Scored]:
        return [self._without]

    def jointly(self, models: list[Scored]) -> list[Scored]:
        return models


def test_slack_does_not_stand_for_a_further_effect() -> None:
    model = scored(STEPS, LATE, nats=300.0)
    model = replace(model, fit=replace(model.fit, slack=0.4))
    with_slack, hold = scored(STEPS, LATE, LAG, nats=310.0), scored(STEPS, LATE, HOLD, nats=400.0)
    judge = cast(Judge, Slackened(with_slack, hold))

    assert _extended(judge, model, lambda _model: frozenset())[0] is hold


class Turning(Slackened):
    """Finds a pair without slack that is worse where it is searched from its second effect."""

    def alone(self, model: Scored, position: int) -> Scored:  # noqa: ARG002 - by name
        return model

    def turned(self, pairs: list[tuple[Scored, Scored]]) -> list[Scored]:
        return [replace(pair, fitted=1.0, checked=1.0) for pair, _ in pairs]


def test_a_pair_without_slack_stays_where_searching_it_the_other_way_round_ends_elsewhere() -> None:
    first = scored(STEPS, nats=300.0)
    first = replace(first, fit=replace(first.fit, slack=0.4))
    with_slack, hold = scored(STEPS, LAG, nats=310.0), scored(STEPS, HOLD, nats=400.0)

    found = _pairs(cast(Judge, Turning(with_slack, hold)), first, lambda _model: frozenset())

    assert found[0] is hold
    assert [pair.ids for pair in found] == [hold.ids, with_slack.ids]


class InPlace(Judged):
    """Has one other model for each effect of one, the effects in another order."""

    def __init__(self, *others: Scored) -> None:
        self._others = others

    def in_place(self, _model: Scored, position: int) -> list[Scored]:
        return [self._others[position]]

    def promise(self, model: Scored) -> float:
        return model.score


def test_what_would_stand_in_place_of_each_effect_is_kept() -> None:
    """Not only of the one that was found last; plays choose among them."""
    model = scored(LATE, LAG, nats=100.0)
    first, last = scored(LAG, HOLD, nats=98.0), scored(LATE, STEPS, nats=95.0)
    again = scored(HOLD, LAG, nats=97.0)  # the same effects as the first
    anew = scored(LAG, LATE, nats=101.0)  # and as the model, hardly better

    found = several(cast(Judge, InPlace(first, last)), model, [model, again, anew])

    assert found.ranking == (model, first, last)
    assert found.alternatives == ((HOLD,), (STEPS,))
