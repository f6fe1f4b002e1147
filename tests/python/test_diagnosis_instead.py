"""What cannot be named gives way to models that come near it."""

from collections.abc import Sequence
from dataclasses import dataclass

import pytest

from scored_models import scored
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.instead import MOST_INSTEAD, instead
from skiplatch.diagnosis.search.scored import Scored

LATE, LOCK, BLOCKED, BOUNCE = "scan_jitter", "scan_phase_lock", "isr_blocking", "contact_bounce"


def found(*others: Scored, nats: float = 100.0) -> Finding:
    """Give a finding of late scans and a blocked interrupt, with others that were tried."""
    model = scored(LATE, BLOCKED, nats=nats)
    ranking = tuple(sorted([model, *others], key=lambda one: -one.score))
    return Finding(model, ((LOCK,), (BOUNCE,)), (0.9, 0.8), ranking)


@dataclass(frozen=True)
class Tried:
    """Any effect of a model has the same rivals, and gains as much."""

    rivals: Sequence[Scored] = ()
    gained: float = 100.0

    def in_place(self, _model: Scored, _position: int) -> Sequence[Scored]:
        return self.rivals

    def without(self, model: Scored, position: int) -> Scored:
        others = [name for i, name in enumerate(model.ids) if i != position]
        return scored(*others, nats=model.score - self.gained)


NOTHING = Tried()


def test_an_effect_is_exchanged_for_one_that_is_not_told_from_it() -> None:
    (other,) = instead(found(scored(BLOCKED, LOCK, nats=97.0)), NOTHING)

    assert other.model is not None
    assert other.model.ids == (BLOCKED, LOCK)
    assert other.alternatives == ((BOUNCE,), (LATE,))
    assert other.confidences == (0.8, 1.0)


def test_what_is_near_by_what_a_surrogate_is_off_by_is_not_tied_with_what_it_replaces() -> None:
    """3 % of a thousand nats; with what comes as near as it, it is tied."""
    overrun = scored(BLOCKED, "scan_overrun", nats=975.0)
    rivals = [
        scored(BLOCKED, name, nats=nats)
        for name, nats in ((LATE, 1000.0), (LOCK, 972.0), ("servo_hold", 966.0))
    ]

    other, *_ = instead(found(overrun, nats=1000.0), Tried(rivals, gained=975.0))

    assert other.model is overrun
    assert other.alternatives == ((BOUNCE,), (LOCK,))
    assert other.confidences[0] == 0.8
    assert 0.98 < other.confidences[1] < 1.0


def test_what_the_others_gain_brings_no_effect_nearer() -> None:
    """A drift of the clock gains 900 of them: 25 are much of what tells one scan from another."""
    overrun = scored(BLOCKED, "scan_overrun", nats=975.0)

    assert not list(instead(found(overrun, nats=1000.0), NOTHING))


@pytest.mark.parametrize(
    "other",
    [
        scored(BLOCKED, LOCK, nats=93.0),  # behind by more than a tie, and more than 3 %
        scored(LATE, nats=99.0),
        scored(LOCK, BOUNCE, nats=99.0),  # both are others
    ],
)
def test_what_is_far_off_or_another_model_is_not_tried(other: Scored) -> None:
    assert not list(instead(found(other), NOTHING))


def test_what_does_just_the_same_is_not_tried() -> None:
    delay, twin = scored("trigger_delay", nats=50.0), scored("input_filter", nats=50.0)

    assert not list(instead(Finding(delay, (("input_filter",),), (0.9,), (delay, twin)), NOTHING))


def test_only_the_best_few_are_tried_and_nothing_in_place_of_nothing() -> None:
    names = ("scan_overrun", "scan_phase_lock", "scan_period", "input_image_delay", "servo_hold")
    others = [scored(BLOCKED, name, nats=99.0 - at) for at, name in enumerate(names)]

    tried = [one.model.ids[-1] for one in instead(found(*others), NOTHING) if one.model]

    assert tried == list(names[:MOST_INSTEAD])
    assert not list(instead(Finding(None), NOTHING))
