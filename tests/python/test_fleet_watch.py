"""A folder that is watched: what is whole is diagnosed and kept, what is bad costs no other."""

import fcntl
import json
import os
import shutil
import threading
import time
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner, Result

from conftest import SAMPLES
from played_campaigns import few_of
from refusals import Program
from skiplatch import executors
from skiplatch.campaign import Campaign
from skiplatch.cli import group
from skiplatch.commands import fleet_watch
from skiplatch.commands.diagnose_many import Told
from skiplatch.commands.fleet_watch import Intake, watch
from skiplatch.errors import InputError
from skiplatch.fleet import arrivals
from skiplatch.fleet.arrivals import Arrivals
from skiplatch.fleet.history import read_history
from skiplatch.fleet.reading import opened
from skiplatch.workers import Failed, Workers
from test_fleet_store import DIAGNOSIS

QUIET = Path(__file__).parent / "data" / "bench_no_gap"
LONG_AGO_S = 1e9
PATIENCE_S = 60.0
SETTLE_S = 0.5
LOST_ROWS = 3
"""A campaign of so many touches is lost with its worker."""
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
    """Campaigns that were diagnosed; the search itself is another test's business.

    Several come in the reverse of their order, as from workers that are as fast as they please.
    """
    asked: list[Path | None] = []

    def examine(recorded: Campaign, *_: object) -> SimpleNamespace:
        asked.append(recorded.path)
        return SimpleNamespace(text="", document=DIAGNOSIS, has_gap=True)

    def told_as_done(
        recorded: Sequence[Campaign], _: object, workers: Workers, numbers: Sequence[int]
    ) -> Iterator[tuple[int, Told | Failed]]:
        for number in reversed(numbers):
            asked.append(recorded[number].path)
            if len(recorded[number].touches) == LOST_ROWS:
                yield number, Failed("its worker died")
            else:
                yield number, Told("", DIAGNOSIS, True)

    monkeypatch.setattr(fleet_watch, "examine", examine)
    monkeypatch.setattr(fleet_watch, "told_as_done", told_as_done)
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


def test_touches_that_changed_since_their_diagnosis_are_diagnosed_anew(
    inbox: Path, store: Path, diagnosed: list[Path | None]
) -> None:
    put(inbox / "monday")
    text = json.dumps(DIAGNOSIS | {"fingerprint": "0" * 64})
    (inbox / "monday" / "diagnosis.json").write_text(text)

    once(inbox, store, "--settle-s", AT_ONCE_S)

    assert diagnosed == [inbox / "monday"]
    assert kept(store) == {"monday": "explained"}


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
    folder = put(inbox / "monday")

    result = once(inbox, store, "--settle-s", "60", "--json", "-")

    assert f"{folder}: not whole yet\n0 kept, 0 known already, 1 not whole yet\n" in result.output
    document = json.loads(result.stdout)
    assert (document["not_whole"], document["waiting"]) == (1, [str(folder)])
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
    (put(inbox / "a bad one") / "touches.csv").write_text("touch\n1\n")
    put(inbox / "monday")

    said = refused("fleet", "watch", inbox, "--store", store, "--once", "--settle-s", AT_ONCE_S)

    assert "a bad one/touches.csv" in said
    assert kept(store) == {"monday": "explained"}


@pytest.mark.parametrize("text", ["", "touch,time\n1\n", "time,touch\n2026-03-02,1,2\n\n"])
def test_what_is_no_table_is_one_line(
    inbox: Path, store: Path, diagnosed: list[Path | None], refused: Program, text: str
) -> None:
    (put(inbox / "monday") / "touches.csv").write_text(text)

    said = refused("fleet", "watch", inbox, "--store", store, "--once", "--settle-s", AT_ONCE_S)

    assert "monday/touches.csv" in said
    assert diagnosed == []


def linked(folder: Path) -> None:
    (folder / "link").symlink_to("/etc/passwd")


def timeless(folder: Path) -> None:
    nominal = (folder / "nominal.toml").read_text().replace("campaign/1", "campaign/2")
    (folder / "nominal.toml").write_text(f'{nominal}[notes]\nrecorded_at = "long ago"\n')


