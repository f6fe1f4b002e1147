"""docs/TUTORIAL.md: what its commands print is what stands there."""

import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from skiplatch.cli import group

ROOT = Path(__file__).parents[2]
TUTORIAL = ROOT / "docs" / "TUTORIAL.md"
EXAMPLE = re.compile(r"```sh\n(skiplatch [^\n]*)\n```\n\n```\n(.*?)\n```\n", re.DOTALL)
LEAST_EXAMPLES = 3


def test_examples_print_what_stands_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    (tmp_path / "build").mkdir()
    monkeypatch.chdir(tmp_path)
    examples = EXAMPLE.findall(TUTORIAL.read_text())
    assert len(examples) >= LEAST_EXAMPLES

    for command, expected in examples:
        result = CliRunner().invoke(group, shlex.split(command)[1:], catch_exceptions=False)

        assert result.exit_code == 0, result.output
        printed = "\n".join(line.rstrip() for line in result.output.rstrip().splitlines())
        assert printed == expected, command


def test_every_kind_of_import_is_named() -> None:
    group_of_kinds = group.get_command(group.make_context("skiplatch", ["x"]), "import")
    kinds = set(re.findall(r"`skiplatch import (\w+) ", TUTORIAL.read_text()))

    assert kinds == set(group_of_kinds.commands)  # type: ignore[union-attr]
