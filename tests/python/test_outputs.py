"""Where commands write: refused before the work, to stdout where asked, pages of every kind."""

import fcntl
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from conftest import SAMPLES
from hostile import Place, places
from skiplatch.campaign import read_campaign
from skiplatch.cli import group
from skiplatch.commands.outputs import OutputFolder
from skiplatch.errors import InputError
from skiplatch.places import ROOT

LOG = Path(__file__).parent / "data" / "logs" / "klippy.log"
WRITTEN = [place for place in places() if place.is_output]


def leaf(words: tuple[str, ...]) -> click.Command:
    command: click.Command = group
    for word in words:
        assert isinstance(command, click.Group)
        found = command.get_command(click.Context(command), word)
        assert found is not None
        command = found
    return command


@pytest.mark.parametrize("place", WRITTEN, ids=str)
def test_output_that_cannot_be_is_refused_before_the_work(place: Place, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    path = tmp_path / "file" / "x"
    option = next(o for o in leaf(place.command).params if place.option in o.opts)

    with pytest.raises(InputError, match=r"x: cannot write: Not a directory"):
        option.type.convert(str(path), option, None)


@pytest.mark.parametrize("option", ["--json", "--html", "--picture"])
def test_no_work_is_done_for_an_output_that_cannot_be(tmp_path: Path, option: str) -> None:
    (tmp_path / "file").write_text("")
    words = ["repeat", str(tmp_path / "absent.log"), option, str(tmp_path / "file" / "x")]

    result = CliRunner().invoke(group, words)

    assert isinstance(result.exception, InputError)
    assert "x: cannot write" in str(result.exception)


@pytest.mark.parametrize("place", WRITTEN, ids=str)
@pytest.mark.parametrize("name", ["", "a/"])
def test_what_names_no_file_is_no_output(name: str, place: Place) -> None:
    option = next(o for o in leaf(place.command).params if place.option in o.opts)
    if name and isinstance(option.type, OutputFolder):
        return

    with pytest.raises(click.BadParameter, match=r"expected the name of a "):
        option.type.convert(name, option, None)


def test_a_full_device_is_refused_before_the_work(tmp_path: Path) -> None:
    words = ["repeat", str(tmp_path / "absent.log"), "--json", "/dev/full"]

    result = CliRunner().invoke(group, words)

    assert str(result.exception) == "/dev/full: cannot write: No space left on device"


def test_whatever_is_written_with_out_has_a_short_name() -> None:
    outs = [place for place in WRITTEN if place.option == "--out"]
    assert len(outs) > 10
    for place in outs:
        option = next(o for o in leaf(place.command).params if place.option in o.opts)
        assert "-o" in option.opts, place


def skiplatch(*words: str, encoding: str = "utf-8") -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "skiplatch", *words]
    environment = os.environ | {"PYTHONIOENCODING": encoding}
    return subprocess.run(
        command, capture_output=True, encoding=encoding, env=environment, check=False
    )


def test_characters_that_a_terminal_lacks_end_no_command() -> None:
    done = skiplatch("repeat", str(LOG), encoding="latin-1")

    assert done.returncode == 0
    assert "scatter by ? = " in done.stdout
    assert " µm" in done.stdout


def test_what_does_not_go_to_stdout_makes_no_file_of_that_name(tmp_path: Path) -> None:
    with chdir(tmp_path):
        result = CliRunner().invoke(
            group, ["predict", str(SAMPLES / "bench_isr_latency"), "-o", "-"]
        )

    assert result.exit_code == 2
    assert "this is not written to stdout" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_page_goes_to_stdout_alone() -> None:
    done = CliRunner().invoke(group, ["repeat", str(LOG), "--html", "-"])

    assert done.exit_code == 0
    assert done.stdout.startswith("<!DOCTYPE html>")
    assert done.stdout.rstrip().endswith("</html>")
    assert "touches of one surface scatter" in done.stderr


def test_only_one_document_goes_to_stdout(tmp_path: Path) -> None:
    words, page = ["repeat", str(LOG), "--json", "-", "--html"], tmp_path / "x.html"
    both = CliRunner().invoke(group, [*words, "-"])
    one = CliRunner().invoke(group, [*words, str(page)])

    assert both.exit_code == 2
    assert "only one document can go to stdout" in both.stderr
    assert json.loads(one.stdout)["n"] == 3
    assert "<svg" in page.read_text()