@pytest.mark.parametrize(
    ("spoil", "words"),
    [(linked, "link: neither a file nor a folder"), (timeless, "nominal.toml: recorded_at: ")],
)
def test_what_no_store_keeps_is_not_diagnosed(
    inbox: Path,
    store: Path,
    diagnosed: list[Path | None],
    refused: Program,
    spoil: Callable[[Path], None],
    words: str,
) -> None:
    spoil(put(inbox / "monday"))

    said = refused("fleet", "watch", inbox, "--store", store, "--once", "--settle-s", AT_ONCE_S)

    assert f"monday/{words}" in said
    assert diagnosed == []
    assert not list(inbox.glob("*/diagnosis.json"))


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


def test_what_comes_out_of_order_is_kept_in_order_and_what_is_lost_is_named(
    inbox: Path, store: Path, diagnosed: list[Path | None], refused: Program
) -> None:
    days = [put(inbox / name, rows=rows) for name, rows in (("1", 5), ("2", LOST_ROWS), ("3", 6))]

    said = refused("fleet", "watch", inbox, "--store", store, "--once", "--settle-s", AT_ONCE_S)

    assert said == f"skiplatch: {days[1]}: its worker died\n"
    assert diagnosed == list(reversed(days))
    assert list(kept(store)) == ["1", "3"]
    assert not (days[1] / "diagnosis.json").exists()


def test_a_campaign_alone_goes_to_a_cluster_that_is_named(
    inbox: Path, store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Workers] = []

    def told_as_done(
        _recorded: object, _asked: object, workers: Workers, _numbers: object
    ) -> Iterator[tuple[int, Told]]:
        asked.append(workers)
        yield 0, Told("", DIAGNOSIS, True)

    monkeypatch.setattr(fleet_watch, "told_as_done", told_as_done)
    put(inbox / "monday")

    options = ["--cluster", "head:8786", "--jobs", "3", "--task-limit-s", "7"]
    result = once(inbox, store, "--settle-s", AT_ONCE_S, *options)

    assert "1 kept" in result.output
    assert asked == [Workers(jobs=3, cluster="head:8786", limit_s=7.0)]


def test_a_cluster_that_does_not_answer_ends_the_watch(
    inbox: Path, store: Path, refused: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "ANSWER_S", 0.2)
    put(inbox / "monday")

    words = ["fleet", "watch", inbox, "--store", store, "--settle-s", AT_ONCE_S]
    said = refused(*words, "--cluster", "tcp://127.0.0.1:9")

    assert "tcp://127.0.0.1:9: no Dask scheduler answers there" in said


def bytes_below(folder: Path) -> dict[str, bytes | dict[str, bytes]]:
    """What stands in each file, by its path; of an archive, which has times, in its members."""
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    return {path.relative_to(folder).as_posix(): _contents(path) for path in paths}


def _contents(path: Path) -> bytes | dict[str, bytes]:
    if path.suffix != ".zip":
        return path.read_bytes()
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def quiet_inbox(folder: Path, days: Sequence[str]) -> Path:
    """Make campaigns of the same touches and beliefs, in other bytes."""
    for day in days:
        shutil.copytree(QUIET, folder / day)
        few_of(folder / day)
        nominal = folder / day / "nominal.toml"
        text = nominal.read_text().replace("skiplatch-campaign/1", "skiplatch-campaign/2")
        nominal.write_text(f'{text}[notes]\nrecorded_at = "2026-03-02T08:00:00"\n# {day}\n')
    return folder


@pytest.mark.long
def test_a_store_is_the_same_whoever_diagnoses(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    alone, spread, there = (tmp_path / name / "mill-7" for name in ("alone", "spread", "there"))
    quiet_inbox(spread, ["monday", "tuesday"])
    quiet_inbox(there, ["monday", "tuesday"])

    for day in ("monday", "tuesday"):  # one at a time: by this process
        quiet_inbox(alone, [day])
        once(alone, tmp_path / "alone" / "store", "--settle-s", AT_ONCE_S)
    once(spread, tmp_path / "spread" / "store", "--settle-s", AT_ONCE_S, "--jobs", "2")
    once(there, tmp_path / "there" / "store", "--settle-s", AT_ONCE_S, "--cluster", "local:2")

    kept_alone = bytes_below(tmp_path / "alone")
    assert {"store/campaigns.parquet", "mill-7/tuesday/diagnosis.json"} <= kept_alone.keys()
    assert bytes_below(tmp_path / "spread") == kept_alone
    assert bytes_below(tmp_path / "there") == kept_alone


@contextmanager
def watched(
    inbox: Path, store: Path, lines: Path | None = None
) -> Iterator[Callable[[dict[str, str | None]], None]]:
    """Watch a folder meanwhile; gives a function that waits until the store holds what it is to."""
    stop = threading.Event()
    arguments = Intake(store, None, 1, Workers()), Arrivals(inbox, SETTLE_S), stop, lines
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


@contextmanager
def stopped_clock(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], None]]:
    """Let no file grow old, however slow this machine is; gives what waits for a look."""
    now_ns, looks = time.time_ns(), threading.Semaphore(0)

    def time_ns() -> int:
        looks.release()
        return now_ns

    def looked() -> None:
        while looks.acquire(blocking=False):
            pass
        assert looks.acquire(timeout=PATIENCE_S)

    with monkeypatch.context() as patched:
        patched.setattr(arrivals, "time", SimpleNamespace(time_ns=time_ns))
        yield looked


