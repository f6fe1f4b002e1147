"""Campaigns that were kept before: versions of one, their diagnoses, and what was lost."""

import json
import os
import shutil
from pathlib import Path

import pytest

from skiplatch.errors import InputError
from skiplatch.fleet.history import read_history
from skiplatch.fleet.reading import opened
from skiplatch.fleet.store import opened_for_writing
from test_fleet_clock import dated
from test_fleet_columns import recorded
from test_fleet_rotary import diagnosis
from test_fleet_store import add, ask, export, files, rewritten
from test_fleet_told import fleet

REST = "or damaged files\n"
START = "2026-03-02T08:00:00Z"


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """A campaign that says when it began, with a diagnosis."""
    folder = dated(tmp_path / "mill-7" / "monday", START)
    (folder / "diagnosis.json").write_text(diagnosis(2.0))
    return folder


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


def written_on(folder: Path, touch: int = 99) -> None:
    """Add a touch, after which a diagnosis would be of other touches."""
    (folder / "diagnosis.json").unlink(missing_ok=True)
    with (folder / "touches.csv").open("a") as file:
        file.write(f"{touch},100,1.5\n")


def kept_files(store: Path) -> int:
    return len([path for path in store.rglob("*") if path.suffix in (".zip", ".parquet")])


def test_a_later_version_of_a_campaign_replaces_the_older_one(campaign: Path, store: Path) -> None:
    add(store, campaign)
    ((first, touches),) = ask(store, "SELECT campaign, touches FROM campaigns")
    written_on(campaign)

    result = fleet("add", campaign, "--store", store, "--json", "-")

    assert f"{campaign}: kept, replaces an older version" in result.stderr
    assert "0 campaigns of 0 rigs added, 1 replaced" in result.stderr
    assert [one["replaces"] for one in json.loads(result.stdout)["replaced"]] == [[first]]
    assert ask(store, "SELECT touches FROM campaigns") == [(touches + 1,)]
    assert kept_files(store) == 3


def test_versions_that_change_forth_and_back_in_one_go_leave_the_last(
    campaign: Path, store: Path, tmp_path: Path
) -> None:
    newer = shutil.copytree(campaign, tmp_path / "later" / "mill-7" / "monday")
    written_on(newer)

    add(store, campaign, newer, campaign)

    assert files(export(store, "monday", tmp_path / "back")) == files(campaign)
    assert kept_files(store) == 3


@pytest.mark.parametrize(
    ("place", "start"),
    [("mill-8/monday", START), ("mill-7/tuesday", START), ("mill-7/monday", "2026-03-02T09:00")],
)
def test_what_differs_in_rig_folder_or_start_is_another_campaign(
    campaign: Path, store: Path, tmp_path: Path, place: str, start: str
) -> None:
    other = dated(tmp_path / "other" / place, start)
    written_on(other)

    assert add(store, campaign, other) == 2
    assert ask(store, "SELECT count(*) FROM campaigns") == [(2,)]


def test_the_time_of_a_file_makes_no_versions(store: Path, tmp_path: Path) -> None:
    for number in (1, 2):
        folder = recorded(tmp_path / str(number) / "data")
        if number == 2:
            written_on(folder)
        os.utime(folder / "touches.csv", (1e9, 1e9))
        add(store, folder, rig="mill-7")

    assert ask(store, "SELECT count(*) FROM campaigns") == [(2,)]