@pytest.mark.parametrize(
    ("shell", "at", "said"),
    [
        ("bash", "1", "plain,diagnose"),
        ("zsh", "1", "plain\ndiagnose\nSay where the gap of each CAMPAIGN lies,..."),
        ("fish", "diag", "plain,diagnose\tSay where the gap of each CAMPAIGN lies,..."),
    ],
)
def test_shell_completes_commands(shell: str, at: str, said: str) -> None:
    command = [sys.executable, "-m", "skiplatch"]
    environment = {"_SKIPLATCH_COMPLETE": f"{shell}_complete", "COMP_WORDS": "skiplatch diag"}

    done = subprocess.run(
        command,
        env={**environment, "COMP_CWORD": at},
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.stdout.strip() == said


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_line_of_the_tutorial_makes_a_shell_complete(shell: str) -> None:
    page = (ROOT / "docs/TUTORIAL.md").read_text()
    variable = f"_SKIPLATCH_COMPLETE={shell}_source"

    done = subprocess.run(
        [sys.executable, "-m", "skiplatch"],
        env=dict([variable.split("=")]),
        capture_output=True,
        text=True,
        check=False,
    )

    assert f'eval "$({variable} skiplatch)"' in page
    assert "_skiplatch_completion" in done.stdout
    assert f"{shell}_complete" in done.stdout


def leaves(
    command: click.Command = group, words: tuple[str, ...] = ()
) -> Iterator[tuple[str, ...]]:
    """Give the words of every command that does something."""
    if not isinstance(command, click.Group):
        yield words
        return
    context = click.Context(command)
    for name in command.list_commands(context):
        found = command.get_command(context, name)
        assert found is not None
        yield from leaves(found, (*words, name))


@pytest.mark.parametrize("words", list(leaves()), ids=" ".join)
def test_every_command_has_json_and_an_example_of_itself(words: tuple[str, ...]) -> None:
    command = leaf(words)

    assert "--json" in {name for option in command.params for name in option.opts}
    assert f"skiplatch {' '.join(words)}" in f"{command.help}{command.epilog}"


SMALL_PIPE = 4096  # bytes: every page of HTML is longer, and waits for its reader


def without_reader(*words: str, read: int = 0) -> tuple[int, str]:
    """Run with a real pipe behind stdout, whose reader leaves: at once, or after some bytes."""
    command = [sys.executable, "-m", "skiplatch", *words]
    ours, theirs = os.pipe()
    fcntl.fcntl(theirs, fcntl.F_SETPIPE_SZ, SMALL_PIPE)
    with subprocess.Popen(command, stdout=theirs, stderr=subprocess.PIPE, text=True) as process:
        os.close(theirs)
        if read:
            os.read(ours, read)
        os.close(ours)
        _, noise = process.communicate()
    return process.returncode, noise


@pytest.mark.parametrize("words", ["--help", "--version", "columns --help", "columns"])
def test_a_reader_that_leaves_ends_a_command_quietly(words: str) -> None:
    assert without_reader(*words.split()) == (128 + signal.SIGPIPE, "")


def test_a_reader_that_leaves_amid_a_long_document_ends_it_quietly() -> None:
    status, noise = without_reader("repeat", str(LOG), "--html", "-", read=1)

    assert status == 128 + signal.SIGPIPE
    assert "touches of one surface scatter" in noise
    assert "Error" not in noise


def test_what_was_said_to_be_written_stands_when_the_reader_leaves(tmp_path: Path) -> None:
    out = tmp_path / "campaign"

    status, noise = without_reader("import", "klipper", str(LOG), "--out", str(out))

    assert (status, noise) == (128 + signal.SIGPIPE, "")
    assert read_campaign(out).touches


def test_no_output_is_missed_where_stdout_and_stderr_are_closed(tmp_path: Path) -> None:
    closed = f"exec {sys.executable} -m skiplatch effects --json {tmp_path}/e.json >&- 2>&-"

    assert subprocess.run(["/bin/sh", "-c", closed], check=False).returncode == 0
    assert json.loads((tmp_path / "e.json").read_text())


@pytest.mark.parametrize("words", ["columns", "effects --json -", "--help", "columns --help"])
def test_a_result_that_a_closed_stdout_would_lose_is_refused(words: str) -> None:
    closed = f"exec {sys.executable} -m skiplatch {words} >&-"

    done = subprocess.run(["/bin/sh", "-c", closed], check=False, stderr=subprocess.PIPE, text=True)

    assert (done.returncode, done.stderr.splitlines(keepends=True)[-1]) == (
        2,
        "skiplatch: stdout: cannot write: Bad file descriptor\n",
    )


def test_a_folder_is_not_written_to_stdout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = (SAMPLES / "bench_isr_latency").resolve()
    monkeypatch.chdir(tmp_path)
    words = ["simulate", "--nominal", str(campaign / "nominal.toml"), "--conditions",
             str(campaign / "touches.csv"), "-o", "-"]  # fmt: skip

    said = CliRunner().invoke(group, words)

    assert said.exit_code == 2
    assert "expected the name of a folder: this is not written to stdout" in said.stderr
    assert not list(tmp_path.iterdir())
