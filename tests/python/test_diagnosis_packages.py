"""The packages of the diagnosis build on one another in the order of docs/ARCHITECTURE.md alone."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from skiplatch.places import ROOT

DIAGNOSIS = ROOT / "scripts" / "skiplatch" / "diagnosis"
NAME = "skiplatch.diagnosis"
TABLE = (
    (ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8").partition("## The diagnosis")
)
ORDER = re.findall(r"^\| `(\w+)` \|", TABLE[2].partition("\n## ")[0], re.MULTILINE)


def imported(source: Path) -> Iterator[str]:
    """Name what a file imports: modules, and what it takes from each."""
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{source}: a relative import"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def parts_used(package: str) -> set[str]:
    """Name what a package takes from the diagnosis, but for itself: packages, or what is on top."""
    names = [name for path in (DIAGNOSIS / package).rglob("*.py") for name in imported(path)]
    inside = [name for name in names if name == NAME or name.startswith(f"{NAME}.")]
    return {name.removeprefix(NAME).strip(".").partition(".")[0] for name in inside} - {package}


def test_each_package_is_in_the_table() -> None:
    packages = {path.parent.name for path in DIAGNOSIS.glob("*/__init__.py")}

    assert len(ORDER) == len(set(ORDER))
    assert set(ORDER) == packages


def test_only_the_entry_stands_beside_the_packages() -> None:
    assert {path.name for path in DIAGNOSIS.glob("*.*")} == {"__init__.py", "diagnose.py"}


@pytest.mark.parametrize("package", ORDER)
def test_a_package_builds_on_those_above_it_alone(package: str) -> None:
    above = ORDER[: ORDER.index(package)]

    assert parts_used(package) <= set(above)
