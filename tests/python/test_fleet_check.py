"""Changes of rigs: found in a simulated fleet, no more false alarms than stated, and told."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import scipy.stats
from click.testing import CliRunner, Result
from prometheus_client import Metric
from prometheus_client.openmetrics.parser import text_string_to_metric_families

from documents import ROOT, examples
from simulated_fleet import DEVIATION, START, WEEK, Fault, Fleet
from skiplatch.cli import group
from skiplatch.commands import fleet_check
from skiplatch.comparison.observables import ALL_OBSERVABLES
from skiplatch.fleet.budget import MONTH, levels
from skiplatch.fleet.changes import Change, find_changes
from skiplatch.fleet.chart import shifts
from skiplatch.fleet.findings import change_text, find
from skiplatch.fleet.growth import Growth
from skiplatch.fleet.history import History
from skiplatch.fleet.machine_texts import open_metrics
from skiplatch.statistics import Interval, proportion

WITHIN = 3
"""Campaigns within which a change is to be found."""


@dataclass(frozen=True)
class Score:
    """What was found of fleets' faults, and what was not there."""

    found: int
    faults: int
    false_alarms: list[int]


def false_alarms(changes: Sequence[Change], history: History, faults: dict[str, Fault]) -> int:
    """Count what was seen on rigs that had not changed, or not yet."""
    return sum(
        change.rig not in faults or change.seen < history[change.rig][faults[change.rig].week].time
        for change in changes
    )


def is_found(changes: Sequence[Change], history: History, rig: str, fault: Fault) -> bool:
    """Tell whether a fault was seen within so many campaigns, and dated right to one campaign."""
    times = [entry.time for entry in history[rig]]
    began, latest = times[fault.week], times[fault.week + WITHIN - 1]
    return any(
        change.rig == rig
        and began <= change.seen <= latest
        and abs(times.index(change.began) - fault.week) <= 1
        for change in changes
    )


def score(fleet: Fleet, seeds: Sequence[int]) -> Score:
    found, faults, alarms = 0, 0, []
    for seed in seeds:
        history, changed = fleet.drawn(seed)
        changes = find_changes(history)
        found += sum(is_found(changes, history, *fault) for fault in changed.items())
        faults += len(changed)
        alarms.append(false_alarms(changes, history, changed))
    return Score(found, faults, alarms)


def test_eight_changed_rigs_of_two_hundred_are_found_and_no_other() -> None:
    scored = score(Fleet(wild=0.0), [1])

    assert (scored.found, scored.faults) == (8, 8)
    assert scored.false_alarms == [0]


@pytest.mark.parametrize(
    ("wild", "least_share"),
    [
        pytest.param(0.0, 0.97, marks=pytest.mark.nightly),
        pytest.param(0.003, 0.93, marks=pytest.mark.long),
    ],
)
def test_changes_are_found_in_many_fleets(
    wild: float, least_share: float, record_property: Callable[[str, object], None]
) -> None:
    scored = score(Fleet(wild=wild), range(100, 120))

    share = proportion(scored.found, scored.faults)
    alarms = sum(scored.false_alarms)
    most = float(scipy.stats.chi2.ppf(0.975, 2 * (alarms + 1))) / 2.0 / len(scored.false_alarms)
    words = f"{share.value:.3f} ({share.low:.3f} … {share.high:.3f})"
    print(f"found {words}; false alarms {alarms} in 20 years, at most {most:.2f} a year")
    record_property("found", words)
    assert share.low > least_share
    assert max(scored.false_alarms) <= 1
    assert most < 1.0


@pytest.mark.parametrize("tails", [8.0, 4.0])
def test_false_alarms_stay_within_a_generous_budget(tails: float) -> None:
    """With 3 a month expected of 400 charts over a year, 36 of them at most, which is tellable."""
    rng = np.random.default_rng(5)
    times = [START + week * WEEK for week in range(52)]
    level = levels(times, 400, 3.0)

    alarms = sum(len(shifts(rng.standard_t(tails, 52), level)) for _ in range(400))

    assert 2 <= alarms <= 36


