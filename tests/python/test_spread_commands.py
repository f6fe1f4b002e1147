"""Commands that spread their work: the same bytes on any workers; what is done is kept."""

import json
import shutil
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from one_thread import one_thread
from played_campaigns import few_of
from skiplatch import cli
from skiplatch.campaign import NOMINAL_FILE
from skiplatch.commands import diagnose_many, worker_options
from skiplatch.commands.diagnose_many import Told
from skiplatch.commands.examining import Asked
from skiplatch.commands.kept import Kept, key_of

QUIET = Path(__file__).parent / "data" / "bench_no_gap"
MANY = 4
LOOKED_EVERY_S = 0.2
LATCH = ["latch", "--touches", "200000", "--path", "skip"]


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(cli.group, [str(argument) for argument in arguments])


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    """Two campaigns of the same touches and beliefs, in other bytes."""
    copies = [tmp_path / "first", tmp_path / "second"]
    for copy in copies:
        shutil.copytree(QUIET, copy)
        with (copy / NOMINAL_FILE).open("a") as file:
            file.write(f"# {copy.name}\n")
    return copies


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Diagnose in this process, in no time; gives how many campaigns were, each time."""
    counts: list[int] = []

    def told(
        _: object, asked: Asked, workers: object, numbers: Sequence[int]
    ) -> Iterator[tuple[int, Told]]:
        counts.append(len(numbers))
        for number in reversed(numbers):
            yield number, Told(f"text {number}", {"verdict": "no_gap", "seed": asked.seed}, False)

    monkeypatch.setattr(diagnose_many, "told_as_done", told)
    return counts


@pytest.mark.long
def test_a_cluster_gives_the_same_bytes(tmp_path: Path, folders: list[Path]) -> None:
    pytest.importorskip("distributed")
    here, there = tmp_path / "here.json", tmp_path / "there.json"

    assert run(*LATCH, "--json", here).exit_code == 0
    assert run(*LATCH, "--json", there, "--cluster", "local:2").exit_code == 0
    assert here.read_bytes() == there.read_bytes()


@pytest.mark.long
def test_touches_that_were_played_are_not_played_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker_options, "opened", one_thread)
    here, there, part = (tmp_path / name for name in ("a.json", "b.json", "b.json.part"))
    command: list[str | Path] = [*LATCH, "--json", there, "--cluster", "local:1"]
    assert run(*LATCH, "--json", here).exit_code == 0
    with monkeypatch.context() as cut:
        cut.setattr(Kept, "drop", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        assert run(*command).exit_code == 130
    assert not there.exists()
    answers = sorted(part.iterdir())
    assert answers
    answers[0].unlink()
    stamps = {path: path.stat().st_mtime_ns for path in answers[1:]}
    with monkeypatch.context() as cut:
        cut.setattr(Kept, "drop", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        assert run(*command).exit_code == 130
    assert {path: path.stat().st_mtime_ns for path in answers[1:]} == stamps

    assert run(*command).exit_code == 0
    assert there.read_bytes() == here.read_bytes()
    assert not part.exists()


@contextmanager
def killing(kept: Path) -> Iterator[list[int]]:
    """Kill a worker of a cluster that this process runs after each answer; gives those that were.

    By answers and not by the clock: on a slow machine no task would end between two kills.

    Args:
        kept: The folder that answers come to, a file each.
    """
    psutil = pytest.importorskip("psutil")
    killed: list[int] = []
    stop = threading.Event()

    def kill() -> None:
        while not stop.wait(LOOKED_EVERY_S):
            if len(list(kept.glob("*"))) <= len(killed):
                continue
            with suppress(psutil.NoSuchProcess):  # one has just ended by itself
                children = psutil.Process().children(recursive=True)
                found = [child for child in children if "spawn_main" in " ".join(child.cmdline())]
                for child in found[len(killed) % 2 : len(killed) % 2 + 1]:
                    child.kill()
                    killed.append(child.pid)

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        yield killed
    finally:
        stop.set()
        thread.join()


@pytest.mark.long
def test_campaigns_are_diagnosed_as_alone_also_where_workers_are_killed(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    folders = [tmp_path / f"campaign_{number}" for number in range(MANY)]
    for number, folder in enumerate(folders):
        shutil.copytree(QUIET, folder)
        few_of(folder)
        with (folder / NOMINAL_FILE).open("a") as file:
            file.write(f"# {number}\n")
    alone, here, there = (tmp_path / f"{name}.json" for name in ("alone", "here", "there"))
    assert run("diagnose", folders[0], "--json", alone).exit_code == 0
    assert run("diagnose", *folders, "--json", here, "--jobs", "2").exit_code == 0

    with killing(there.with_name("there.json.part")) as killed:
        result = run("diagnose", *folders, "--json", there, "--cluster", "local:2")

    assert result.exit_code == 0, result.output
    assert killed
    assert there.read_bytes() == here.read_bytes()
    assert json.loads(here.read_text()) == [json.loads(alone.read_text())] * MANY


@pytest.mark.long
def test_a_campaign_that_takes_too_long_is_named(tmp_path: Path, folders: list[Path]) -> None:
    out = tmp_path / "out.json"

    result = run("diagnose", *folders, "--json", out, "--jobs", "1", "--task-limit-s", "0.001")

    assert f"skiplatch: {folders[0]}: it took too long, 3 times" in result.output
    assert str(result.exception) == f"{folders[1]}: it took too long, 3 times"
    assert not out.exists()


def test_what_comes_out_of_order_is_told_in_order(
    tmp_path: Path, folders: list[Path], counted: list[int]
) -> None:
    result = run("diagnose", *folders, "--json", tmp_path / "out.json")

    assert result.exit_code == 0, result.output
    assert result.output.index("text 0") < result.output.index("text 1")
    assert not (tmp_path / "out.json.part").exists()


def test_what_was_done_is_not_done_again(
    tmp_path: Path, folders: list[Path], counted: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out.json"
    command: list[str | Path] = ["diagnose", *folders, "--json", out]
    with monkeypatch.context() as cut:
        cut.setattr(Kept, "drop", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        assert run(*command).exit_code == 130
    assert not out.exists()
    first = sorted((tmp_path / "out.json.part").iterdir())
    assert len(first) == 2

    first[0].write_text("{")
    assert run(*command).exit_code == 0

    assert counted == [2, 1]
    assert [one["verdict"] for one in json.loads(out.read_text())] == ["no_gap", "no_gap"]
    assert not (tmp_path / "out.json.part").exists()


@pytest.mark.parametrize("name", ["notes.txt", "f" * 64 + "/x", "nominal.toml"])
def test_a_folder_of_others_is_refused_before_the_work(
    name: str, tmp_path: Path, folders: list[Path], counted: list[int]
) -> None:
    theirs = tmp_path / "out.json.part" / name
    theirs.parent.mkdir(parents=True)
    theirs.write_text("theirs")

    result = run("diagnose", *folders, "--json", tmp_path / "out.json")

    told = "expected nothing, or answers of an earlier diagnosis and no other file"
    assert str(result.exception) == f"{tmp_path / 'out.json.part'}: {told}"
    assert not counted
    assert theirs.read_text() == "theirs"


def test_what_others_put_among_the_answers_is_left(tmp_path: Path) -> None:
    kept = Kept.beside(tmp_path / "out.json")
    kept.put("f" * 64, {})
    (tmp_path / "out.json.part" / "theirs").write_text("theirs")

    kept.drop()

    assert [path.name for path in (tmp_path / "out.json.part").iterdir()] == ["theirs"]


def test_an_answer_is_that_of_its_bytes_question_and_software(folders: list[Path]) -> None:
    keys = {
        key_of(folder, Asked(seed=seed), software)
        for folder in folders
        for seed in (1, 2)
        for software in ("0.1.0", "0.2.0")
    }

    assert len(keys) == 8
    assert key_of(folders[0], Asked(seed=1), "0.1.0") in keys


@pytest.mark.parametrize("address", ["", "local:", "local:0", "local:2000", "head", "head:x"])
def test_an_address_that_is_none_is_refused(address: str) -> None:
    result = run("diagnose", QUIET, "--cluster", address)

    assert result.exit_code == 2
    assert "expected local:N with 1 to 1024 workers, or HOST:PORT, got" in result.output
