"""The outputs of one command are all there or none, whatever fails while they are written."""

import errno
import io
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any, NoReturn

import click
import pytest
from click.testing import CliRunner, Result

from hostile import CAMPAIGN, KINEMATICS, LOGS
from skiplatch import undo
from skiplatch.cli import group
from skiplatch.commands import kinematics_run
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_folder, atomic_write_text

CONDITIONS = str(CAMPAIGN / "touches.csv")
NOMINAL = str(CAMPAIGN / "nominal.toml")
COMMANDS = {
    "simulate": f"simulate --nominal {NOMINAL} --conditions {CONDITIONS} --out OUT/new "
    "--json OUT/j",
    "predict": f"predict {CAMPAIGN} --conditions {CONDITIONS} --out OUT/a --json OUT/j",
    "import": f"import klipper {LOGS}/klippy.log --out OUT/new --json OUT/j",
    "repeat": f"repeat {LOGS}/klippy.log --json OUT/j --picture OUT/p.svg",
    "kinematics run": f"kinematics run {KINEMATICS}/save_and_check.h --memory OUT/m "
    "--html OUT/h.html --json OUT/j --points OUT/p --corrected OUT/c",
}
STATE = {"m"}
"""What is no output but lasts: a store of kinematics."""


def call(name: str, out: Path) -> Result:
    return CliRunner().invoke(group, COMMANDS[name].replace("OUT", str(out)).split())


def contents(folder: Path) -> dict[str, bytes]:
    """Give every file below the folder, temporary ones too, but for what is no output."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name not in STATE]
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(files)}


class Faults:
    """Calls of the operating system that fail, from the n-th on `width` of them."""

    def __init__(self, patch: pytest.MonkeyPatch, folder: Path, number: int) -> None:
        self._folder = str(folder)
        self._left = number
        self.has_failed = False
        for name in ("fsync", "replace", "rename", "link", "mkdir"):
            patch.setattr(os, name, self._counted(getattr(os, name)))
        patch.setattr(io, "open", self._open(io.open))

    def _count(self) -> None:
        self._left -= 1
        if self._left == 0:
            self.has_failed = True
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _counted(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def counted(target: Any, *rest: Any, **options: Any) -> Any:  # noqa: ANN401
            if isinstance(target, int) or str(target).startswith(self._folder):
                self._count()
            return function(target, *rest, **options)

        return counted

    def _open(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def opened(path: Any, mode: str = "r", *rest: Any, **options: Any) -> Any:  # noqa: ANN401
            if not str(path).startswith(self._folder) or "x" not in mode:
                return function(path, mode, *rest, **options)
            self._count()
            file = function(path, mode, *rest, **options)
            return _FullDisk(file, self._count)

        return opened


class _FullDisk:
    """A file whose writes may fail, half of them written."""

    def __init__(self, file: Any, count: Callable[[], None]) -> None:  # noqa: ANN401
        self._file = file
        self._count = count

    def write(self, data: bytes) -> None:
        self._file.write(data[: len(data) // 2])
        self._count()
        self._file.write(data[len(data) // 2 :])

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        return getattr(self._file, name)

    def __enter__(self) -> "_FullDisk":
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def prepared(name: str, folder: Path, *, stood: bool) -> dict[str, bytes]:
    """Make the folder of outputs, with old ones in it that will be replaced, and give them."""
    folder.mkdir()
    for word in COMMANDS[name].split() if stood else ():
        path = folder / word.removeprefix("OUT/")
        if word.startswith("OUT/") and path.name not in {"new", *STATE}:
            path.write_text("old")
    return contents(folder)


@pytest.fixture
def played_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a program for the kinematics be run and drawn once only, for that takes long."""
    for name in ("run_program", "_log"):
        monkeypatch.setattr(kinematics_run, name, _once(getattr(kinematics_run, name)))


def _once(function: Callable[..., Any]) -> Callable[..., Any]:
    results: list[Any] = []

    def once(*arguments: Any) -> Any:  # noqa: ANN401
        results[:] = results or [function(*arguments)]
        return results[0]

    return once