def test_budget_is_spent_by_time_whatever_the_pace() -> None:
    weekly = levels([START + week * WEEK for week in range(53)], 10, 0.5)
    hourly = levels([START + timedelta(hours=hour) for hour in range(52 * 7 * 24 + 1)], 10, 0.5)

    assert weekly.sum() == pytest.approx(hourly.sum())
    assert weekly.sum() * 10 == pytest.approx(0.5 * (52 * WEEK / MONTH))


def test_a_pause_is_not_worth_more_than_a_month() -> None:
    later = levels([START, START + timedelta(days=900)], 1, 0.5)

    assert later.tolist() == [0.0, 0.5]


def flat(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, 1.0, count)


def test_a_step_is_dated_where_it_is() -> None:
    values = flat(40)
    values[25:] += 8.0

    (found,) = shifts(values, np.full(40, 1e-6))

    assert (found.start, found.began, found.end) == (0, 25, 40)
    assert found.seen in (26, 27)


def test_a_slow_drift_is_found_too() -> None:
    values = flat(60) + 0.15 * np.maximum(np.arange(60) - 20.0, 0.0)

    assert shifts(values, np.full(60, 1e-5))


def test_a_wild_value_is_no_change_however_wild() -> None:
    for at in range(4, 40):
        values = flat(40, seed=at)
        values[at] = 1e6

        assert shifts(values, np.full(40, 1e-6)) == []


def test_a_repair_is_a_change_as_well() -> None:
    values = flat(60)
    values[20:40] += 9.0

    assert [found.began for found in shifts(values, np.full(60, 1e-6))] == [20, 40]


@pytest.mark.parametrize("count", [0, 1, 5])
def test_few_values_tell_nothing(count: int) -> None:
    assert shifts(np.arange(count, dtype=float), np.ones(count)) == []


def test_equal_values_do_not_change() -> None:
    assert shifts(np.ones(30), np.full(30, 0.1)) == []


@pytest.fixture(scope="module")
def small() -> tuple[History, dict[str, Fault]]:
    """A fleet of twenty rigs of which three change for the worse."""
    return Fleet(rigs=20, changing=3, wild=0.0).drawn(8)


def test_a_change_says_which_effect_grew(small: tuple[History, dict[str, Fault]]) -> None:
    history, faults = small
    findings = find(history, days=400.0, alarms_a_month=0.02)

    assert {change.rig for change in findings.recent} == set(faults)
    for change in findings.recent:
        fault = faults[change.rig]
        assert change.growth is not None
        assert (change.observable, change.unit) == (fault.observable.name, fault.observable.unit)
        assert (change.growth.effect, change.stage) == (
            fault.observable.effect,
            fault.observable.stage,
        )
        true = fault.size * fault.observable.scatter
        assert change.growth.before.value == 0.0
        assert change.growth.after.low < true * 1.05
        assert change.growth.after.high > true * 0.95
        assert change.last_before < change.began <= change.seen


def test_rigs_that_share_a_cause_are_put_together(
    small: tuple[History, dict[str, Fault]],
) -> None:
    history, faults = small
    findings = find(history, days=400.0, alarms_a_month=0.02)

    by_effect: dict[str, list[str]] = {}
    for rig, fault in sorted(faults.items(), key=lambda item: item[1].week):
        by_effect.setdefault(fault.observable.effect, []).append(rig)
    several = {effect: rigs for effect, rigs in by_effect.items() if len(rigs) > 1}
    assert several
    assert {shared.effect: shared.rigs for shared in findings.shared} == several


def test_a_rig_unlike_the_others_is_named() -> None:
    history, _ = Fleet(rigs=30, changing=0, wild=0.0).drawn(3)
    for entry in history["rig-011"]:
        gap = entry.gaps[DEVIATION.name]
        object.__setattr__(gap, "before", gap.before + 40.0)

    findings = find(history, days=31.0, alarms_a_month=0.02)

    assert [(one.rig, one.observable) for one in findings.unlike] == [("rig-011", DEVIATION.name)]
    assert findings.unlike[0].gap > 40.0 > findings.unlike[0].usual
    assert findings.changes == []


def test_old_changes_are_no_news(small: tuple[History, dict[str, Fault]]) -> None:
    history, _ = small
    changes = find_changes(history)
    newest = max(entries[-1].time for entries in history.values())
    days = (newest - changes[-1].seen) / timedelta(days=1)

    found = find(history, days=days + 0.01, alarms_a_month=0.02)
    assert (found.recent, found.shared) == ([changes[-1]], [])
    assert find(history, days=max(days - 0.01, 0.001), alarms_a_month=0.02).recent == []


