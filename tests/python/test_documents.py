"""Commands in README, docs and --help: each is one that the command line takes.

Every command is parsed as it stands, effects and choices with it, and the project's own files that
it names are there. The examples of --help are run, where nothing has to be measured first. What
stands below a command is what it prints, in whole paragraphs; of the tutorial test_tutorial.py
compares all of it.
"""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner

from skiplatch.cli import group

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"```(?:sh)?\n(.*?)```", re.DOTALL)
SHOWN = re.compile(r"```sh\n((?:[^`]|`(?!``))*?)```\n+```(?:text)?\n(.*?)```", re.DOTALL)
SLOW = "diagnose"
COMMAND = re.compile(r"^\s*(?:Example: )?(?:\.venv/bin/)?skiplatch (.+)$")
NOT_YET = "stylus_bending"
"""An effect that a reader of docs/WITHHELD.md adds."""
ASSIGNMENT = re.compile(r"^(\w+)='([^']*)'$", re.MULTILINE)
FEWEST = {"documents": 35, "help": 35, "printed": 3, "run": 15}
QUICK = ("check", "columns", "import", "init", "repeat", "simulate", "effects")
NOT_HERE = (
    "bench",
    "fleet watch",
    "import mdf",
    "settle",
    "transmission",
    "compensate",
    "kinematics fit",
    "kinematics probing",
    "kinematics sphere",
)
"""Their examples need a bus, a board, or what a user has measured."""
DIAGNOSED_ELSEWHERE = "pretravel"
"""Its example diagnoses what it recorded: test_pretravel_experiment.py does, and holds the name."""
LOGS = {
    "klippy.log": "klippy.log",
    "probe.txt": "linuxcnc_probe.txt",
    "probe.ngc": "linuxcnc_probe.ngc",
    "serial.log": "grbl_serial.log",
    "x_axis.csv": "iso230_x.csv",
    "m48.log": "marlin_m48.log",
}
"""The user's logs in examples, and those that stand for them."""


def commands_in(text: str) -> Iterator[list[str]]:
    """Give the words of each command; lines that end with a backslash go on."""
    for name, value in ASSIGNMENT.findall(text):
        text = text.replace(f"${name}", value)
    for line in text.replace("\\\n", " ").splitlines():
        if command := COMMAND.match(line):
            yield shlex.split(command[1], comments=True)


def leaves(command: click.Command, name: str) -> Iterator[tuple[str, click.Command]]:
    yield name, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for inner in command.list_commands(context):
            found = command.get_command(context, inner)
            assert found is not None
            yield from leaves(found, f"{name} {inner}")


def documented() -> list[tuple[str, list[str]]]:
    return [
        (path.name, words)
        for path in DOCUMENTS
        for block in BLOCK.findall(path.read_text())
        for words in commands_in(block)
        if NOT_YET not in " ".join(words)
    ]


def printed() -> list[Any]:
    """Give each block of commands with what stands below it."""
    return [
        pytest.param(
            list(commands_in(block)),
            expected,
            id=f"{path.name}: {block.splitlines()[-1]}",
            marks=[pytest.mark.long] * (SLOW in block),
        )
        for path in DOCUMENTS
        if path.name != "TUTORIAL.md"
        for block, expected in SHOWN.findall(path.read_text())
        if list(commands_in(block))
    ]


def shown_by_help() -> list[tuple[str, list[str]]]:
    return [
        (f"{name} --help", words)
        for name, command in leaves(group, "skiplatch")
        for words in commands_in(f"{command.epilog or ''}\n{command.help or ''}")
    ]


def runnable() -> list[Any]:
    """Give the examples of each --help that need nothing but the checkout and a log."""
    examples: dict[str, list[list[str]]] = {}
    for where, words in shown_by_help():
        name = where.removeprefix("skiplatch").removesuffix("--help").strip()
        theirs = "mill" in words or words[:2] == ["import", "can"]
        again = name == DIAGNOSED_ELSEWHERE and words[0] == "diagnose"
        if not name.startswith(NOT_HERE) and not theirs and not again:
            examples.setdefault(name, []).append(words)
    return [
        pytest.param(commands, id=name, marks=[pytest.mark.long] * (not name.startswith(QUICK)))
        for name, commands in examples.items()
    ]


def parse(words: list[str]) -> None:
    """Parse a command to its end, without doing anything."""
    command: click.Command = group
    while isinstance(command, click.Group):
        found = command.get_command(click.Context(command), words[0])
        assert found is not None, f"no command {words[0]}"
        command, words = found, words[1:]
    with command.make_context(command.name, list(words)) as context:
        assert context.params


@pytest.fixture(autouse=True)
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that has the project's files, and an empty build/."""
    for name in ("scripts", "tests", "docs"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "build").mkdir()
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("where", "words"), [*documented(), *shown_by_help()], ids=str)
def test_command_is_one(where: str, words: list[str]) -> None:
    if words == ["COMMAND"]:
        return
    parse(words)
    own = [word for word in words if word.startswith(("scripts/", "tests/", "docs/"))]
    assert [word for word in own if not Path(word).exists()] == []


@pytest.mark.parametrize(("commands", "expected"), printed())
def test_command_prints_what_stands_below_it(commands: list[list[str]], expected: str) -> None:
    said = ""
    for words in commands:
        result = CliRunner().invoke(group, words, catch_exceptions=False)
        assert result.exit_code == 0, result.output
        said += "\n".join(line.rstrip() for line in result.output.splitlines()) + "\n"

    for paragraph in expected.strip().split("\n\n"):
        assert paragraph in said


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
@pytest.mark.parametrize("commands", runnable())
def test_examples_of_help_run(commands: list[list[str]]) -> None:
    for name, log in LOGS.items():
        Path(name).symlink_to(ROOT / "tests/python/data/logs" / log)
    capture = (ROOT / "tests/python/data/logs/capture.vcd").read_text()
    Path("capture.vcd").write_text(capture.replace(" probe ", " D0 ").replace(" latch ", " D1 "))
    Path("t.csv").write_text("Error,Remark\n0.002,a\n-0.001,\n0.001,\n")

    for words in commands:
        result = CliRunner().invoke(group, words, catch_exceptions=False)

        assert result.exit_code == 0, f"{' '.join(words)}\n{result.output}"


def test_commands_are_found() -> None:
    assert len(runnable()) >= FEWEST["run"]
    assert len(documented()) >= FEWEST["documents"]
    assert len(printed()) >= FEWEST["printed"]
    assert len(shown_by_help()) >= FEWEST["help"]


def test_every_command_shows_an_example() -> None:
    lacking = [
        name
        for name, command in leaves(group, "skiplatch")
        if not list(commands_in(f"{command.epilog or ''}\n{command.help or ''}"))
    ]

    assert lacking == []
