"""Issue forms: each is one that GitHub shows, and the commands that it asks for are commands."""

import re
from pathlib import Path
from typing import Any

import click
import pytest

from skiplatch.cli import group

yaml = pytest.importorskip("yaml", reason="no PyYAML here: it comes with the extra cluster")
FOLDER = Path(__file__).parents[2] / ".github" / "ISSUE_TEMPLATE"
FORMS = sorted(path for path in FOLDER.glob("*.yml") if path.name != "config.yml")
TYPES = {"markdown", "input", "textarea", "dropdown", "checkboxes"}


def read(path: Path) -> dict[str, Any]:
    form = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert isinstance(form, dict)
    return form


def test_there_are_forms() -> None:
    assert len(FORMS) >= 3


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.name)
def test_form_has_what_github_wants_of_it(path: Path) -> None:
    form = read(path)

    assert {"name", "description", "body"} <= form.keys()
    asked = [part for part in form["body"] if part["type"] != "markdown"]
    assert {part["type"] for part in form["body"]} <= TYPES
    assert all(part["attributes"]["label"] for part in asked)
    assert len({part["id"] for part in asked}) == len(asked)
    assert any(part.get("validations", {}).get("required") for part in asked)


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.name)
def test_commands_that_a_form_asks_for_are_there(path: Path) -> None:
    asked = re.findall(r"`skiplatch (\w+)", path.read_text(encoding="utf-8"))

    assert set(asked) <= set(group.list_commands(click.Context(group)))