@pytest.mark.usefixtures("played_once")
@pytest.mark.parametrize("stood", [False, True], ids=["nothing there", "old ones there"])
@pytest.mark.parametrize("name", COMMANDS)
def test_any_call_that_fails_leaves_all_as_it_was(
    name: str, stood: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = 0
    for number in count(1):
        folder = tmp_path / str(number)
        before = prepared(name, folder, stood=stood)
        with monkeypatch.context() as patch:
            faults = Faults(patch, folder, number)
            result = call(name, folder)
        if result.exit_code == 0:  # without a fault, or with one that was made up for
            after = contents(folder)
            assert not [path for path in after if path.startswith(".skiplatch")]
            assert all(after[path] != before[path] for path in before)
            if not faults.has_failed:
                break
        else:
            refused += 1
            assert faults.has_failed, result.exception
            assert isinstance(result.exception, InputError), result.exception
            assert contents(folder) == before, f"after fault {number}"

    assert refused >= 2 * COMMANDS[name].count("OUT/")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_takes_back_what_was_written(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def write_json(*_: object) -> None:
        assert (tmp_path / "new" / "touches.csv").exists()
        signal.raise_signal(number)

    monkeypatch.setattr("skiplatch.commands.simulate.write_json", write_json)
    # Whoever runs the tests in the background may have had SIGINT ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)

    try:
        result = call("simulate", tmp_path)
    finally:
        signal.signal(signal.SIGINT, before)

    assert result.exit_code == (undo.INTERRUPTED if number == signal.SIGINT else 128 + number)
    assert result.stderr == "interrupted\n"
    assert not contents(tmp_path)


def test_what_others_put_there_meanwhile_is_left_alone(tmp_path: Path) -> None:
    def write() -> NoReturn:
        atomic_write_text(tmp_path / "a", "ours")
        (tmp_path / "theirs").write_text("theirs")
        (tmp_path / "theirs").replace(tmp_path / "a")
        raise InputError(tmp_path, None, None, "wrong")

    with pytest.raises(InputError), undo.taken_back_on_failure():
        write()

    assert contents(tmp_path) == {"a": b"theirs"}


def test_an_occupied_folder_is_not_taken_back(tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / "theirs").write_text("theirs")

    with pytest.raises(InputError), undo.taken_back_on_failure():
        atomic_write_folder(tmp_path / "new", {"a": "ours"})

    assert contents(tmp_path) == {"new/theirs": b"theirs"}


def test_folders_that_were_made_for_an_output_are_taken_back(tmp_path: Path) -> None:
    (tmp_path / "old").mkdir()

    def write_two(folder: Path, second: Path) -> None:
        with undo.taken_back_on_failure():
            atomic_write_folder(folder / "new" / "campaign", {"a": "first"})
            atomic_write_text(second, "second")

    with pytest.raises(InputError):
        write_two(tmp_path / "old", tmp_path / "no" / "such")
    assert [path.name for path in tmp_path.rglob("*")] == ["old"]

    write_two(tmp_path / "old", tmp_path / "second")
    assert (tmp_path / "old" / "new" / "campaign" / "a").read_text() == "first"


def test_a_full_disk_leaves_no_folder_for_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_space(number: int) -> NoReturn:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), number)

    monkeypatch.setattr(os, "fsync", no_space)
    words = ["latch", "--touches", "200", "--pictures", str(tmp_path / "new" / "pictures")]

    result = CliRunner().invoke(group, words)

    assert isinstance(result.exception, InputError)
    assert str(result.exception).endswith("cannot write: No space left on device")
    assert not list(tmp_path.iterdir())


def test_an_exit_status_that_is_asked_for_keeps_the_outputs(tmp_path: Path) -> None:
    def write() -> NoReturn:
        atomic_write_text(tmp_path / "a", "ours")
        raise click.exceptions.Exit(1)

    with pytest.raises(click.exceptions.Exit), undo.taken_back_on_failure():
        write()

    assert contents(tmp_path) == {"a": b"ours"}


def test_leftovers_of_a_kill_are_swept_once_they_are_old(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".skiplatch-0123456789abcdef.tmp").write_text("half")
    (tmp_path / ".skiplatch-fedcba9876543210.tmp").mkdir()
    atomic_write_text(tmp_path / "a", "1")
    assert len(list(tmp_path.iterdir())) == 3

    monkeypatch.setattr(undo, "LEFTOVER_S", -60.0)
    atomic_write_text(tmp_path / "b", "2")

    assert contents(tmp_path) == {"a": b"1", "b": b"2"}
    assert len(list(tmp_path.iterdir())) == 2


def test_a_program_that_is_terminated_leaves_nothing(tmp_path: Path) -> None:
    slow = COMMANDS["simulate"].replace("OUT", str(tmp_path)).replace("/j", "/fifo").split()
    os.mkfifo(tmp_path / "fifo")
    program = subprocess.Popen([sys.executable, "-m", "skiplatch", *slow])
    while not (tmp_path / "new").exists():  # it then waits for a reader of its JSON
        assert program.poll() is None
        time.sleep(0.01)
    program.send_signal(signal.SIGTERM)

    assert program.wait(timeout=60) == 128 + signal.SIGTERM
    assert not contents(tmp_path)
    assert not (tmp_path / "new").exists()
