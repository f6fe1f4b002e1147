"""The rules of a verdict, one by one on made-up evidence, and what they come to together."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import pytest

from skiplatch.diagnosis.look import EVERYWHERE, SIGNIFICANT, Left
from skiplatch.diagnosis.shrink import Gap
from skiplatch.diagnosis.verdict import (
    EXPLAINS,
    HAS_GAP,
    NAMES,
    SEES,
    Evidence,
    Rule,
    Verdict,
    decide,
    failures,
)
from skiplatch.statistics import Interval

RULES = {rule.name: rule for rule in (*EXPLAINS, *NAMES, *SEES, *HAS_GAP)}
A_BIT = 1e-6


def left(z: float, *conditions: str) -> Left:
    """Something left of a position."""
    return Left("position", "skip", "shift", conditions or (EVERYWHERE,), 1.0, "µm", 1.0, 0.1, z)


def gap(low: float, high: float = 1.0, *, is_clear: bool = True) -> Gap:
    """A gap that shrinks by so much."""
    share = Interval((low + high) / 2.0, low, high)
    return Gap("position", "µm", 5.0, 1.0, 0.9, share, is_clear=is_clear)


def gaps(*several: Gap) -> Mapping[str, Gap]:
    return {f"observable_{i}": one for i, one in enumerate(several)}


FOUND = Evidence(
    gaps=gaps(gap(0.95)), before=[left(20.0, "feed")], effects=["backlash"], hidden=0.1
)
"""A finding that explains all."""
NOTHING = Evidence(gaps=gaps(gap(0.0, 0.0, is_clear=False)), hidden=0.1)
"""Touches without a gap."""

Change = Callable[[Rule], Evidence]


def shrinking_by(low: float) -> Evidence:
    return Evidence(gaps=gaps(gap(low)))


def leaving(z: float) -> Evidence:
    return Evidence(after=[left(z)])


def told_before_and_after(before: float, after: float) -> Evidence:
    return Evidence(before=[left(before, "feed")], after=[left(after, "feed")])


SIDES: Mapping[str, tuple[Change, Change]] = {
    "shrinks": (
        lambda rule: shrinking_by(rule.threshold),
        lambda rule: shrinking_by(rule.threshold - A_BIT),
    ),
    "leaves_nothing": (
        lambda rule: leaving(rule.threshold),
        lambda rule: leaving(rule.threshold + A_BIT),
    ),
    "within_limits": (
        lambda _: Evidence(at_limit=[]),
        lambda _: Evidence(at_limit=["backlash.backlash_um"]),
    ),
    "known": (lambda _: Evidence(open=[]), lambda _: Evidence(open=["backlash.backlash_um"])),
    "has_form": (lambda _: Evidence(is_loose=False), lambda _: Evidence(is_loose=True)),
    "is_confirmed": (lambda _: Evidence(is_confirmed=True), lambda _: Evidence(is_confirmed=False)),
    "shrinks_somewhere": (
        lambda rule: shrinking_by(rule.threshold + A_BIT),
        lambda rule: shrinking_by(rule.threshold),
    ),
    "grows_nowhere": (
        lambda rule: Evidence(gaps=gaps(gap(-1.0, rule.threshold))),
        lambda rule: Evidence(gaps=gaps(gap(-1.0, rule.threshold - A_BIT))),
    ),
    "is_no_mimic": (
        lambda rule: told_before_and_after(20.0, 20.0 * rule.threshold**0.5),
        lambda rule: told_before_and_after(20.0, 20.0 * rule.threshold**0.5 + A_BIT),
    ),
    "seen_enough": (
        lambda rule: Evidence(hidden=rule.threshold),
        lambda rule: Evidence(hidden=rule.threshold + A_BIT),
    ),
    "few_false": (
        lambda rule: Evidence(false=int(rule.threshold)),
        lambda rule: Evidence(false=int(rule.threshold) + 1),
    ),
    "believed_leaves_nothing": (
        lambda rule: leaving(rule.threshold),
        lambda rule: leaving(rule.threshold + A_BIT),
    ),
}
"""For each rule, evidence on the one side of its threshold that holds and on the other."""


def test_both_sides_of_every_rule_are_tried() -> None:
    assert SIDES.keys() == RULES.keys()


@pytest.mark.parametrize("name", SIDES)
def test_a_rule_holds_up_to_its_threshold_and_no_further(name: str) -> None:
    holds, fails = (side(RULES[name]) for side in SIDES[name])

    assert failures([RULES[name]], holds) == []
    (failure,) = failures([RULES[name]], fails)
    assert failure.rule == name
    assert failure.threshold == RULES[name].threshold
    assert failure.reason == RULES[name].reason
    assert failure.words


def test_every_rule_has_a_name_of_its_own_and_a_reason() -> None:
    rules = [*EXPLAINS, *NAMES, *SEES, *HAS_GAP]

    assert len({rule.name for rule in rules}) == len(rules)
    assert all(rule.reason.startswith(("a level", "theory", "tuned")) for rule in rules)


def test_a_gap_within_the_noise_need_not_shrink() -> None:
    unclear = Evidence(gaps=gaps(gap(0.95), gap(-1.0, -0.5, is_clear=False)))

    assert failures([RULES["shrinks"], RULES["grows_nowhere"]], unclear) == []


def test_every_clear_gap_has_to_shrink_and_one_is_enough_for_a_name() -> None:
    mixed = Evidence(gaps=gaps(gap(0.95), gap(0.1)))

    assert [f.rule for f in failures(list(RULES.values()), mixed)] == ["shrinks"]


def test_no_clear_gap_shrinks_nowhere() -> None:
    unclear = Evidence(gaps=gaps(gap(0.95, is_clear=False)))

    (failure,) = failures([RULES["shrinks_somewhere"]], unclear)
    assert failure.words == "no gap on the touches held out"


def test_what_is_everywhere_is_no_sign_of_a_mimic() -> None:
    evidence = Evidence(before=[left(20.0, "feed")], after=[left(30.0)])

    assert failures([RULES["is_no_mimic"]], evidence) == []


def test_what_tells_a_mimic_is_named() -> None:
    (failure,) = failures([RULES["is_no_mimic"]], told_before_and_after(20.0, 20.0))

    assert failure.words == "what it leaves to chance can be told from feed"


def test_an_explained_gap_is_explained() -> None:
    assert decide(FOUND) == (Verdict.EXPLAINED, [])


@pytest.mark.parametrize(
    ("worse", "rule"),
    [
        (replace(FOUND, gaps=gaps(gap(0.5))), "shrinks"),
        (replace(FOUND, after=[left(SIGNIFICANT + 1.0, "feed")]), "leaves_nothing"),
        (replace(FOUND, at_limit=["backlash.backlash_um"]), "within_limits"),
        (replace(FOUND, open=["backlash.backlash_um"]), "known"),
        (replace(FOUND, is_loose=True), "has_form"),
        (replace(FOUND, is_confirmed=False), "is_confirmed"),
    ],
)
def test_what_falls_short_in_one_respect_explains_in_part(worse: Evidence, rule: str) -> None:
    verdict, failed = decide(worse)

    assert verdict == Verdict.PARTLY_EXPLAINED
    assert [failure.rule for failure in failed] == [rule]


@pytest.mark.parametrize(
    ("wrong", "rule"),
    [
        (replace(FOUND, gaps=gaps(gap(0.1))), "shrinks_somewhere"),
        (replace(FOUND, gaps=gaps(gap(0.95), gap(-1.0, -0.1))), "grows_nowhere"),
        (replace(FOUND, after=[left(20.0, "time")]), "is_no_mimic"),
    ],
)
def test_a_finding_that_cannot_be_named_leaves_the_gap_unknown(wrong: Evidence, rule: str) -> None:
    verdict, failed = decide(wrong)

    assert verdict == Verdict.UNKNOWN
    assert [failure.rule for failure in failed] == [rule]


def test_nothing_found_and_nothing_left_is_no_gap() -> None:
    assert decide(NOTHING) == (Verdict.NO_GAP, [])


@pytest.mark.parametrize(
    ("other", "rule"),
    [
        (replace(NOTHING, after=[left(SIGNIFICANT + 1.0)]), "believed_leaves_nothing"),
        (replace(NOTHING, false=2), "few_false"),
    ],
)
def test_a_gap_in_which_nothing_was_found_is_unknown(other: Evidence, rule: str) -> None:
    verdict, failed = decide(other)

    assert verdict == Verdict.UNKNOWN
    assert [failure.rule for failure in failed] == [rule]


def test_touches_in_which_the_noise_itself_could_have_hidden_are_undecided() -> None:
    verdict, failed = decide(replace(NOTHING, hidden=1.5))

    assert verdict == Verdict.UNDECIDED
    assert [failure.rule for failure in failed] == ["seen_enough"]


def test_few_touches_that_show_a_gap_all_the_same_are_not_undecided() -> None:
    assert decide(replace(NOTHING, hidden=1.5, after=[left(9.0)]))[0] == Verdict.UNKNOWN


def test_an_effect_that_was_found_needs_no_number_of_touches() -> None:
    assert decide(replace(FOUND, hidden=1.5))[0] == Verdict.EXPLAINED
