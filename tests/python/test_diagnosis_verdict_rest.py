"""How much of a gap may be left for its cause to be named: the rule `takes_most`."""

from dataclasses import replace

import numpy as np
import pytest

from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.rules import NAMES
from skiplatch.diagnosis.verdict.verdict import failures
from verdict_evidence import left

(TAKES_MOST,) = (rule for rule in NAMES if rule.name == "takes_most")


def of_kind(kind: str, z: float, size: float, relative: float, *conditions: str) -> Left:
    return replace(left(z, *conditions, relative=relative), kind=kind, size=size)


def test_what_is_no_more_than_an_accident_may_be_most_of_a_gap() -> None:
    accident = Evidence(before=[left(20.0, relative=4.0)], after=[left(4.0, relative=3.5)])

    assert failures([TAKES_MOST], accident) == []


def test_a_gap_where_there_was_none_is_all_of_it() -> None:
    new = Evidence(after=[left(4.000001, relative=0.3)])

    (failure,) = failures([TAKES_MOST], new)
    assert failure.words == "it leaves 0.3 µm of position, much of what was there"


def test_where_nothing_was_hardly_anything_is_much() -> None:
    new = Evidence(after=[left(20.0, relative=0.05)])

    assert len(failures([TAKES_MOST], new)) == 1


@pytest.mark.parametrize("size", [98.0, 100.0, 102.0])
def test_what_is_as_large_as_before_within_two_percent_is_not_touched(size: float) -> None:
    before = [left(20.0, relative=100.0)]

    untouched = Evidence(before=before, after=[left(20.0, relative=size)])
    assert failures([TAKES_MOST], untouched) == []


@pytest.mark.parametrize("size", [97.9, 102.1])
def test_what_is_more_than_two_percent_off_what_it_was_is_touched(size: float) -> None:
    touched = Evidence(before=[left(20.0, relative=100.0)], after=[left(20.0, relative=size)])

    assert len(failures([TAKES_MOST], touched)) == 1


def test_the_largest_of_its_like_is_what_was_there() -> None:
    before = [left(20.0, relative=size) for size in (4.0, 1.0)]
    half = Evidence(before=before, after=[left(20.0, relative=2.0)])

    assert failures([TAKES_MOST], half) == []


@pytest.mark.parametrize(("size", "is_much"), [(3.17, True), (3.16, False)])
def test_what_is_a_tenth_of_the_variance_of_all_is_much(size: float, *, is_much: bool) -> None:
    """The root of a tenth of 10 µm squared is 3.162 µm."""
    before = [left(20.0, "feed", relative=10.0), of_kind("scatter", 20.0, 4.0, 4.0, "feed")]
    evidence = Evidence(before=before, after=[of_kind("scatter", 9.0, size, size, "feed")])

    assert (failures([TAKES_MOST], evidence) != []) == is_much


def test_like_is_held_against_like_in_its_own_unit() -> None:
    """A wave that stays is not made small by a scatter that was larger, nor by noise made up."""
    before = [of_kind("scatter", 30.0, 5.5, 8.0), of_kind("shift", 9.0, 2.0, 2.0, "time")]
    stays = Evidence(before=before, after=[of_kind("wave", 9.0, 1.9, 0.3, "time, in waves")])
    goes = Evidence(before=before, after=[of_kind("wave", 9.0, 0.9, 0.9, "time, in waves")])

    assert len(failures([TAKES_MOST], stays)) == 1
    assert failures([TAKES_MOST], goes) == []


def test_just_half_of_the_variance_is_not_more_than_half() -> None:
    whole = float(np.sqrt(98.0))
    assert whole**2 == 98.0  # what is rounded here cancels out

    half = Evidence(before=[left(20.0, relative=whole)], after=[left(20.0, relative=7.0)])
    assert failures([TAKES_MOST], half) == []


def test_what_is_little_of_all_that_was_there_need_not_go() -> None:
    """A form that is somewhat off leaves scatter that there was hardly any of before."""
    before = [
        of_kind("shift", 20.0, 21.0, 70.0, "feed"),
        of_kind("scatter", 20.0, 0.9, 3.2, "feed"),
    ]
    rest = [of_kind("scatter", 14.0, 0.7, 2.4, "feed")]

    assert failures([TAKES_MOST], Evidence(before=before, after=rest)) == []


def test_what_shows_only_now_is_held_against_all_that_was_there() -> None:
    before = [of_kind("scatter", 30.0, 8.0, 8.0), of_kind("scatter", 30.0, 1.0, 1.0)]
    faint, strong = (of_kind("shift", 9.0, 6.0, size, "feed") for size in (5.0, 6.0))

    assert failures([TAKES_MOST], Evidence(before=before, after=[faint])) == []
    assert len(failures([TAKES_MOST], Evidence(before=before, after=[strong]))) == 1
