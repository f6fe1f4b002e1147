"""Times that cannot be: a rig's clock that is wrong tells nothing of when now is."""

import os
import re
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path

import pytest

from refusals import refusal
from simulated_fleet import START, WEEK, Fleet
from skiplatch.errors import CampaignWarning
from skiplatch.fleet import clock
from skiplatch.fleet.findings import as_json, find, left_out_text
from skiplatch.fleet.history import History
from skiplatch.fleet.machine_texts import open_metrics
from skiplatch.fleet.origin import recorded_at
from skiplatch.report.fleet import as_html
from test_fleet_columns import recorded
from test_fleet_store import add, ask

NOW = START + 60 * WEEK
FAR = datetime(2099, 1, 1)  # noqa: DTZ001 - of a store


@pytest.fixture(autouse=True)
def _at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clock, "now", lambda: NOW)


def dated(folder: Path, when: str) -> Path:
    recorded(folder)
    with (folder / "nominal.toml").open("a") as file:
        file.write(f'[notes]\nrecorded_at = "{when}"\n')
    return folder


def test_a_time_that_is_still_to_come_is_told_by_the_folder_and_kept(tmp_path: Path) -> None:
    bad = dated(tmp_path / "a" / "bad", f"{FAR}Z")

    later = f'"{FAR}Z" is later than the clock of this machine, {NOW:%Y-%m-%dT%H:%M:%S} UTC'
    with pytest.warns(
        CampaignWarning, match=re.escape(f"{bad}/nominal.toml: recorded_at: {later}")
    ):
        assert recorded_at(bad) == FAR


def test_a_time_without_a_zone_may_be_that_of_any_zone(tmp_path: Path) -> None:
    ahead = NOW + timedelta(hours=13)

    assert recorded_at(dated(tmp_path / "local", f"{ahead}")) == ahead
    for place, time in (("utc", f"{ahead}Z"), ("far", f"{NOW + timedelta(hours=15)}")):
        with pytest.warns(CampaignWarning, match="later than"):
            recorded_at(dated(tmp_path / place, time))


def test_what_says_no_time_is_kept_with_that_of_its_file_or_now(tmp_path: Path) -> None:
    folder = recorded(tmp_path / "a" / "one")
    os.utime(folder / "touches.csv", (1e9, 1e9))
    assert recorded_at(folder).isoformat() == "2001-09-09T01:46:40"

    os.utime(folder / "touches.csv", (4e9, 4e9))
    assert recorded_at(folder) == NOW
    assert add(tmp_path / "store", folder) == 1


@pytest.mark.parametrize("text", ["", "touch,time\n1\n"])
def test_a_table_that_was_cut_meanwhile_has_the_time_of_its_file(tmp_path: Path, text: str) -> None:
    folder = recorded(tmp_path / "one")
    (folder / "touches.csv").write_text(text)
    os.utime(folder / "touches.csv", (1e9, 1e9))

    assert recorded_at(folder).isoformat() == "2001-09-09T01:46:40"


@pytest.fixture(scope="module")
def changed() -> History:
    """A fleet of which a rig changed in the end."""
    history, faults = Fleet(rigs=3, weeks=30, changing=1, wild=0.0).drawn(5)
    (fault,) = faults.values()
    return {rig: entries[: fault.week + 3] for rig, entries in history.items()}


def spoilt(history: History, time: datetime, verdict: str | None) -> History:
    """The fleet with a rig whose one campaign has this time."""
    last = next(iter(history.values()))[-1]
    one = replace(last, time=time, verdict=verdict, campaign="f" * 64, gaps={})
    return {**history, "zz": [one]}


@pytest.mark.parametrize("verdict", [None, "no_gap"])
def test_a_wrong_clock_that_is_in_a_store_does_not_set_now(
    changed: History, verdict: str | None
) -> None:
    right = find(changed, days=31.0, alarms_a_month=0.02)
    found = find(spoilt(changed, FAR, verdict), days=31.0, alarms_a_month=0.02)

    assert len(right.recent) == 1
    assert found.recent == right.recent
    assert (found.to_come, found.history) == (1, changed)
    later = "1 campaign is later than the clock of this machine"
    assert left_out_text(found) == f"{later}; 1 rig is not judged"
    assert as_json(found)["later_than_clock"] == 1
    assert "skiplatch_fleet_later_than_clock_campaigns 1.0" in open_metrics(found)
    assert "later than the clock" in as_html(found, store="works", weeks=52)


def test_only_what_is_diagnosed_sets_now(changed: History) -> None:
    later = spoilt(changed, NOW - timedelta(days=1), None)

    assert find(later, days=31.0, alarms_a_month=0.02).recent


def test_where_half_of_the_fleet_is_to_come_the_clock_is_wrong(
    changed: History, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = find(changed, days=31.0, alarms_a_month=0.02)
    monkeypatch.setattr(clock, "now", lambda: START + 2 * WEEK)

    found = find(changed, days=31.0, alarms_a_month=0.02)

    assert found.recent == right.recent
    assert (found.to_come, found.history) == (0, changed)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("2025-03-01T24:00:00Z", "2025-03-02T00:00:00"),
        ("2025-12-31 24:00", "2026-01-01T00:00:00"),
        ("2016-12-31T23:59:60Z", "2017-01-01T00:00:00"),
        ("2017-01-01T00:59:60.5+01:00", "2017-01-01T00:00:00.500000"),
    ],
)
def test_the_end_of_a_day_and_a_leap_second_are_times(
    tmp_path: Path, written: str, meant: str
) -> None:
    assert recorded_at(dated(tmp_path / "one", written)).isoformat() == meant


@pytest.mark.parametrize("written", ["2025-03-01T24:00:01", "2025-03-01T24:30", "2025-03-01T60:00"])
def test_what_is_no_time_is_refused(tmp_path: Path, written: str) -> None:
    assert "expected a date and time" in refusal(recorded_at, dated(tmp_path / "one", written))


def test_a_campaign_is_as_old_as_its_earliest_stamp(tmp_path: Path) -> None:
    folder = recorded(tmp_path / "one")
    (folder / "touches.csv").write_text(
        "touch,time,feed_mm_min,deviation_um\n"
        "1,2025-03-01T12:00:00+02:00,1,2\n2,,1,2\n3,2025-03-01T09:30:00Z,1,2\n"
    )

    assert recorded_at(folder).isoformat() == "2025-03-01T09:30:00"


def test_a_date_before_the_year_1000_is_kept_and_read(tmp_path: Path) -> None:
    store = tmp_path / "store"
    add(store, dated(tmp_path / "a" / "one", "0987-06-01T00:00:00"))

    assert ask(store, "SELECT month FROM touches JOIN campaigns USING (campaign, month)") == [
        ("0987-06",)
    ]


def test_a_clock_that_falls_back_is_warned_of(tmp_path: Path) -> None:
    rig, store = tmp_path / "mill-7", tmp_path / "store"
    with pytest.warns(CampaignWarning, match="later than"):
        add(store, dated(rig / "ahead", f"{FAR}Z"))
    add(store, dated(rig / "old", "2020-01-01"))
    add(store, dated(rig / "new", "2025-01-01"), dated(rig / "older", "2023-06-01"))

    old = "1970-01-01T00:00:09 is over 2 years before the newest campaign of its rig, 2025-01-01"
    with pytest.warns(CampaignWarning, match=old):
        add(store, dated(rig / "fallen", "1970-01-01T00:00:09"))
    assert add(store, dated(tmp_path / "mill-8" / "fallen", "1970-01-01T00:00:09")) == 1
