"""Rigs of which nothing can be said pass no check, and names of rigs that look the same."""

import json
from collections.abc import Sequence
from datetime import timedelta
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from simulated_fleet import START, WEEK
from skiplatch.errors import CampaignWarning
from skiplatch.fleet import clock
from skiplatch.fleet.alike import SharedCause
from skiplatch.fleet.findings import shared_text
from test_fleet_clock import FAR, NOW, dated
from test_fleet_rotary import diagnosis
from test_fleet_store import add, ask
from test_fleet_told import fleet

FEW, MANY = 5, 6


@pytest.fixture(autouse=True)
def _at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clock, "now", lambda: NOW)


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


def weekly(rig: Path, campaigns: int, *, diagnosed: bool = True) -> Sequence[Path]:
    folders = [dated(rig / f"{week}", f"{START + week * WEEK}Z") for week in range(campaigns)]
    for week, folder in enumerate(folders):
        if diagnosed:
            (folder / "diagnosis.json").write_text(diagnosis(2.0 + 0.01 * (week % 3)))
    return folders


def test_what_cannot_be_judged_is_skipped_named_and_counted(tmp_path: Path, store: Path) -> None:
    add(store, *weekly(tmp_path / "judged", MANY), *weekly(tmp_path / "few", FEW))
    add(store, *weekly(tmp_path / "never", MANY, diagnosed=False))
    with pytest.warns(CampaignWarning, match="later than"):
        add(store, dated(tmp_path / "ahead" / "one", f"{FAR + timedelta(days=1)}Z"))
    outputs = ["--junit", tmp_path / "fleet.xml", "--metrics", tmp_path / "fleet.prom"]

    result = fleet("check", "--store", store, *outputs, "--json", "-")

    why = {
        "ahead": "all campaigns are later than the clock of this machine",
        "few": "fewer than 6 campaigns have a diagnosis",
        "never": "no campaign has a diagnosis",
    }
    for rig, reason in why.items():
        assert f"not judged: {reason}: {rig}\n" in result.stderr
    assert result.stderr.splitlines()[-1].startswith("4 rigs, 0 changed")
    assert "; 3 rigs are not judged" in result.stderr
    document = json.loads(result.stdout)
    assert document["rigs"] == 4
    assert {one["rig"]: one["why"] for one in document["not_judged"]} == why
    suite = ET.parse(tmp_path / "fleet.xml").getroot()  # noqa: S314 - written just now
    assert (suite.get("tests"), suite.get("failures"), suite.get("skipped")) == ("4", "0", "3")
    cases = {case.get("name"): case.find("skipped") for case in suite}
    assert {name: case.get("message") for name, case in cases.items() if case is not None} == why
    metrics = (tmp_path / "fleet.prom").read_text()
    assert "skiplatch_fleet_rigs 4.0" in metrics
    assert "skiplatch_fleet_unjudged_rigs 3.0" in metrics


def test_names_of_rigs_that_look_the_same_are_one(tmp_path: Path, store: Path) -> None:
    folders = weekly(tmp_path / "any", 3)
    for folder, name in zip(folders, ["Fräse", "Fra\u0308se", " Fräse "], strict=True):
        add(store, folder, rig=name)

    assert ask(store, "SELECT rig, count(*) FROM campaigns GROUP BY ALL") == [("Fräse", 3)]
    assert len(json.loads(show(store, "Fra\u0308se"))["campaigns"]) == 3


def show(store: Path, rig: str) -> str:
    return fleet("show", rig, "--store", store, "--json", "-").stdout


def test_names_of_rigs_that_differ_in_case_alone_are_warned_of(tmp_path: Path, store: Path) -> None:
    first, second, third = weekly(tmp_path / "any", 3)
    add(store, first, rig="mill-7")

    with pytest.warns(CampaignWarning, match='rig "Mill-7" differs from "mill-7" in case only'):
        add(store, second, rig="Mill-7")
    assert add(store, third, rig="Mill-7") == 1


def test_the_days_of_a_shared_cause_are_those_of_its_beginnings() -> None:
    shared = SharedCause("backlash", "position", ["a", "b"], START, START + 2 * WEEK)

    assert shared_text(shared) == "backlash (position stage) grew on a, b, began within 14 days"
