"""A store of a fleet: what goes in comes out, and whatever goes wrong leaves it whole."""

import errno
import fcntl
import json
import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import pytest

from conftest import SAMPLES
from refusals import Program, refusal
from skiplatch.campaign import read_campaign
from skiplatch.cli import group
from skiplatch.errors import InputError
from skiplatch.fleet import layout
from skiplatch.fleet.contents import unpack
from skiplatch.fleet.history import Gap, Parameter, read_history
from skiplatch.fleet.reading import opened
from skiplatch.fleet.store import opened_for_writing

DIAGNOSIS = {
    "format": "skiplatch-diagnosis/2",
    "verdict": "explained",
    "seed": 7,
    "where": [{"stage": "latch"}],
    "gap": {
        "latch error": {"unit": "µs", "before": 41.0, "after": 0.5, "noise_floor": 0.4},
        "deviation": {"unit": "µm", "before": 2.5, "after": 0.1, "noise_floor": 0.1},
    },
    "effects": [
        {
            "id": "isr_latency",
            "stage": "latch",
            "confidence": 0.9,
            "params": {"latency_us": 41.7},
            "intervals": {"latency_us": [41.5, 41.8]},
        }
    ],
}


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """A campaign of thirty touches, with files beside those that it needs."""
    folder = tmp_path / "mill-7" / "monday"
    shutil.copytree(SAMPLES / "bench_isr_latency", folder)
    lines = (folder / "touches.csv").read_bytes().splitlines()[:31]
    (folder / "touches.csv").write_bytes(b"\r\n".join(lines) + b"\r\n")
    (folder / "photos").mkdir()
    (folder / "photos" / "probe é.bin").write_bytes(bytes(range(256)))
    return folder


def another(campaign: Path, name: str = "tuesday") -> Path:
    """The same touches but for the last."""
    folder = shutil.copytree(campaign, campaign.parent / name)
    text = (folder / "touches.csv").read_bytes()
    (folder / "touches.csv").write_bytes(text[: text.rstrip().rindex(b"\n") + 1])
    return folder


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


def add(store: Path, *folders: Path, rig: str | None = None) -> int:
    """Add campaigns, and give how many were new."""
    with opened_for_writing(store) as writer:
        new = [writer.add(folder, rig) for folder in folders]
        writer.commit()
    return sum(intake is not None for intake in new)


def ask(store: Path, sql: str) -> list[tuple[Any, ...]]:
    with opened(store) as reader:
        return reader.query(sql).rows


def export(store: Path, name: str, out: Path) -> Path:
    with opened(store) as reader:
        reader.export(name, out)
    return out


def remove(store: Path, *names: str) -> None:
    with opened_for_writing(store) as writer:
        for name in names:
            writer.remove(name)
        writer.commit()


def files(folder: Path) -> dict[str, bytes]:
    found = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def test_a_folder_comes_back_byte_for_byte(campaign: Path, store: Path, tmp_path: Path) -> None:
    add(store, campaign)

    assert files(export(store, "monday", tmp_path / "back")) == files(campaign)


def test_touches_are_what_was_recorded(campaign: Path, store: Path) -> None:
    add(store, campaign)
    rows = ask(store, "SELECT touch, latch_us, position_mm, path, status FROM touches")

    recorded = read_campaign(campaign).touches
    assert [row[0] for row in rows] == recorded.touch.tolist()
    assert [row[1] for row in rows] == recorded.latch_us.tolist()
    place = [None if np.isnan(value) else value for value in recorded.position_mm.tolist()]
    assert [row[2] for row in rows] == place
    assert {row[3] for row in rows} <= {"skip", "plc"}
    assert {row[4] for row in rows} <= {"ok", "missed", "false", None}


def test_every_touch_knows_its_nominal_tool_and_rig(campaign: Path, store: Path) -> None:
    add(store, campaign)

    rows = ask(store, "SELECT DISTINCT rig, nominal, tool FROM touches")
    assert [len(value) > 0 for row in rows for value in row] == [True] * 3
    assert rows[0][0] == "mill-7"


