"""The rules of a verdict, one by one on made-up evidence, and what they come to together."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from math import comb

import numpy as np
import pytest

from skiplatch.diagnosis.plays.left import EVERYWHERE, SIGNIFICANT, Left
from skiplatch.diagnosis.verdict.accidents import fall_to_either_side, may_be_accidents
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.rules import (
    EXPLAINS,
    HAS_GAP,
    NAMES,
    SEES,
    told_of_chance,
)
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.diagnosis.verdict.verdict import Verdict, decide, failures, shows_too_little
from verdict_evidence import GROWING, gap, gaps, left, missing

RULES = {rule.name: rule for rule in (*EXPLAINS, *NAMES, *SEES, *HAS_GAP)}
A_BIT = 1e-6


FOUND = Evidence(
    gaps=gaps(gap(0.95)),
    before=[left(20.0, "feed", relative=4.0)],
    effects=["backlash"],
    hidden=0.1,
)
"""A finding that explains all."""
NOTHING = Evidence(gaps=gaps(gap(0.0, 0.0, is_clear=False)), hidden=0.1)
"""Touches without a gap."""

Change = Callable[[float], Evidence]
LEVELS = {
    "shrinks": 0.8,
    "leaves_nothing": SIGNIFICANT,
    "few_outliers": 0.05,
    "shrinks_somewhere": 0.2,
    "chance_is_chance": 4.0,
    "takes_most": 0.5,
    "undoes_nothing": 0.2,
    "is_as_wide": 0.5,
    "gains_as_much": 2.0 / 3.0,
    "is_no_wandering": 15.0,
    "seen_enough": 6.0,
    "believed_leaves_nothing": SIGNIFICANT,
    "believed_few_outliers": 0.05,
}
"""Thresholds that are meant, by rule; the others are of yes and no."""


def leaving_beside_what_is_slow(nats: float) -> Evidence:
    slow = {"backlash": 80.0, "thermal_drift": nats}
    return Evidence(beyond_wandering=slow, after=[left(20.0, "time", relative=4.0)])


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


@cache
def most_accidents(share: float) -> int:
    """So many of the touches are far off by chance, but for one campaign in a hundred."""
    counts = np.random.default_rng(1).binomial(TOUCHES, share, 200_000)
    return int(np.quantile(counts, 0.99))


SIDES: Mapping[str, tuple[Change, Change]] = {
    "shrinks": (
        shrinking_by,
        lambda level: shrinking_by(level - A_BIT),
    ),
    "leaves_nothing": (
        leaving,
        lambda level: leaving(level + A_BIT),
    ),
    "few_outliers": (
        lambda level: Evidence(outlying=most_accidents(level), touches=TOUCHES),
        lambda level: Evidence(outlying=most_accidents(level) + 1, touches=TOUCHES),
    ),
    "believed_few_outliers": (
        lambda level: Evidence(outlying=most_accidents(level), touches=TOUCHES),
        lambda level: Evidence(outlying=most_accidents(level) + 1, touches=TOUCHES),
    ),
    "held_out": (
        lambda _: Evidence(is_held_out=True),
        lambda _: Evidence(is_held_out=False),
    ),
    "within_limits": (
        lambda _: Evidence(at_limit=[]),
        lambda _: Evidence(at_limit=["backlash.backlash_um"]),
    ),
    "is_definite": (
        lambda _: Evidence(open=["backlash.backlash_um"], vague=[]),
        lambda _: Evidence(vague=["scan_phase_lock"]),
    ),
    "undoes_nothing": (
        lambda _: Evidence(undoing=[]),
        lambda _: Evidence(undoing=["servo_hold", "following_error"]),
    ),
    "known": (lambda _: Evidence(open=[]), lambda _: Evidence(open=["backlash.backlash_um"])),
    "has_form": (lambda _: Evidence(is_loose=False), lambda _: Evidence(is_loose=True)),
    "is_confirmed": (lambda _: Evidence(is_confirmed=True), lambda _: Evidence(is_confirmed=False)),
    "shrinks_somewhere": (
        lambda level: shrinking_by(level + A_BIT),
        shrinking_by,
    ),
    "grows_nowhere": (
        lambda _: Evidence(gaps=gaps(gap(-1.0, -0.5))),
        lambda _: Evidence(gaps=gaps(GROWING)),
    ),
    "gains_as_much": (
        lambda level: Evidence(gains={"backlash": 3.5, "isr_latency": level}),
        lambda level: Evidence(gains={"backlash": 1.0, "isr_latency": level - A_BIT}),
    ),
    "is_no_wandering": (
        leaving_beside_what_is_slow,
        lambda level: leaving_beside_what_is_slow(level - A_BIT),
    ),
    "is_as_wide": (
        lambda level: Evidence(gaps=gaps(gap(0.9, tightness=level))),
        lambda level: Evidence(everywhere=gaps(gap(0.9, tightness=level - A_BIT))),
    ),
    "chance_is_chance": (
        telling_of_chance,
        lambda level: telling_of_chance(level + A_BIT),
    ),
    "takes_most": (
        lambda level: leaving_of_four(4.0 * np.sqrt(level) - A_BIT),
        lambda level: leaving_of_four(4.0 * np.sqrt(level) + A_BIT),
    ),
    "seen_enough": (
        lambda level: Evidence(hidden=level),
        lambda level: Evidence(hidden=level + A_BIT),
    ),
    "believed_leaves_nothing": (
        leaving,
        lambda level: leaving(level + A_BIT),
    ),
}
"""For each rule, evidence on the one side of its threshold that holds and on the other."""


def test_both_sides_of_every_rule_are_tried() -> None:
    assert SIDES.keys() == RULES.keys()


@pytest.mark.parametrize("name", SIDES)
def test_a_rule_holds_up_to_its_threshold_and_no_further(name: str) -> None:
    level = LEVELS.get(name, 0.0)
    holds, fails = (side(level) for side in SIDES[name])

    assert failures([RULES[name]], holds) == []
    (failure,) = failures([RULES[name]], fails)
    assert failure.rule == name
    assert failure.threshold == level
    assert failure.reason == RULES[name].reason
    assert failure.words


def test_more_accidents_than_may_be_have_a_chance_of_one_in_a_hundred() -> None:
    for touches in range(20, 200):
        fewest = next(far for far in range(touches) if not may_be_accidents(far, touches))
        chance = [comb(touches, far) * 0.05**far * 0.95 ** (touches - far) for far in range(fewest)]

        assert 1.0 - sum(chance) <= 0.01 < 1.0 - sum(chance[:-1])


@pytest.mark.parametrize(
    ("far", "beyond", "may_be"),
    [(1, 1, False), (6, 6, False), (3, 2, True), (9, 8, True), (20, 15, True), (20, 16, False)],
)
def test_accidents_fall_to_one_side_once_in_a_hundred(far: int, beyond: int, may_be: bool) -> None:
    chance = sum(comb(far, n) for n in range(beyond, far + 1)) / 2.0**far

    assert (chance > 0.01 and beyond < far) is may_be
    assert fall_to_either_side(far, beyond) is may_be
    assert fall_to_either_side(far, far - beyond) is may_be


def test_what_evidence_leaves_out_speaks_for_nothing() -> None:
    evidence = Evidence(gaps=gaps(gap(0.95)))

    assert failures(list(RULES.values()), evidence) == []
    assert (evidence.hidden, evidence.nats) == (0.0, 0.0)
    assert (evidence.outlying, evidence.touches) == (0, 0)
    assert not evidence.is_chancy
    assert not evidence.unreached


def test_verdicts_are_what_stands_in_files() -> None:
    found = [str(verdict) for verdict in Verdict]

    assert found == ["no_gap", "explained", "partly_explained", "unknown", "undecided"]


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


def test_a_gap_that_effects_leave_as_it_is_counts_unless_it_may_be_luck() -> None:
    """One run may have its scans where in a tick few others have them."""
    same = replace(gap(-0.05, 0.05), after=5.01)
    lucky, less = replace(same, may_be_luck=True), replace(gap(0.4, 0.6), may_be_luck=True)

    def words(*several: Gap) -> list[str]:
        return [f.words for f in failures([RULES["shrinks"]], Evidence(gaps=gaps(*several)))]

    assert words(gap(0.9), same)
    assert not words(gap(0.9), lucky)
    assert words(gap(0.9), less)
    assert words(lucky) == ["no gap is clear enough to tell that all of it is gone"]


def test_touches_that_are_likelier_show_a_finding_that_no_gap_is_clear_of() -> None:
    """What comes now and then hardly lowers a score that forgives what is rare."""
    unclear = gaps(gap(0.5, is_clear=False))
    shown = replace(FOUND, gaps=unclear, is_chancy=True, nats=7.0 + A_BIT)

    assert decide(replace(shown, nats=7.0))[0] == Verdict.UNKNOWN
    assert decide(replace(shown, is_loose=True))[0] == Verdict.UNKNOWN  # the slack's, then
    assert decide(replace(shown, is_chancy=False))[0] == Verdict.UNKNOWN
    verdict, failed = decide(shown)
    assert verdict == Verdict.PARTLY_EXPLAINED
    assert [failure.rule for failure in failed] == ["shrinks"]


@pytest.mark.parametrize("share", [0.0, -8.0])
def test_what_gains_too_little_is_not_named(share: float) -> None:
    assert failures([RULES["gains_as_much"]], Evidence(gains={"backlash": share}))


def test_what_gains_too_little_is_named_in_words() -> None:
    (failure,) = failures([RULES["gains_as_much"]], Evidence(gains={"backlash": 0.25}))

    assert failure.words == "backlash gains 25% of what it does where it is there"


@pytest.mark.parametrize(("high", "stays"), [(-A_BIT, False), (0.0, True), (0.2, True)])
def test_a_gap_stays_that_shrinks_by_nothing_or_up_to_the_threshold(
    high: float, stays: bool
) -> None:
    shown = replace(FOUND, gaps=gaps(gap(-1.0, high)), is_chancy=True, nats=70.0)

    assert bool(failures([RULES["shrinks_somewhere"]], shown)) is stays


def test_one_gap_that_may_shrink_is_enough_for_touches_that_are_likelier() -> None:
    no_smaller, open_yet = gap(-0.2, 0.1), gap(-0.1, 0.9)
    shown = replace(FOUND, gaps=gaps(no_smaller, open_yet), is_chancy=True, nats=70.0)

    assert decide(shown)[0] == Verdict.PARTLY_EXPLAINED


def test_touches_that_are_likelier_show_nothing_where_a_gap_stays_for_certain() -> None:
    stays, larger = gaps(gap(0.0, 0.1)), gaps(gap(-1.0, -0.9))
    likelier = replace(FOUND, is_chancy=True, nats=70.0)

    assert decide(replace(likelier, gaps=stays))[0] == Verdict.UNKNOWN
    assert decide(replace(likelier, gaps=larger))[0] == Verdict.PARTLY_EXPLAINED, "by luck"
    worse = {name: replace(one, grows=True) for name, one in larger.items()}
    assert "shrinks_somewhere" in {f.rule for f in failures(NAMES, replace(likelier, gaps=worse))}


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


def test_only_a_lack_of_touches_asks_for_those_that_named() -> None:
    assert shows_too_little(shrinking_by(0.0))
    assert not shows_too_little(shrinking_by(1.0))
    assert not shows_too_little(Evidence(gaps=gaps(GROWING)))  # no lack


def test_an_explained_gap_is_explained() -> None:
    assert decide(FOUND) == (Verdict.EXPLAINED, [])


@pytest.mark.parametrize(
    ("worse", "rule"),
    [
        (replace(FOUND, gaps=gaps(gap(0.5))), "shrinks"),
        (replace(FOUND, after=[left(SIGNIFICANT + 1.0, "feed")]), "leaves_nothing"),
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
        (replace(FOUND, gaps=gaps(gap(0.95), GROWING)), "grows_nowhere"),
        (replace(FOUND, everywhere=gaps(gap(0.95), GROWING)), "grows_nowhere"),
        (replace(FOUND, gaps=gaps(gap(0.95, tightness=0.1))), "is_as_wide"),
        (replace(FOUND, after=[left(20.0, "time", relative=3.0)]), "takes_most"),
        (replace(FOUND, at_limit=["backlash.backlash_um"]), "within_limits"),
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
        (replace(NOTHING, outlying=6, touches=30), "believed_few_outliers"),
    ],
)
def test_a_gap_in_which_nothing_was_found_is_unknown(other: Evidence, rule: str) -> None:
    verdict, failed = decide(other)

    assert verdict == Verdict.UNKNOWN
    assert [failure.rule for failure in failed] == [rule]


def test_touches_in_which_six_times_the_noise_could_have_hidden_are_undecided() -> None:
    verdict, failed = decide(replace(NOTHING, hidden=6.5))

    assert verdict == Verdict.UNDECIDED
    assert [failure.rule for failure in failed] == ["seen_enough"]


def test_few_touches_that_show_a_gap_all_the_same_are_not_undecided() -> None:
    assert decide(replace(NOTHING, hidden=6.5, after=[left(9.0)]))[0] == Verdict.UNKNOWN


def test_an_effect_that_was_found_needs_no_number_of_touches() -> None:
    assert decide(replace(FOUND, hidden=6.5))[0] == Verdict.EXPLAINED


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


def test_the_most_that_is_left_is_held_against_the_most_there_was_of_its_like() -> None:
    """A forest sees nine tenths of what a wave has: both are as they were."""
    both = [
        Left("grid", "plc", kind, ("time",), size, "µs", size, 1.0, 0.1, 30.0)
        for kind, size in (("wave", 50.0), ("shift", 45.0))
    ]

    as_it_was = replace(FOUND, before=[*FOUND.before, *both], after=both)
    halved = replace(as_it_was, after=[replace(both[0], size=40.0), replace(both[1], size=36.0)])
    seen_once = replace(as_it_was, after=[both[1]])

    assert failures([RULES["takes_most"]], as_it_was) == []
    assert len(failures([RULES["takes_most"]], halved)) == 1
    assert len(failures([RULES["takes_most"]], seen_once)) == 1


@pytest.mark.parametrize(
    ("unreached", "is_named"),
    [({"position", "deviation_skip"}, True), ({"position"}, False), ({"latch_skip"}, False)],
)
def test_what_a_finding_does_not_reach_it_does_not_leave(
    unreached: set[str], *, is_named: bool
) -> None:
    """Other touches are missed, and so others seen: what they show need not be just the same."""
    was, now = left(20.0, "feed", relative=4.0), left(20.0, "feed", relative=3.6)
    evidence = replace(FOUND, before=[was], after=[now], unreached=frozenset(unreached))

    assert (failures([RULES["takes_most"]], evidence) == []) is is_named


@pytest.mark.parametrize(("z", "is_gone"), [(20.0, False), (20.5, True)])
def test_touches_that_are_missed_no_more_are_a_gap_that_is_gone(z: float, *, is_gone: bool) -> None:
    """Of a quarter that was missed, by 20 standard errors, 4 of them could stay unseen."""
    quarter = replace(missing(z), size=0.25, relative=0.25)

    assert (failures([RULES["shrinks"]], Evidence(before=[quarter])) == []) is is_gone


def test_the_larger_share_that_is_missed_still_is_what_is_left() -> None:
    still = [missing(45.0), replace(missing(9.0), relative=0.01)]

    kept = Evidence(before=[missing(50.0)], after=still)
    assert len(failures([RULES["shrinks_somewhere"]], kept)) == 1


def test_one_path_on_which_no_touch_is_missed_any_more_is_enough_for_a_name() -> None:
    skip = replace(missing(50.0), path="skip")
    evidence = Evidence(before=[missing(50.0), skip], after=[missing(50.0)])

    assert failures([RULES["shrinks_somewhere"]], evidence) == []


def test_a_length_that_is_gone_is_no_share_of_touches() -> None:
    assert len(failures([RULES["shrinks_somewhere"]], Evidence(before=[left(50.0)]))) == 1
