"""Every file option of every command against every hostile file: one line and status 2.

Commands and options are found by themselves, so a new one is tested as well.
"""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import click
import pytest
from click.testing import CliRunner

from hostile import HOSTILE, Place, call, commands, make, places
from skiplatch.cli import group
from skiplatch.errors import InputError

# python-can's reader of BLF leaves the file to the garbage collector where its head is wrong.
LEFT_OPEN = "ignore:Exception ignored in. <_io.FileIO name=.*hostile.blf"
pytestmark = pytest.mark.filterwarnings(f"{LEFT_OPEN}:pytest.PytestUnraisableExceptionWarning")
PATIENCE_S = 60
READ = [place for place in places() if not place.is_output]
FINE = {
    ("--truth", "empty"),
    ("--truth", "mark alone"),
    ("--changed", "empty"),
    ("--changed", "mark alone"),
    ("--memory", "missing"),
    ("--memory", "link to itself"),
    ("fleet add --store", "missing"),
    ("fleet add --store", "folder"),
    ("fleet watch --store", "missing"),
    ("fleet watch --store", "folder"),
    ("fleet watch argument 1", "folder"),
}
"""A truth without errors, stores that are made anew, a folder in which nothing has appeared."""
TEXTS = {
    *("--map", "--probe", "--latch", "--report", "--plc-latch"),
    *("interface", "--can", "--can-backend", "--chip", "--inject-line"),
    *("--rig", "rig", "sql", "campaign", "campaigns"),
}
"""What takes any text and no path; chips and interfaces are of the system."""
FEW = ["fifo", "a terabyte", "no UTF-8", "deep object", "a list"]
MANY = [kind for kind in HOSTILE if kind not in FEW]


@contextmanager
def patience() -> Iterator[None]:
    """Raise what no command catches when it hangs."""

    def hangs(number: int, frame: FrameType | None) -> None:
        raise AssertionError("it hangs")

    before = signal.signal(signal.SIGALRM, hangs)
    signal.alarm(PATIENCE_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def check(place: Place, kind: str, folder: Path) -> None:
    (folder / "in").mkdir()
    path = make(kind, folder / "in", place.ending)
    with patience():
        result = CliRunner().invoke(group, call(place, path, folder / "out"))

    if {(place.option, kind), (str(place), kind)} & FINE:
        assert result.exit_code == 0, result.output
        return
    assert not (folder / "out").exists()
    if isinstance(result.exception, InputError):
        assert len(str(result.exception).splitlines()) == 1
    else:
        assert isinstance(result.exception, SystemExit), repr(result.exception)
        assert result.exit_code == 2, result.output


@pytest.mark.parametrize("kind", FEW)
@pytest.mark.parametrize("place", READ, ids=str)
def test_a_hostile_file_is_refused(place: Place, kind: str, tmp_path: Path) -> None:
    check(place, kind, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("kind", MANY)
@pytest.mark.parametrize("place", READ, ids=str)
def test_any_hostile_file_is_refused(place: Place, kind: str, tmp_path: Path) -> None:
    check(place, kind, tmp_path)


def test_no_path_is_taken_as_a_text() -> None:
    """Or it would not be among the places above."""
    parameters = [parameter for _, command in commands() for parameter in command.params]
    found = {
        max(p.opts, key=len) for p in parameters if isinstance(p.type, click.types.StringParamType)
    }

    assert found == TEXTS


def test_a_ratio_of_a_thousand_million_digits_is_refused() -> None:
    command = ["transmission", "x.csv", "--lines1", "9", "--lines2", "9", "--ratio", "1e999999999"]
    with patience():
        result = CliRunner().invoke(group, command)

    assert result.exit_code == 2
    assert "is no fraction such as 407/10" in result.output


def test_a_full_disk_behind_stdout_is_one_line() -> None:
    command = [sys.executable, "-m", "skiplatch.cli", "effects"]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)

    assert done.returncode == 2
    assert done.stderr == "skiplatch: stdout: cannot write: No space left on device\n"