def test_adding_twice_adds_once(campaign: Path, store: Path) -> None:
    assert add(store, campaign, campaign) == 1
    before = files(store)

    assert add(store, campaign, shutil.copytree(campaign, campaign.parent / "copy")) == 0
    assert files(store) == before


def test_a_diagnosis_that_came_later_replaces_the_row(
    campaign: Path, store: Path, tmp_path: Path
) -> None:
    add(store, campaign)
    (campaign / "diagnosis.json").write_text(json.dumps(DIAGNOSIS))
    assert add(store, campaign) == 1

    rows = ask(store, "SELECT verdict, seed, gap_um, stage FROM campaigns")
    assert rows == [("explained", 7, 2.5, "latch")]
    rows = ask(store, "SELECT effect, parameter, value, low, high FROM effects")
    assert rows == [("isr_latency", "latency_us", 41.7, 41.5, 41.8)]
    assert ask(store, "SELECT count(*) FROM touches") == [(30,)]
    assert len(list(store.rglob("*.zip"))) == 1
    assert files(export(store, "monday", tmp_path / "back")) == files(campaign)


def test_a_diagnosis_of_other_touches_is_refused(campaign: Path, store: Path) -> None:
    (campaign / "diagnosis.json").write_text(json.dumps(DIAGNOSIS | {"fingerprint": "0" * 64}))

    said = refusal(add, store, campaign)

    assert said.endswith(
        "diagnosis.json: a diagnosis of other touches than those that lie beside it"
    )


def test_history_has_the_diagnoses_in_the_order_of_time(campaign: Path, store: Path) -> None:
    (campaign / "diagnosis.json").write_text(json.dumps(DIAGNOSIS))
    later = another(campaign)
    os.utime(campaign / "touches.csv", (1.45e9, 1.45e9))
    os.utime(later / "touches.csv", (1.5e9, 1.5e9))
    add(store, later, campaign)

    with opened(store, with_touches=False) as reader:
        first, second = read_history(reader)["mill-7"]
    assert (first.folder, first.verdict, first.gap_um) == ("monday", "explained", 2.5)
    assert first.gaps["latch error"] == Gap("latch error", "µs", 41.0, 0.4)
    assert second.parameters == [Parameter("isr_latency", "latch", "latency_us", 41.7, 41.5, 41.8)]
    assert second.time.isoformat() == "2017-07-14T02:40:00"


def test_thermometers_and_sessions_are_kept(campaign: Path, store: Path) -> None:
    (campaign / "nominal.toml").write_text(
        'format = "skiplatch-campaign/2"\nkind = "machine"\n'
        '[notes]\nrig = "lathe"\nrecorded_at = 2026-03-31T23:30:00-01:00\n'
    )
    (campaign / "touches.csv").write_text(
        "touch,deviation_um,session,feed_mm_min,temp_bed_c,temp_spindle_c\n"
        "1,1.5,a,100,20.5,\n2,1.25,b,100,,30\n"
    )
    add(store, campaign)

    rows = ask(store, "SELECT session, thermometers_c['bed'] FROM touches ORDER BY touch")
    assert rows == [("a", 20.5), ("b", None)]
    rows = ask(store, "SELECT rig, month, sessions FROM campaigns")
    assert rows == [("lathe", "2026-04", ["a", "b"])]


@pytest.mark.parametrize("rig", ["../../etc", "a/b 'q' %41", "007", "2026-03-01", "NULL", "é=[*]"])
def test_a_rig_may_be_called_anything_printable(campaign: Path, store: Path, rig: str) -> None:
    add(store, campaign, rig=rig)

    assert {path.name for path in store.parent.iterdir()} == {"mill-7", "store"}
    assert ask(store, "SELECT DISTINCT rig FROM touches") == [(rig,)]
    with opened(store) as reader:
        assert reader.history(rig).rows[0][3] == 30


