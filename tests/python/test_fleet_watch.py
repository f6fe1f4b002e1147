"""A folder that is watched: what is whole is diagnosed and kept, what is bad costs no other."""

import fcntl
import json
import os
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner, Result

from conftest import SAMPLES
from refusals import Program
from skiplatch.cli import group
from skiplatch.commands import fleet_watch
from skiplatch.commands.fleet_watch import Intake, watch
from skiplatch.errors import InputError
from skiplatch.fleet.arrivals import Arrivals
from skiplatch.fleet.history import read_history
from skiplatch.fleet.reading import opened
from test_fleet_store import DIAGNOSIS

LONG_AGO_S = 1e9
PATIENCE_S = 20.0
SETTLE_S = 0.5
AT_ONCE_S = "1e-9"
"""Files are stamped by a clock that lags that of the programs, if anything."""


def put(folder: Path, *, rows: int = 10) -> Path:
    """Make a campaign of the first touches of a sample."""
    shutil.copytree(SAMPLES / "bench_isr_latency", folder)
    lines = (folder / "touches.csv").read_text().splitlines(keepends=True)
    (folder / "touches.csv").write_text("".join(lines[: rows + 1]))
    return folder


@pytest.fixture
def diagnosed(monkeypatch: pytest.MonkeyPatch) -> list[Path | None]:
    """Campaigns that were diagnosed; the search itself is another test's business."""
    asked: list[Path | None] = []

    def examine(recorded: SimpleNamespace, *_: object) -> SimpleNamespace:
        asked.append(recorded.path)
        return SimpleNamespace(document=DIAGNOSIS)

    monkeypatch.setattr(fleet_watch, "examine", examine)
    return asked


@pytest.fixture
def inbox(tmp_path: Path) -> Path:
    folder = tmp_path / "mill-7"
    folder.mkdir()
    return folder


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


def once(inbox: Path, store: Path, *options: str) -> Result:
    words = ["fleet", "watch", str(inbox), "--store", str(store), "--once", *options]
    return CliRunner().invoke(group, words, catch_exceptions=False)


def kept(store: Path) -> dict[str, str | None]:
    """Verdicts by the names of the folders."""
    try:
        with opened(store, with_touches=False) as reader:
            history = read_history(reader)
    except InputError:  # nothing is in it yet
        return {}
    return {entry.folder: entry.verdict for entries in history.values() for entry in entries}


def test_what_is_whole_is_diagnosed_and_kept(
    inbox: Path, store: Path, diagnosed: list[Path | None]
) -> None:
    put(inbox / "monday")
    put(inbox / "more" / "tuesday", rows=9)

    result = once(inbox, store, "--settle-s", AT_ONCE_S, "--json", "-")

    assert json.loads(result.stdout)["kept"] == [
        str(inbox / "monday"),
        str(inbox / "more" / "tuesday"),
    ]
    assert kept(store) == {"monday": "explained", "tuesday": "explained"}
    assert json.loads((inbox / "monday" / "diagnosis.json").read_text()) == DIAGNOSIS
    assert len(diagnosed) == 2


def test_what_is_known_is_not_diagnosed_again(
    inbox: Path, store: Path, diagnosed: list[Path | None]
) -> None:
    put(inbox / "monday")
    once(inbox, store, "--settle-s", AT_ONCE_S)

    assert "0 kept, 1 known already" in once(inbox, store, "--settle-s", AT_ONCE_S).output
    assert len(diagnosed) == 1


@pytest.mark.parametrize("missing", ["nominal.toml", "touches.csv"])
def test_what_lacks_a_file_is_left(
    inbox: Path, store: Path, diagnosed: list[Path | None], missing: str
) -> None:
    (put(inbox / "monday") / missing).unlink()

    assert "0 kept, 0 known already, 1 not whole" in once(inbox, store).output
    assert diagnosed == []


def test_what_has_just_changed_is_left(
    inbox: Path, store: Path, diagnosed: list[Path | None]
) -> None:
    put(inbox / "monday")

    assert "1 not whole yet" in once(inbox, store, "--settle-s", "60").output
    assert diagnosed == []


