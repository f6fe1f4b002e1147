"""What moves steadily is told as such, with its rate, and what moves in steps is not."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import timedelta

import numpy as np
import pytest

from simulated_fleet import START, WEEK, Fault, Fleet
from skiplatch.fleet.budget import MONTH
from skiplatch.fleet.changes import Change, find_changes
from skiplatch.fleet.drift import MOST_DATES, Drift, drift
from skiplatch.fleet.findings import change_text, find
from skiplatch.fleet.history import History
from skiplatch.report.fleet import as_html
from skiplatch.statistics import proportion
from test_diagnosis_report import prose

YEAR = 52
BEGUN, SEEN = 20, 30
A_WEEK = 0.3
A_MONTH = A_WEEK * (MONTH / WEEK)
SLOW = Fleet(takes=40, sizes=(6.0, 12.0), wild=0.0)


def told(gaps: np.ndarray, steps: Sequence[int] = (BEGUN,), pace: timedelta = WEEK) -> Drift | None:
    return drift([START + day * pace for day in range(len(gaps))], gaps, list(steps), SEEN)


def risen(seed: int, *, end: int = YEAR, weeks: int = YEAR) -> np.ndarray:
    """Gaps that grow from one week to another, with a scatter of 0.2."""
    grown = A_WEEK * np.clip(np.arange(weeks) - BEGUN, 0.0, end - BEGUN)
    return np.random.default_rng(seed).normal(1.0, 0.2, weeks) + grown


def test_a_steady_growth_has_its_rate_and_its_beginning() -> None:
    found = told(risen(1), [BEGUN + 3, BEGUN + 12])

    assert found is not None
    assert found.rate.low < A_MONTH < found.rate.high < 1.1 * A_MONTH
    assert found.earliest <= BEGUN <= found.latest < BEGUN + 4
    assert found.end is None
    assert found.before == pytest.approx(1.0, abs=0.1)
    assert found.after == pytest.approx(1.0 + A_WEEK * (YEAR - 1 - BEGUN), abs=0.3)


def test_what_shrinks_has_a_negative_rate() -> None:
    found = told(-risen(1))

    assert found is not None
    assert found.rate.low < -A_MONTH < found.rate.high < 0.0


def test_a_growth_that_ended_has_its_end() -> None:
    found = told(risen(2, end=40))

    assert found is not None
    assert found.end is not None
    assert abs(found.end - 40) <= 1
    assert found.rate.low < A_MONTH < found.rate.high


def test_the_interval_holds_the_rate_as_often_as_it_says() -> None:
    found = [told(risen(seed)) for seed in range(200)]

    holds = sum(one is not None and one.rate.low <= A_MONTH <= one.rate.high for one in found)
    assert proportion(holds, len(found), 0.99).high > 0.95
    assert holds == 185  # as docs/FLEET.md says


@pytest.mark.parametrize("steps", [(BEGUN,), (BEGUN, 33)])
def test_steps_are_no_growth(steps: tuple[int, ...]) -> None:
    for seed in range(100):
        gaps = np.random.default_rng(seed).normal(1.0, 0.2, YEAR)
        for step in steps:
            gaps[step:] += 2.0
        assert told(gaps, steps) is None


def test_two_campaigns_tell_no_growth() -> None:
    gaps = np.ones(YEAR)
    gaps[-2:] += [2.0, 4.0]

    assert told(gaps, [YEAR - 2]) is None


def test_times_of_campaigns_count_and_equal_ones_do_no_harm() -> None:
    assert told(risen(1), pace=timedelta()) is None
    found = told(risen(1), pace=timedelta(days=1))
    assert found is not None
    assert found.rate.low < 7.0 * A_MONTH < found.rate.high


def test_thousands_of_campaigns_are_as_well_told() -> None:
    weeks = 5 * MOST_DATES
    found = told(risen(3, end=weeks, weeks=weeks))

    assert found is not None
    assert found.rate.low < A_MONTH < found.rate.high


@pytest.fixture(scope="module")
def slow() -> tuple[History, dict[str, Fault], list[Change]]:
    """Rigs whose gaps grow over 40 weeks."""
    history, faults = replace(SLOW, rigs=30, changing=6, last=20).drawn(2)
    return history, faults, find_changes(history)


def test_a_slow_drift_is_one_change_with_its_rate(
    slow: tuple[History, dict[str, Fault], list[Change]],
) -> None:
    _, faults, changes = slow

    assert {change.rig for change in changes} == set(faults)
    assert len(changes) == len(faults)
    for change in changes:
        fault = faults[change.rig]
        a_month = fault.size / fault.takes * fault.observable.scatter * (MONTH / WEEK)
        assert change.rate is not None
        assert change.rate.value == pytest.approx(a_month, rel=0.2)
        assert change.last_before < change.began <= change.seen
        assert change.news == change.confirmed
        assert change.news >= change.seen
        assert change.growth is not None
        assert change.growth.effect == fault.observable.effect


def test_a_rate_is_told_in_the_line_and_on_the_page(
    slow: tuple[History, dict[str, Fault], list[Change]],
) -> None:
    history, _, changes = slow
    page = prose(as_html(find(history, days=400.0, alarms_a_month=0.02), store="s", weeks=YEAR))

    for change in changes:
        assert change.rate is not None
        words = f"{change.observable} gap grew steadily, by {change.rate.value:.3g} ("
        assert change_text(change).startswith(f"{change.rig}: {words}")
        assert f"Its {words}" in page
        assert f") {change.unit} a month, from " in page
        assert f"; now {change.newest:.3g} {change.unit}; " in page


def test_a_growth_that_ended_says_until_when(
    slow: tuple[History, dict[str, Fault], list[Change]],
) -> None:
    change = replace(slow[2][0], ended=START)

    assert f"grew steadily until {START:%Y-%m-%d}, by " in change_text(change)


@dataclass
class Told:
    """How many of the rigs that changed are told, and how many so as one steady growth."""

    changed: int = 0
    found: int = 0
    steadily: int = 0


def score(fleet: Fleet, seeds: Sequence[int]) -> Told:
    counts = Told()
    for seed in seeds:
        history, faults = fleet.drawn(seed)
        changes = find_changes(history)
        for rig in faults:
            own = [change for change in changes if change.rig == rig]
            counts.changed += 1
            counts.found += bool(own)
            counts.steadily += any(change.rate is not None for change in own)
    return counts


@pytest.mark.long
def test_drifts_and_steps_are_told_apart_in_many_fleets(
    record_property: Callable[[str, object], None],
) -> None:
    drifts, steps = score(SLOW, range(100, 110)), score(Fleet(), range(100, 110))

    print(drifts, steps)
    record_property("drifts", str(drifts))
    assert drifts.steadily >= 0.9 * drifts.found
    assert steps.steadily == 0
