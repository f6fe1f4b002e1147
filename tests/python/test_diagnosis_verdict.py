"""The rules of a verdict, one by one on made-up evidence, and what they come to together."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from skiplatch.diagnosis.look import EVERYWHERE, SIGNIFICANT, Left
from skiplatch.diagnosis.shrink import Gap
from skiplatch.diagnosis.verdict import (
    CHANCE,
    EXPLAINS,
    HAS_GAP,
    LIKELIER,
    NAMES,
    SEES,
    Evidence,
    Rule,
    Verdict,
    decide,
    failures,
    shows_too_little,
    told_of_chance,
)
from skiplatch.statistics import Interval

RULES = {rule.name: rule for rule in (*EXPLAINS, *NAMES, *SEES, *HAS_GAP)}
A_BIT = 1e-6


def left(z: float, *conditions: str, relative: float = 1.0) -> Left:
    """Something left of a position, where plays scatter by 1 µm."""
    names = conditions or (EVERYWHERE,)
    return Left("position", "skip", "shift", names, relative, "µm", relative, 1.0, 0.1, z)


def gap(low: float, high: float = 1.0, *, is_clear: bool = True) -> Gap:
    """A gap that shrinks by so much."""
    share = Interval((low + high) / 2.0, low, high)
    return Gap("position", "µm", 5.0, 5.0 - 4.0 * share.value, 0.9, share, is_clear=is_clear)


GROWING = replace(gap(-1.0, -0.5), grows=True)


def gaps(*several: Gap) -> Mapping[str, Gap]:
    return {f"observable_{i}": one for i, one in enumerate(several)}


FOUND = Evidence(
    gaps=gaps(gap(0.95)),
    before=[left(20.0, "feed", relative=4.0)],
    effects=["backlash"],
    hidden=0.1,
)
"""A finding that explains all."""
NOTHING = Evidence(gaps=gaps(gap(0.0, 0.0, is_clear=False)), hidden=0.1)
"""Touches without a gap."""

Change = Callable[[Rule], Evidence]


def shrinking_by(low: float) -> Evidence:
    return Evidence(gaps=gaps(gap(low)))


def leaving(z: float) -> Evidence:
    return Evidence(after=[left(z)])


def telling_of_chance(z: float) -> Evidence:
    """Something known tells of what a finding has left to chance."""
    return Evidence(chance=[left(z, "feed")])


def leaving_of_four(relative: float) -> Evidence:
    """So much is left of four times the noise."""
    return Evidence(before=[left(20.0, relative=4.0)], after=[left(20.0, relative=relative)])


TOUCHES = 200


def most_accidents(rule: Rule) -> int:
    """So many of the touches are far off by chance, but for one campaign in a hundred."""
    counts = np.random.default_rng(1).binomial(TOUCHES, rule.threshold, 200_000)
    return int(np.quantile(counts, 0.99))


SIDES: Mapping[str, tuple[Change, Change]] = {
    "shrinks": (
        lambda rule: shrinking_by(rule.threshold),
        lambda rule: shrinking_by(rule.threshold - A_BIT),
    ),
    "leaves_nothing": (
        lambda rule: leaving(rule.threshold),
        lambda rule: leaving(rule.threshold + A_BIT),
    ),
    "few_outliers": (
        lambda rule: Evidence(outlying=most_accidents(rule), touches=TOUCHES),
        lambda rule: Evidence(outlying=most_accidents(rule) + 1, touches=TOUCHES),
    ),
    "believed_few_outliers": (
        lambda rule: Evidence(outlying=most_accidents(rule), touches=TOUCHES),
        lambda rule: Evidence(outlying=most_accidents(rule) + 1, touches=TOUCHES),
    ),
    "held_out": (
        lambda _: Evidence(is_held_out=True),
        lambda _: Evidence(is_held_out=False),
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
        lambda _: Evidence(gaps=gaps(gap(-1.0, -0.5))),
        lambda _: Evidence(gaps=gaps(GROWING)),
    ),
    "chance_is_chance": (
        lambda rule: telling_of_chance(rule.threshold),
        lambda rule: telling_of_chance(rule.threshold + A_BIT),
    ),
    "takes_most": (
        lambda rule: leaving_of_four(4.0 * np.sqrt(rule.threshold) - A_BIT),
        lambda rule: leaving_of_four(4.0 * np.sqrt(rule.threshold) + A_BIT),
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


def test_touches_that_are_likelier_show_a_finding_that_no_gap_is_clear_of() -> None:
    """What comes now and then hardly lowers a score that forgives what is rare."""
    unclear = gaps(gap(0.5, is_clear=False))
    shown = replace(FOUND, gaps=unclear, nats=LIKELIER + A_BIT)

    assert decide(replace(shown, nats=LIKELIER))[0] == Verdict.UNKNOWN
    verdict, failed = decide(shown)
    assert verdict == Verdict.PARTLY_EXPLAINED
    assert [failure.rule for failure in failed] == ["shrinks"]


def test_no_clear_gap_shrinks_nowhere() -> None:
    unclear = Evidence(gaps=gaps(gap(0.95, is_clear=False)))

    (failure,) = failures([RULES["shrinks_somewhere"]], unclear)
    assert failure.words == "no gap is clear"


def test_what_is_left_elsewhere_tells_nothing_of_chance() -> None:
    evidence = Evidence(after=[left(30.0, "feed")])

    assert told_of_chance(evidence) == []
    assert failures([RULES["chance_is_chance"]], evidence) == []


def test_what_tells_of_chance_is_named() -> None:
    (failure,) = failures([RULES["chance_is_chance"]], telling_of_chance(30.0))

    assert failure.words == "what it leaves to chance in position goes with feed"


def test_what_is_no_more_than_an_accident_may_be_most_of_a_gap() -> None:
    accident = Evidence(before=[left(20.0, relative=4.0)], after=[left(CHANCE, relative=4.0)])

    assert failures([RULES["takes_most"]], accident) == []


def test_a_gap_where_there_was_none_is_all_of_it() -> None:
    new = Evidence(after=[left(CHANCE + A_BIT, relative=0.3)])

    (failure,) = failures([RULES["takes_most"]], new)
    assert failure.words == "it leaves 0.3 µm of position, much of what was there"


def test_only_a_lack_of_touches_asks_for_those_that_named() -> None:
    assert shows_too_little(shrinking_by(0.0))
    assert not shows_too_little(shrinking_by(1.0))
    assert not shows_too_little(Evidence(gaps=gaps(GROWING)))  # no lack


def of_kind(kind: str, z: float, size: float, relative: float, *conditions: str) -> Left:
    return replace(left(z, *conditions, relative=relative), kind=kind, size=size)


def test_like_is_held_against_like_in_its_own_unit() -> None:
    """A wave that stays is not made small by a scatter that was larger, nor by noise made up."""
    before = [of_kind("scatter", 30.0, 5.5, 8.0), of_kind("shift", 9.0, 2.0, 2.0, "time")]
    stays = Evidence(before=before, after=[of_kind("wave", 9.0, 1.9, 0.3, "time, in waves")])
    goes = Evidence(before=before, after=[of_kind("wave", 9.0, 0.9, 0.9, "time, in waves")])

    assert [f.rule for f in failures([RULES["takes_most"]], stays)] == ["takes_most"]
    assert failures([RULES["takes_most"]], goes) == []


def test_what_is_little_of_all_that_was_there_need_not_go() -> None:
    """A form that is somewhat off leaves scatter that there was hardly any of before."""
    before = [
        of_kind("shift", 20.0, 21.0, 70.0, "feed"),
        of_kind("scatter", 20.0, 0.9, 3.2, "feed"),
    ]
    rest = [of_kind("scatter", 14.0, 0.7, 2.4, "feed")]

    assert failures([RULES["takes_most"]], Evidence(before=before, after=rest)) == []


def test_what_shows_only_now_is_held_against_all_that_was_there() -> None:
    before = [of_kind("scatter", 30.0, 8.0, 8.0)]
    faint, strong = (of_kind("shift", 9.0, 6.0, size, "feed") for size in (5.0, 6.0))

    assert failures([RULES["takes_most"]], Evidence(before=before, after=[faint])) == []
    assert len(failures([RULES["takes_most"]], Evidence(before=before, after=[strong]))) == 1


def test_an_explained_gap_is_explained() -> None:
    assert decide(FOUND) == (Verdict.EXPLAINED, [])


@pytest.mark.parametrize(
    ("worse", "rule"),
    [
        (replace(FOUND, gaps=gaps(gap(0.5))), "shrinks"),
        (replace(FOUND, after=[left(SIGNIFICANT + 1.0, "feed")]), "leaves_nothing"),
        (replace(FOUND, at_limit=["backlash.backlash_um"]), "within_limits"),
        (replace(FOUND, open=["backlash.backlash_um"]), "known"),
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
        (replace(FOUND, gaps=gaps(gap(0.95), GROWING)), "grows_nowhere"),
        (replace(FOUND, after=[left(20.0, "time", relative=3.0)]), "takes_most"),
        (replace(FOUND, chance=[left(20.0, "time")]), "chance_is_chance"),
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
    verdict, failed = decide(replace(NOTHING, hidden=6.5))

    assert verdict == Verdict.UNDECIDED
    assert [failure.rule for failure in failed] == ["seen_enough"]


def test_few_touches_that_show_a_gap_all_the_same_are_not_undecided() -> None:
    assert decide(replace(NOTHING, hidden=6.5, after=[left(9.0)]))[0] == Verdict.UNKNOWN


def test_an_effect_that_was_found_needs_no_number_of_touches() -> None:
    assert decide(replace(FOUND, hidden=6.5))[0] == Verdict.EXPLAINED


def missing(z: float) -> Left:
    """A fifth of the touches was missed."""
    return Left("missed", "plc", "share", (EVERYWHERE,), 0.2, "1", 0.2, 0.0, 0.0, z)


@pytest.mark.parametrize(("z", "is_known"), [(50.0, True), (4.5, False)])
def test_touches_that_are_missed_no_more_are_a_gap_that_shrinks(z: float, is_known: bool) -> None:
    found = Evidence(before=[missing(z)])

    assert (failures([RULES["shrinks_somewhere"]], found) == []) is is_known


def test_touches_that_are_missed_still_are_no_gap_that_shrinks() -> None:
    kept = Evidence(before=[missing(50.0)], after=[missing(45.0)])

    assert len(failures([RULES["shrinks_somewhere"]], kept)) == 1


def test_what_a_finding_does_not_touch_is_left_elsewhere() -> None:
    grid = Left("grid", "plc", "scatter", (EVERYWHERE,), 50.0, "µs", 50.0, 1.0, 0.1, 30.0)
    elsewhere = replace(FOUND, before=[*FOUND.before, grid], after=[grid])

    verdict, failed = decide(elsewhere)

    assert verdict == Verdict.PARTLY_EXPLAINED
    assert [failure.rule for failure in failed] == ["leaves_nothing"]
