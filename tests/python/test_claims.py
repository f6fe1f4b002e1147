"""No file of any command is written for two outputs, and none over what the command reads."""

import os
import re
import shutil
from itertools import combinations
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from hostile import CAMPAIGN, KINEMATICS, LOGS, NOTHING_FOUND, commands
from skiplatch.cli import group
from skiplatch.commands.inputs import Source
from skiplatch.commands.outputs import OutputFile, OutputFolder
from skiplatch.probing_program import FILES

Words = tuple[str, ...]
LOG = LOGS / "klippy.log"
TOLD = r" is an input, and would be overwritten\n$| lies in .*, which is an input as a whole\n$"


def named(parameter: click.Parameter) -> str:
    return max(parameter.opts, key=len)


def is_output(parameter: click.Parameter) -> bool:
    return isinstance(parameter.type, OutputFile | OutputFolder)


PAIRS = [
    (words, named(one), named(two))
    for words, command in commands()
    for one, two in combinations(filter(is_output, command.params), 2)
]
OVER = [
    (words, named(output), named(source))
    for words, command in commands()
    for output in filter(is_output, command.params)
    for source in command.params
    if isinstance(source.type, Source)
]


def told(value: object) -> str | None:
    return " ".join(value) if isinstance(value, tuple) else None


def call(*words: object) -> Result:
    return CliRunner().invoke(group, [str(word) for word in words])


def test_every_path_of_a_command_is_read_or_written() -> None:
    paths = [p.type for _, command in commands() for p in command.params]

    kinds = {type(kind) for kind in paths if isinstance(kind, click.Path)}

    assert kinds == {Source, OutputFile, OutputFolder}
    assert len(PAIRS) > 20
    assert len(OVER) > 50


@pytest.mark.parametrize(("words", "one", "two"), PAIRS, ids=told)
def test_two_outputs_of_one_name_are_refused(
    words: Words, one: str, two: str, tmp_path: Path
) -> None:
    path = tmp_path / "x"

    result = call(*words, one, path, two, tmp_path / "." / "x")

    assert result.exit_code == 2
    assert f"Invalid value for '{two}': " in result.stderr.replace(f"'-o' / '{two}'", f"'{two}'")
    assert result.stderr.endswith("x is named for two outputs\n")
    assert not path.exists()


def leaf(words: Words) -> click.Command:
    return next(command for known, command in commands() if known == words)


def parameter(words: Words, name: str) -> click.Parameter:
    return next(one for one in leaf(words).params if named(one) == name)


def given(words: Words, source: str, path: Path) -> list[object]:
    """Give the path at its place; a place among arguments is reached by filling all."""
    if source.startswith("-"):
        return [source, path]
    return [path for one in leaf(words).params if isinstance(one, click.Argument)]


def overwritten(words: Words, source: str, folder: Path) -> list[tuple[Path, Path]]:
    """Give what can be read there, each with a file that must then not be written."""
    kind = parameter(words, source).type
    assert isinstance(kind, Source)
    campaign = Path(shutil.copytree(CAMPAIGN, folder / "k"))
    file = campaign / "touches.csv"
    found = [(campaign, file)] if kind.dir_okay else []
    found += [(file, file)] if kind.file_okay else []
    return [*found, *([(campaign, campaign / "new")] if kind.is_whole else [])]


@pytest.mark.parametrize(("words", "output", "source"), OVER, ids=told)
def test_no_output_goes_over_an_input(
    words: Words, output: str, source: str, tmp_path: Path
) -> None:
    is_told = isinstance(parameter(words, output).type, OutputFile)  # a folder is no file
    for read, file in overwritten(words, source, tmp_path):
        before = file.read_bytes() if file.exists() else None
        pair = ([output, file], given(words, source, read))
        for first, second in (pair, pair[::-1]):
            result = call(*words, *first, *second)

            assert result.exit_code == 2
            if is_told:
                assert re.search(TOLD, result.stderr)
            assert before == (file.read_bytes() if file.exists() else None)


@pytest.mark.parametrize("link", [os.symlink, os.link], ids=["symbolic", "hard"])
def test_links_are_looked_through(link: object, tmp_path: Path) -> None:
    assert callable(link)
    log = shutil.copy(LOG, tmp_path / "log")
    link(log, tmp_path / "other")

    result = call("repeat", log, "--json", tmp_path / "other")

    assert result.exit_code == 2
    assert result.stderr.endswith("other is an input, and would be overwritten\n")


def test_an_output_beside_the_campaign_that_is_read_is_fine(tmp_path: Path) -> None:
    campaign = shutil.copytree(CAMPAIGN, tmp_path / "k")

    assert call("check", campaign, "--json", campaign / "check.json").exit_code == 0
    assert call("check", campaign, "--json", campaign / "check.json").exit_code == 0
    assert call("repeat", LOG, "--json", "/dev/null", "--picture", "/dev/null").exit_code == 0


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, ending) for kind in FILES for ending in FILES[kind]]
)
def test_a_program_goes_over_no_conditions(kind: str, name: str, tmp_path: Path) -> None:
    out = tmp_path / f"n{name}"

    words = ["--diagnosis", NOTHING_FOUND, "--gcode", kind, "-o", tmp_path / "n.csv"]
    result = call("design", CAMPAIGN, *words, "--json", out)

    assert result.exit_code == 2
    assert result.stderr.endswith(f"n{name} is named for two outputs\n")


@pytest.mark.parametrize("name", ["TCHPRAUTO.html", "kinematics.bin"])
def test_what_lies_beside_a_program_is_no_output(name: str, tmp_path: Path) -> None:
    program = shutil.copy(KINEMATICS / "save_and_check.h", tmp_path)

    result = call("kinematics", "run", program, "--json", tmp_path / name)

    assert result.exit_code == 2
    assert f"{name} is " in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["save_and_check.h"]


def test_a_table_is_not_recorded_over(tmp_path: Path) -> None:
    table = tmp_path / "speeds.csv"
    table.write_text("alpha_deg,beta_deg,feed_mm_min\n")

    result = call("pretravel", "--rig", "haas", "--table", table, "--record", tmp_path)

    assert result.exit_code == 2
    assert result.stderr.endswith("speeds.csv is an input, and would be overwritten\n")
