"""What `fleet add` and `fleet watch` say of what they took, and of what they refused."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from refusals import refusal
from skiplatch.cli import group
from skiplatch.fleet.reading import opened
from test_fleet_columns import recorded
from test_fleet_rotary import diagnosis
from test_fleet_store import ask


@pytest.fixture
def good(tmp_path: Path) -> Path:
    """A campaign with a diagnosis."""
    folder = recorded(tmp_path / "mill-7" / "good")
    (folder / "diagnosis.json").write_text(diagnosis(2.0))
    return folder


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    folder = recorded(tmp_path / "mill-7" / "bad")
    (folder / "touches.csv").write_text("touch\nx\n")
    return folder


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


def fleet(*words: object) -> Result:
    return CliRunner().invoke(group, ["fleet", *map(str, words)], catch_exceptions=False)


def test_what_was_taken_is_told_beside_what_was_refused(good: Path, bad: Path, store: Path) -> None:
    result = fleet("add", bad, good, "--store", store, "--json", "-")

    assert result.exit_code == 2
    document = json.loads(result.stdout)
    assert [one["path"] for one in document["added"]] == [str(good)]
    (refused,) = document["refused"]
    assert refused["path"] == str(bad)
    assert refused["why"].startswith(f"{bad}/touches.csv:2: touch: expected")
    first, last = result.stderr.splitlines()
    assert first == f"skiplatch: {refused['why']}"
    assert last == f"{store}: 1 campaign of 1 rig added, 0 known already, 1 refused"


def test_where_all_are_refused_that_is_told_and_no_store_made(
    bad: Path, store: Path, tmp_path: Path
) -> None:
    out = tmp_path / "added.json"
    result = fleet("add", bad, "--store", store, "--json", out)

    assert result.exit_code == 2
    document = json.loads(out.read_text())
    assert (document["added"], len(document["refused"])) == ([], 1)
    assert "0 campaigns of 0 rigs added, 0 known already, 1 refused" in result.stdout
    assert not store.exists()


def test_a_diagnosis_that_came_later_adds_no_campaign(good: Path, store: Path) -> None:
    fleet("add", good, "--store", store)
    (good / "diagnosis.json").write_text(diagnosis(3.0))

    result = fleet("add", good, "--store", store, "--json", "-")

    document = json.loads(result.stdout)
    assert (document["added"], len(document["replaced"]), document["known"]) == ([], 1, 0)
    assert "0 campaigns of 0 rigs added, 1 replaced, 0 known already" in result.stderr
    assert ask(store, "SELECT gap_um FROM campaigns") == [(3.0,)]


def test_a_folder_is_called_as_in_the_table(good: Path, store: Path) -> None:
    (added,) = json.loads(fleet("add", good, "--store", store, "--json", "-").stdout)["added"]

    assert ask(store, "SELECT folder FROM campaigns") == [(added["folder"],)]


def test_a_watch_tells_what_it_took_and_what_it_refused(good: Path, bad: Path, store: Path) -> None:
    words = ["--store", store, "--once", "--settle-s", "1e-9", "--json", "-"]
    result = fleet("watch", good.parent, *words)

    assert result.exit_code == 2
    document = json.loads(result.stdout)
    assert document["kept"] == [str(good)]
    assert [one["path"] for one in document["refused"]] == [str(bad)]
    assert (document["known"], document["not_whole"]) == (0, 0)
    assert result.stderr.endswith("1 kept, 0 known already, 1 refused, 0 not whole yet\n")


def test_a_rig_of_too_many_bytes_is_told_what_holds(good: Path, store: Path) -> None:
    assert fleet("add", good, "--store", store, "--rig", "机" * 26).exit_code == 0

    result = fleet("add", good, "--store", store, "--rig", "机" * 27)

    bytes_ = "expected a name of at most 240 bytes as the name of a folder, got 243, where each"
    assert (
        f"rig: {bytes_} byte that is not of an ASCII letter or digit takes three" in result.stderr
    )


def export(store: Path, name: str) -> str:
    with opened(store, with_touches=False) as reader:
        return refusal(reader.export, name, store.parent / "out").removeprefix(f"{store}: ")


def test_folders_and_keys_that_are_called_so_are_told_apart(tmp_path: Path, store: Path) -> None:
    folders = [recorded(tmp_path / f"rig-{number}" / "monday") for number in range(12)]
    fleet("add", *folders, "--store", store)
    firsts = [key[0] for (key,) in ask(store, "SELECT campaign FROM campaigns")]
    digit = max(firsts, key=firsts.count)
    number = firsts.count(digit)

    assert export(store, "monday") == '12 campaigns are called "monday"'
    assert export(store, digit) == f'{number} keys begin so: "{digit}"'
    fleet("add", recorded(tmp_path / "mill-7" / digit), "--store", store)
    assert export(store, digit) == f'1 campaign is called "{digit}", and {number} keys begin so'
    assert export(store, "none") == 'no campaign is called "none"'
