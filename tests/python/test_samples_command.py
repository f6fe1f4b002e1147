"""``skiplatch samples``: the campaigns that examples name, without a checkout."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from conftest import SAMPLES
from skiplatch.campaign import read_campaign
from skiplatch.cli import group


def test_examples_find_the_samples_where_they_were_copied_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["samples", "--out", "scripts/samples", "--json", "s.json"]

    said = CliRunner().invoke(group, words, catch_exceptions=False)
    checked = CliRunner().invoke(group, ["check", "scripts/samples/bench_isr_latency"])

    assert (said.exit_code, checked.exit_code) == (0, 0)
    folders = json.loads(Path("s.json").read_text())["folders"]
    assert {"bench_isr_latency", "machine_no_gap", "plans"} <= set(folders)
    copied = read_campaign("scripts/samples/machine_no_gap")
    assert copied.fingerprint == read_campaign(SAMPLES / "machine_no_gap").fingerprint
    files = [p.relative_to(SAMPLES) for p in SAMPLES.rglob("*") if p.is_file()]
    assert all((tmp_path / "scripts" / "samples" / path).is_file() for path in files)


def test_a_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("")

    said = CliRunner().invoke(group, ["samples", "--out", str(tmp_path)])

    assert said.exit_code != 0
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]


def test_every_extra_stands_in_the_page_of_packages() -> None:
    project = tomllib.loads(Path("scripts/pyproject.toml").read_text())["project"]
    _, _, section = Path("docs/PACKAGES.md").read_text().partition("## The Python package")
    table = re.findall(r"^\| (`.*`) \|", section.partition("## What is stable")[0], re.M)

    assert set(re.findall(r"`(\w+)`", " ".join(table))) == set(project["optional-dependencies"])
