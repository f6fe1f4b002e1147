"""docs/TUTORIAL.md: every kind of log is named; test_documents.py compares what it prints."""

import re
from pathlib import Path

from skiplatch.cli import group

ROOT = Path(__file__).parents[2]
TUTORIAL = ROOT / "docs" / "TUTORIAL.md"


def test_every_kind_of_import_is_named() -> None:
    group_of_kinds = group.get_command(group.make_context("skiplatch", ["x"]), "import")
    kinds = set(re.findall(r"`skiplatch import (\w+) ", TUTORIAL.read_text()))

    assert kinds == set(group_of_kinds.commands)  # type: ignore[union-attr]