def test_a_replacement_that_fails_keeps_what_was_there(
    campaign: Path, store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add(store, campaign)
    before = files(campaign)
    (campaign / "photo.png").write_bytes(b"new")

    def fail(*_: object) -> None:
        raise OSError("gone while it was read")

    with opened_for_writing(store) as writer:
        with monkeypatch.context() as patch:
            patch.setattr("skiplatch.fleet.store.pack", fail)
            with pytest.raises(InputError, match="gone while"):
                writer.add(campaign)
        writer.add(dated(tmp_path / "mill-8" / "monday", START))
        writer.commit()

    key = "SELECT campaign FROM campaigns WHERE rig = 'mill-7'"
    assert files(export(store, ask(store, key)[0][0], tmp_path / "back")) == before


def test_of_campaigns_at_one_time_all_commands_call_the_same_the_newest(
    campaign: Path, store: Path, tmp_path: Path
) -> None:
    days = [campaign]
    for number in range(4):
        folder = dated(tmp_path / "mill-7" / f"copy-{number}", START)
        written_on(folder, 10 + number)
        (folder / "diagnosis.json").write_text(diagnosis(3.0 + number))
        days.append(folder)
    add(store, *days)

    with opened(store, with_touches=False) as reader:
        (rig,) = reader.rigs().mappings()
        newest = read_history(reader)["mill-7"][-1]
    assert rig["gap_um"] == newest.gap_um
    metrics = fleet("check", "--store", store, "--metrics", tmp_path / "fleet.prom")
    assert metrics.exit_code == 0
    said = f'skiplatch_fleet_rig_gap_um{{rig="mill-7"}} {newest.gap_um}'
    assert said in (tmp_path / "fleet.prom").read_text()


def test_a_kept_diagnosis_stays_if_its_campaign_comes_without(
    campaign: Path, store: Path, tmp_path: Path
) -> None:
    add(store, campaign)
    before = files(campaign)
    (campaign / "diagnosis.json").unlink()
    assert add(store, campaign) == 0

    (campaign / "photo.png").write_bytes(b"new")
    result = fleet("add", campaign, "--store", store)

    assert "kept, has no diagnosis, so the kept one stays" in result.output
    assert ask(store, "SELECT verdict, gap_um FROM campaigns") == [("explained", 2.0)]
    assert len(ask(store, "FROM gaps")) > 0
    assert files(export(store, "monday", tmp_path / "out")) == before | {"photo.png": b"new"}


def test_a_new_diagnosis_replaces_the_kept_one(campaign: Path, store: Path) -> None:
    add(store, campaign)
    (campaign / "diagnosis.json").write_text(diagnosis(3.0))
    add(store, campaign)

    assert ask(store, "SELECT gap_um FROM campaigns") == [(3.0,)]


@pytest.mark.parametrize("pattern", ["touches/*/*/*", "folders/*/*/*"])
@pytest.mark.parametrize("is_gone", [True, False])
def test_what_is_lost_in_the_store_comes_back_by_adding_again(
    campaign: Path, store: Path, tmp_path: Path, pattern: str, is_gone: bool
) -> None:
    add(store, campaign)
    path = next(store.glob(pattern))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    if is_gone:
        path.unlink()

    result = fleet("add", campaign, "--store", store)

    assert "kept, mends what was missing or damaged in the store" in result.output
    assert ask(store, "SELECT count(*) FROM touches") == ask(store, "SELECT touches FROM campaigns")
    assert files(export(store, "monday", tmp_path / "back")) == files(campaign)
    assert "1 known already" in fleet("add", campaign, "--store", store).output


@pytest.mark.parametrize("pattern", ["touches/*/*/*", "folders/*/*/*"])
@pytest.mark.parametrize("damage", ["gone", "cut", "a bit"])
def test_verify_names_the_campaign_of_which_a_file_is_lost(
    campaign: Path, store: Path, tmp_path: Path, pattern: str, damage: str
) -> None:
    add(store, campaign)
    path = next(store.glob(pattern))
    add(store, dated(tmp_path / "mill-8" / "monday", START))
    assert fleet("verify", "--store", store).output == f"{store}: 2 campaigns, 0 with lost {REST}"

    data = path.read_bytes()
    middle = len(data) // 2
    path.write_bytes(data[:middle])
    if damage == "a bit":
        path.write_bytes(data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :])
    elif damage == "gone":
        path.unlink()
    result = fleet("verify", "--store", store, "--json", "-")

    assert result.exit_code == 1
    line, summary = result.stderr.splitlines(keepends=True)
    assert line.startswith("mill-7: monday (")
    assert f"): {path}: " in line
    assert summary == f"{store}: 2 campaigns, 1 with lost {REST}"
    (told,) = json.loads(result.stdout)["damaged"]
    assert (told["rig"], told["folder"], told["path"]) == ("mill-7", "monday", str(path))


def test_verify_reads_touches_of_which_no_digest_is_known(campaign: Path, store: Path) -> None:
    add(store, campaign)
    rewritten(store / "campaigns.parquet", "* EXCLUDE (touches_sha256, index_sha256)")
    assert fleet("verify", "--store", store).exit_code == 0

    next(store.glob("touches/*/*/*")).write_bytes(b"PAR1")
    assert fleet("verify", "--store", store).exit_code == 1