def test_a_watch_takes_what_comes_once_it_is_whole(
    inbox: Path,
    store: Path,
    diagnosed: list[Path | None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    other, lines = put(tmp_path / "elsewhere"), tmp_path / "lines.json"
    lines.write_text("{}\n")
    text = (other / "touches.csv").read_text()
    with watched(inbox, store, lines) as until:
        folder = inbox / "monday"
        folder.mkdir()
        with stopped_clock(monkeypatch) as looked, (folder / "touches.csv").open("w") as file:
            shutil.copy(other / "nominal.toml", folder)
            for line in text.splitlines(keepends=True):
                file.write(line)
                file.flush()
                looked()
                assert diagnosed == []
        until({"monday": "explained"})
        shutil.move(put(tmp_path / "tuesday", rows=8), inbox / "tuesday")
        until({"monday": "explained", "tuesday": "explained"})

    assert len(diagnosed) == 2
    assert [json.loads(line) for line in lines.read_text().splitlines()] == [
        {},
        *(
            {"path": str(inbox / day), "is_kept": True, "said": "kept"}
            for day in ("monday", "tuesday")
        ),
    ]


def test_a_watch_tells_each_campaign_as_a_line_of_json(
    inbox: Path, store: Path, diagnosed: list[Path | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    (put(inbox / "bad") / "touches.csv").write_text("touch\nx\n")
    put(inbox / "good")

    look = Arrivals.look

    def looked(self: Arrivals) -> object:
        if self.dealt_with:
            raise KeyboardInterrupt
        return look(self)

    monkeypatch.setattr(fleet_watch, "UNNOTICED_S", 0.0)
    with monkeypatch.context() as patched:
        patched.setattr(Arrivals, "look", looked)
        words = ["--store", str(store), "--settle-s", AT_ONCE_S, "--json", "-"]
        result = CliRunner().invoke(group, ["fleet", "watch", str(inbox), *words])

    assert result.exit_code == 130
    bad, good = map(json.loads, result.stdout.splitlines())
    assert (bad["path"], bad["is_kept"]) == (str(inbox / "bad"), False)
    assert bad["said"].startswith(str(inbox / "bad" / "touches.csv"))
    assert good == {"path": str(inbox / "good"), "is_kept": True, "said": "kept"}


@pytest.mark.long
def test_a_watch_waits_for_another_writer_and_survives_a_bad_campaign(
    inbox: Path,
    store: Path,
    diagnosed: list[Path | None],
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """What comes is moved into its place: on a slow machine the watch may see it half-written."""
    put(inbox / "monday")
    (put(tmp_path / "bad") / "touches.csv").write_text("touch\nx\n")
    mended = tmp_path / "mended.csv"
    mended.write_text((inbox / "monday" / "touches.csv").read_text().replace("\n", "\r\n"))
    once(inbox, store, "--settle-s", AT_ONCE_S)
    with watched(inbox, store) as until:
        with (store / "lock").open("r+") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            shutil.move(put(tmp_path / "tuesday", rows=8), inbox / "tuesday")
            shutil.move(tmp_path / "bad", inbox / "bad")
            while len(diagnosed) < 2:
                time.sleep(0.02)
            assert list(kept(store)) == ["monday"]
        until({"monday": "explained", "tuesday": "explained"})
        shutil.move(mended, inbox / "bad" / "touches.csv")
        until({"monday": "explained", "tuesday": "explained", "bad": "explained"})

    assert capfd.readouterr().err.count("skiplatch: ") == 1