def test_a_copy_with_old_times_is_not_whole_at_once(inbox: Path, store: Path) -> None:
    """Tools that copy set the time of change back; that of the entry they cannot."""
    folder = put(inbox / "monday")
    for path in folder.iterdir():
        os.utime(path, (LONG_AGO_S, LONG_AGO_S))

    assert "1 not whole yet" in once(inbox, store, "--settle-s", "60").output


def test_a_bad_campaign_is_one_line_and_costs_no_other(
    inbox: Path, store: Path, diagnosed: list[Path | None], refused: Program
) -> None:
    (put(inbox / "a bad one") / "touches.csv").write_text("touch\nx\n")
    put(inbox / "monday")

    said = refused("fleet", "watch", inbox, "--store", store, "--once", "--settle-s", AT_ONCE_S)

    assert "a bad one/touches.csv" in said
    assert kept(store) == {"monday": "explained"}


def test_a_store_that_is_none_ends_the_watch(
    inbox: Path, store: Path, diagnosed: list[Path | None], refused: Program
) -> None:
    put(inbox / "monday")
    store.mkdir()
    (store / "store.json").write_text('{"format": "skiplatch-fleet/2"}')

    said = refused("fleet", "watch", inbox, "--store", store, "--settle-s", AT_ONCE_S)

    assert "a newer skiplatch may have written it" in said


def test_a_folder_that_is_not_there_is_refused(inbox: Path, store: Path, refused: Program) -> None:
    for options in ([], ["--once"]):
        said = refused("fleet", "watch", inbox / "none", "--store", store, *options)
        assert "no such folder" in said


@contextmanager
def watched(inbox: Path, store: Path) -> Iterator[Callable[[dict[str, str | None]], None]]:
    """Watch a folder meanwhile; gives a function that waits until the store holds what it is to."""
    stop = threading.Event()
    arrivals = Arrivals(inbox, SETTLE_S)
    arguments = Intake(store, None, 1, 1), arrivals, stop
    thread = threading.Thread(target=watch, args=arguments)
    thread.start()

    def until(expected: dict[str, str | None]) -> None:
        latest = time.monotonic() + PATIENCE_S
        while (found := kept(store)) != expected:
            assert time.monotonic() < latest, found
            assert thread.is_alive()
            time.sleep(0.2)

    try:
        yield until
    finally:
        stop.set()
        (inbox / "the end").touch()
        thread.join(PATIENCE_S)
        assert not thread.is_alive()


def test_a_watch_takes_what_comes_once_it_is_whole(
    inbox: Path, store: Path, diagnosed: list[Path | None], tmp_path: Path
) -> None:
    other = put(tmp_path / "elsewhere")
    text = (other / "touches.csv").read_text()
    with watched(inbox, store) as until:
        folder = inbox / "monday"
        folder.mkdir()
        shutil.copy(other / "nominal.toml", folder)
        with (folder / "touches.csv").open("w") as file:
            for line in text.splitlines(keepends=True):
                file.write(line)
                file.flush()
                time.sleep(0.06)
                assert diagnosed == []
        until({"monday": "explained"})
        shutil.move(put(tmp_path / "tuesday", rows=8), inbox / "tuesday")
        until({"monday": "explained", "tuesday": "explained"})

    assert len(diagnosed) == 2


@pytest.mark.long
def test_a_watch_waits_for_another_writer_and_survives_a_bad_campaign(
    inbox: Path, store: Path, diagnosed: list[Path | None], capfd: pytest.CaptureFixture[str]
) -> None:
    put(inbox / "monday")
    once(inbox, store, "--settle-s", AT_ONCE_S)
    with watched(inbox, store) as until:
        with (store / "lock").open("r+") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            put(inbox / "tuesday", rows=8)
            (put(inbox / "bad") / "touches.csv").write_text("touch\nx\n")
            while len(diagnosed) < 2:
                time.sleep(0.02)
            assert list(kept(store)) == ["monday"]
        until({"monday": "explained", "tuesday": "explained"})
        (inbox / "bad" / "touches.csv").write_text(
            (inbox / "monday" / "touches.csv").read_text().replace("\n", "\r\n")
        )
        until({"monday": "explained", "tuesday": "explained", "bad": "explained"})

    assert capfd.readouterr().err.count("skiplatch: ") == 1