def parsed(metrics: str) -> list[Metric]:
    """Read OpenMetrics text as strictly as its own parser does."""
    return list(text_string_to_metric_families(metrics))  # type: ignore[no-untyped-call]


def test_what_the_gap_is_now_is_told_beside_the_mean_since(
    small: tuple[History, dict[str, Fault]],
) -> None:
    history, _ = small

    for change in find_changes(history):
        newest = history[change.rig][-1].gaps[change.observable].before
        assert change.newest == newest
        assert (f"; now {newest:.3g} {change.unit}" in change_text(change)) == (not change.back)


@pytest.fixture
def checked(
    small: tuple[History, dict[str, Fault]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Result]:
    """The command on the small fleet, whose history stands in for that of a store."""
    monkeypatch.setattr(fleet_check, "read_history", lambda _: small[0])
    sample = "scripts/samples/rig_nominal"
    store = ["--store", str(tmp_path / "store")]
    runner = CliRunner()
    root = Path(__file__).parents[2]
    added = runner.invoke(group, ["fleet", "add", str(root / sample), "--rig", "a", *store])
    assert added.exit_code == 0, added.output

    def call(*options: str) -> Result:
        words = ["fleet", "check", *store, *options]
        return runner.invoke(group, words, catch_exceptions=False)

    return call


def test_command_says_each_change_in_a_line(
    checked: Callable[..., Result], small: tuple[History, dict[str, Fault]], tmp_path: Path
) -> None:
    out = [tmp_path / name for name in ("x.json", "x.xml", "x.prom")]
    options = zip(("--json", "--junit", "--metrics"), map(str, out), strict=True)
    result = checked("--days", "400", *(word for pair in options for word in pair))

    assert result.exit_code == 1
    for rig, fault in small[1].items():
        (line,) = [line for line in result.output.splitlines() if line.startswith(f"{rig}: ")]
        assert f"{fault.observable.effect}.{fault.observable.parameter} 0 → " in line
    document = json.loads(out[0].read_text())
    assert {change["rig"] for change in document["changed"]} == set(small[1])
    assert all(len(change["course"]) > 1 for change in document["changed"])
    assert [datetime.fromisoformat(change["seen"]) for change in document["changed"]]
    suite = ET.fromstring(out[1].read_text())  # noqa: S314 - written by this very test
    assert (suite.get("tests"), suite.get("failures")) == ("20", "3")
    failed = {case.get("name") for case in suite if case.find("failure") is not None}
    assert failed == set(small[1])
    families = {one.name: one for one in parsed(out[2].read_text())}
    assert families["skiplatch_fleet_changed_rigs"].samples[0].value == 3.0
    assert len(families["skiplatch_fleet_rig_gap_um"].samples) == 20


def test_line_of_the_page_is_that_of_such_a_change() -> None:
    (page,) = [one for one in examples(ROOT / "docs/FLEET.md") if "fleet check" in one.text]
    latency = Growth(
        "isr_latency", "latch", "latency_us", Interval(0.0, 0.0, 0.0), Interval(4.9, 4.7, 5.1)
    )
    last, began, seen = (datetime(2026, 3, day) for day in (2, 9, 16))  # noqa: DTZ001 - of a store

    gap = "latch_after_edge_us", "µs", 0.6, 4.1
    change = Change("mill-7", *gap, last, began, seen, 2, "latch", latency, newest=4.3)

    assert gap[0] in {one.name for one in ALL_OBSERVABLES}

    assert change_text(change) == page.output.rstrip()


def test_command_ends_well_if_nothing_changed_lately(checked: Callable[..., Result]) -> None:
    result = checked("--days", "0.001")

    assert result.exit_code == 0
    assert "20 rigs, 0 changed" in result.output


def test_names_of_rigs_are_escaped_for_machines(small: tuple[History, dict[str, Fault]]) -> None:
    odd = 'a"b\\c <é>'
    entries = next(iter(small[0].values()))
    findings = find({odd: entries}, days=31.0, alarms_a_month=0.02)

    families = parsed(open_metrics(findings))
    rigs = {sample.labels.get("rig") for one in families for sample in one.samples}
    assert rigs == {odd, None}