@pytest.mark.parametrize("rig", ["", "x" * 61, "a\nb", "𝄞" * 60])
def test_no_name_of_a_rig_is_refused(campaign: Path, store: Path, rig: str) -> None:
    with pytest.raises(InputError, match="rig"):
        add(store, campaign, rig=rig)


class Killed(BaseException):
    """What ends a process in the midst of its work."""


def killed_at(number: int, monkeypatch: pytest.MonkeyPatch, fault: Callable[[], None]) -> list[int]:
    """Let the n-th call that makes something last fail; gives what is left to count."""
    left = [number]

    def counted(function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:  # noqa: ANN401
            left[0] -= 1
            if left[0] == 0:
                fault()
            return function(*arguments)

        return call

    for name in ("fsync", "replace", "rename", "mkdir"):
        monkeypatch.setattr(os, name, counted(getattr(os, name)))
    return left


def _kill() -> None:
    raise Killed


def _no_space() -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("fault", [_kill, _no_space])
def test_what_is_removed_counts_as_before_or_not_at_all(
    campaign: Path, store: Path, fault: Callable[[], None], tmp_path: Path
) -> None:
    second = another(campaign)
    add(store, campaign, second)
    steps = 0
    for number in count(1):
        trial = shutil.copytree(store, tmp_path / f"trial{number}")
        with pytest.MonkeyPatch.context() as patch, suppress(Killed, InputError):
            left = killed_at(number, patch, fault)
            remove(trial, "monday")
        if left[0] > 0:
            break
        steps += 1
        have = ask(
            trial, "SELECT DISTINCT folder FROM campaigns SEMI JOIN touches USING (campaign)"
        )
        assert sorted(have) in ([("monday",), ("tuesday",)], [("tuesday",)])
        add(trial, campaign)
        assert files(export(trial, "monday", trial.with_suffix(".out"))) == files(campaign)

    assert steps >= 3
    remove(store, "monday")
    assert ask(store, "SELECT folder, touches FROM campaigns") == [("tuesday", 29)]
    assert len(list(store.rglob("*.zip"))) == len(list((store / "touches").rglob("*.parquet"))) == 1


@pytest.mark.parametrize("fault", [_kill, _no_space])
def test_an_add_that_fails_anywhere_leaves_the_store_whole(
    campaign: Path, store: Path, fault: Callable[[], None], tmp_path: Path
) -> None:
    add(store, campaign)
    second = another(campaign)
    steps = 0
    for number in count(1):
        trial = shutil.copytree(store, tmp_path / f"trial{number}")
        with pytest.MonkeyPatch.context() as patch, suppress(Killed, InputError):
            left = killed_at(number, patch, fault)
            add(trial, second)
        if left[0] > 0:
            break
        steps += 1
        have = ask(
            trial,
            "SELECT folder, count(*) FROM touches JOIN campaigns USING (campaign) "
            "GROUP BY folder ORDER BY folder",
        )
        assert have in ([("monday", 30)], [("monday", 30), ("tuesday", 29)])
        add(trial, second)
        assert files(export(trial, "tuesday", trial.with_suffix(".out"))) == files(second)

    assert steps >= 6


def test_a_full_disk_is_one_line(
    campaign: Path, store: Path, refused: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed_at(3, monkeypatch, _no_space)

    assert "cannot write: No space left on device" in refused(
        "fleet", "add", campaign, "--store", store
    )


def test_a_campaign_that_cannot_be_read_costs_no_other(
    campaign: Path, store: Path, refused: Program
) -> None:
    bad = another(campaign)
    (bad / "touches.csv").write_text("touch\nx\n")

    assert "tuesday/touches.csv" in refused("fleet", "add", bad, campaign, "--store", store)
    assert ask(store, "SELECT folder FROM campaigns") == [("monday",)]


def test_two_writers_at_once_are_refused(campaign: Path, store: Path) -> None:
    add(store, campaign)
    with (store / "lock").open("r+") as held:
        fcntl.flock(held, fcntl.LOCK_EX)

        assert "another skiplatch writes" in refusal(add, store, another(campaign))
        assert ask(store, "SELECT count(*) FROM campaigns") == [(1,)]
    assert add(store, another(campaign, "wednesday")) == 1


@pytest.fixture
def filled(campaign: Path, store: Path) -> Path:
    """A store with a campaign."""
    add(store, campaign)
    return store


def test_a_newer_store_is_refused(filled: Path) -> None:
    (filled / "store.json").write_text('{"format": "skiplatch-fleet/2"}')

    for call in (lambda: ask(filled, "SELECT 1"), lambda: add(filled, filled)):
        assert 'expected a store of the format "skiplatch-fleet/1"' in refusal(call)


@pytest.mark.parametrize(
    "place", ["x", "touches/x", "folders/rig=a", "RIG/x.parquet", "MONTH/x.parquet"]
)
def test_a_foreign_file_is_refused(filled: Path, place: str) -> None:
    month = next(filled.glob("touches/*/*"))
    path = filled / place.replace("RIG", str(month.parent)).replace("MONTH", str(month))
    path.write_text("mine")

    assert f"{path}: a foreign file" in refusal(ask, filled, "SELECT 1")
    assert path.read_text() == "mine"


@pytest.mark.parametrize("name", ["lost+found", ".snapshot", ".DS_Store", "Thumbs.db"])
def test_what_file_systems_put_into_any_folder_is_ignored(filled: Path, name: str) -> None:
    for folder in (filled, filled / "touches", next(filled.glob("touches/*/*"))):
        (folder / name).mkdir()

    assert ask(filled, "SELECT count(*) FROM touches") == [(30,)]


def test_a_store_in_a_store_is_refused(filled: Path, campaign: Path, refused: Program) -> None:
    inner = filled / "more" / "store"

    for words in (["add", campaign], ["watch", campaign.parent, "--once"]):
        said = refused("fleet", *words, "--store", inner)
        assert said == f"skiplatch: {inner}: lies in the store {filled}; put it elsewhere\n"
    assert not inner.parent.exists()


def test_what_killed_writers_left_is_removed_by_the_next(
    filled: Path, campaign: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    month = next(filled.glob("touches/*/*"))
    for folder in (filled, month):
        (folder / f".skiplatch-{'0' * 16}.tmp").write_text("half")

    add(filled, another(campaign))
    assert len(list(filled.rglob("*.tmp"))) == 2  # another one may take something back

    monkeypatch.setattr(layout, "LEFT_S", 0.0)
    add(filled, another(campaign, "wednesday"))
    assert not list(filled.rglob("*.tmp"))


def test_lost_touches_are_named_and_cost_no_other_table(
    filled: Path, run: Callable[..., Any], refused: Program
) -> None:
    path = next(filled.glob("touches/*/*/*"))
    path.unlink()

    assert run("query", "SELECT folder FROM campaigns", "--store", filled)["rows"] == [["monday"]]
    said = refused("fleet", "query", "SELECT 1 FROM Touches", "--store", filled)
    assert said.startswith(f"skiplatch: {path}: cannot read: No such file")
    assert '; touches of "monday" (' in said
    assert said.endswith(') of rig "mill-7"\n')


def test_a_campaign_without_touches_is_told_by_the_file(
    campaign: Path, store: Path, refused: Program
) -> None:
    (campaign / "touches.csv").unlink()

    said = refused("fleet", "add", campaign, "--store", store)
    assert said.startswith(f"skiplatch: {campaign}/touches.csv: cannot read: No such file")


def test_a_lost_bit_of_a_folder_is_told_or_costs_nothing(filled: Path, tmp_path: Path) -> None:
    archive = next(filled.glob("folders/*/*/*"))
    data = archive.read_bytes()
    unpack(archive, tmp_path / "whole")
    told = 0
    for place in range(0, len(data), max(1, len(data) // 200)):
        archive.write_bytes(data[:place] + bytes([data[place] ^ 0x10]) + data[place + 1 :])
        out = tmp_path / f"back-{place}"
        try:
            unpack(archive, out)
        except InputError as error:
            told += str(error).startswith(f"{archive}: damaged: ")
            assert not out.exists()
        else:
            assert set(files(out).values()) == set(files(tmp_path / "whole").values())

    assert told > 150


@pytest.mark.parametrize("flips", [8, pytest.param(200, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("pattern", ["campaigns.parquet", "touches/*/*/*"])
def test_a_lost_bit_of_a_table_is_told_or_changes_no_answer(
    filled: Path, pattern: str, flips: int
) -> None:
    def answers() -> list[list[tuple[Any, ...]]]:
        with opened(filled) as reader:
            told = [reader.query(f"FROM {table}").rows for table in ("campaigns", "touches")]
            return [*told, reader.history("mill-7").rows]

    path = next(filled.glob(pattern))
    data, whole = path.read_bytes(), answers()
    places = np.random.default_rng(8).choice(len(data), flips, replace=False)
    told = 0
    for place, bit in zip(places.tolist(), np.arange(flips) % 8, strict=False):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1 << bit]) + data[place + 1 :])
        try:
            assert answers() == whole
        except InputError:
            told += 1

    assert told == flips if pattern.startswith("touches") else told > flips // 4


def rewritten(index: Path, columns: str) -> None:
    """Put the index in its place as other columns of it say."""
    other = index.with_name("other.parquet")
    duckdb.read_parquet(str(index)).project(columns).write_parquet(str(other))
    other.replace(index)


def test_an_index_that_is_not_whole_is_not_written_anew(filled: Path, campaign: Path) -> None:
    rewritten(filled / "campaigns.parquet", "* REPLACE (touches + 1 AS touches)")

    for call in (lambda: ask(filled, "SELECT 1"), lambda: add(filled, another(campaign))):
        assert "campaigns.parquet: damaged: its contents" in refusal(call)


def test_a_store_without_digests_is_read_and_gets_them(filled: Path, campaign: Path) -> None:
    rewritten(filled / "campaigns.parquet", "* EXCLUDE (touches_sha256, index_sha256)")
    add(filled, another(campaign))

    assert ask(filled, "SELECT count(DISTINCT index_sha256) FROM campaigns") == [(1,)]
    assert ask(filled, "SELECT count(touches_sha256) FROM campaigns") == [(1,)]
    assert ask(filled, "SELECT count(*) FROM touches") == [(59,)]


def test_a_name_in_a_kept_folder_that_lost_a_bit_is_told(filled: Path, tmp_path: Path) -> None:
    archive = next(filled.glob("folders/*/*/*"))
    archive.write_bytes(archive.read_bytes().replace(b"touches.csv", b"touches.csw"))

    assert f"{archive}: damaged: a name" in refusal(export, filled, "monday", tmp_path / "back")
    assert not (tmp_path / "back").exists()


@pytest.mark.parametrize("place", ["campaigns.parquet", "lock", "touches/*/*/*", "folders/*/*/*"])
def test_a_pipe_in_place_of_a_file_is_refused_and_not_waited_for(filled: Path, place: str) -> None:
    path = next(filled.glob(place))
    path.unlink()
    os.mkfifo(path)

    assert f"{path}: a foreign file" in refusal(ask, filled, "SELECT 1")


@pytest.mark.parametrize("pattern", ["campaigns.parquet", "touches/*/*/*", "folders/*/*/*"])
@pytest.mark.parametrize("damage", ["cut", "foreign", "gone"])
def test_a_damaged_file_is_one_line(
    filled: Path, pattern: str, damage: str, tmp_path: Path
) -> None:
    path = next(filled.glob(pattern))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2] if damage == "cut" else b"PAR1 or PK\x03\x04")
    if damage == "gone":
        path.unlink()

    def use() -> None:
        ask(filled, "SELECT sum(deviation_um) FROM touches")
        export(filled, "monday", tmp_path / "back")

    assert str(filled) in refusal(use)
    assert not (tmp_path / "back").exists()


def test_a_lost_index_is_not_made_anew(filled: Path, campaign: Path) -> None:
    (filled / "campaigns.parquet").unlink()

    for call in (lambda: ask(filled, "SELECT 1"), lambda: add(filled, another(campaign))):
        assert "campaigns.parquet: gone" in refusal(call)


@pytest.mark.parametrize(
    "sql",
    [
        "COPY touches TO '{store}/campaigns.parquet'",
        "SELECT 1; SELECT 2",
        "DROP VIEW touches",
        "SET threads = 1",
        "SELECT * FROM read_text('/etc/passwd')",
        "SELECT * FROM '/etc/passwd'",
        "ATTACH '{store}/x.db'",
        "SELEC 1",
        "SELECT nothing FROM touches",
        "",
    ],
)
def test_a_query_only_reads_the_store(filled: Path, sql: str) -> None:
    before = files(filled)

    refusal(ask, filled, sql.replace("{store}", str(filled)))
    assert files(filled) == before


def test_a_store_is_no_campaign_and_a_campaign_no_store(campaign: Path, filled: Path) -> None:
    assert "nominal.toml" in refusal(add, filled, filled)
    assert "no store: it has no store.json" in refusal(add, campaign, campaign)


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")])
def test_what_is_neither_file_nor_folder_is_not_kept(
    campaign: Path, store: Path, make: Callable[[Path], None]
) -> None:
    make(campaign / "odd")

    assert "neither a file nor a folder" in refusal(add, store, campaign)


def test_a_damaged_diagnosis_is_one_line(campaign: Path, store: Path) -> None:
    for text in ("[]", '{"format": "skiplatch-diagnosis/2"}', "{", '{"format": 1e999}'):
        (campaign / "diagnosis.json").write_text(text)

        assert "diagnosis.json" in refusal(add, store, campaign)


def test_commands_say_as_json_what_the_store_holds(
    filled: Path, tmp_path: Path, run: Callable[..., Any]
) -> None:
    rigs = run("list", "--store", filled)["rigs"]
    assert [(rig["rig"], rig["campaigns"], rig["touches"]) for rig in rigs] == [("mill-7", 1, 30)]

    (shown,) = run("show", "mill-7", "--store", filled)["campaigns"]
    recorded = read_campaign(tmp_path / "mill-7" / "monday").touches
    assert shown["deviation_um"] == pytest.approx(np.nanmean(recorded.deviation_um))

    answer = run("query", "SELECT count(*) AS n FROM touches", "--store", filled)
    assert answer == {"columns": ["n"], "rows": [[30]]}


def test_a_campaign_of_a_wrong_date_is_taken_out_for_good(
    filled: Path, campaign: Path, run: Callable[..., Any]
) -> None:
    ((key,),) = ask(filled, "SELECT campaign FROM campaigns")

    assert run("remove", key[:9], "--store", filled) == {"removed": [key]}
    assert "an empty store" in refusal(ask, filled, "SELECT 1")
    assert add(filled, campaign) == 1


def test_of_campaigns_to_remove_one_that_is_not_there_keeps_all(
    filled: Path, refused: Program
) -> None:
    said = refused("fleet", "remove", "monday", "sunday", "--store", filled)

    assert 'no campaign is called "sunday"' in said
    assert ask(
        filled, "SELECT folder, count(*) FROM touches JOIN campaigns USING (campaign) GROUP BY ALL"
    ) == [("monday", 30)]


def test_a_store_that_is_not_there_is_not_made_to_remove_from(
    store: Path, refused: Program
) -> None:
    assert "no such store" in refused("fleet", "remove", "monday", "--store", store)
    assert not store.exists()


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., Any]:
    """A command of the fleet, called with arguments; gives its JSON."""

    def call(*arguments: object) -> Any:  # noqa: ANN401
        group.main(["fleet", *map(str, arguments), "--json", "-"], standalone_mode=False)
        return json.loads(capsys.readouterr().out)

    return call
