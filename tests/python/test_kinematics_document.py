"""docs/KINEMATICS.md lists every parameter of 451 and 453 with its range and a test of it."""

import re
from pathlib import Path

from skiplatch.kinematics.cycle import KINEMATICS_GRID, setting

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| Q(\d+) \| (\S+) … (\S+) \| [^|]+ \| `(test_\w+)` \|$", re.MULTILINE)
SETTING = re.compile(r"\{(\d+)u, (?:ANY|WHOLE), \w+, \"[^\"]*\", \"[^\"]*\", (\S+), (\S+), \S+\}")
TURN = 359.9999


def number(text: str) -> float:
    return float(text.replace("TURN", str(TURN)))


def rows(heading: str = "") -> list[tuple[str, ...]]:
    """Read the rows below a heading, or all of them."""
    text = (ROOT / "docs" / "KINEMATICS.md").read_text(encoding="utf-8")
    if not heading:
        return ROW.findall(text)
    return ROW.findall(text.partition(f"## {heading}")[2].partition("\n## ")[0])


def test_every_parameter_stands_there_with_its_range() -> None:
    source = (ROOT / "firmware" / "cycle" / "kinematics_settings.c").read_text(encoding="utf-8")
    ranges = {q: (number(low), number(high)) for q, low, high in SETTING.findall(source)}

    assert len(ranges) == 21
    of_451 = rows("Every parameter of cycle 451")
    assert {q: (float(low), float(high)) for q, low, high, _ in of_451} == ranges


def test_every_parameter_of_the_grid_stands_there_with_its_range() -> None:
    described = {q: (float(low), float(high)) for q, low, high, _ in rows("Cycle 453")}

    all_of_451 = [int(q) for q, *_ in rows("Every parameter of cycle 451")]
    own = {str(q): row for q in all_of_451 if (row := setting(q, KINEMATICS_GRID)) is not None}
    assert len(own) == 8
    assert described == {q: (row.low, row.high) for q, row in own.items()}


def test_every_test_that_is_named_is_there() -> None:
    folder = ROOT / "tests"
    files = [*folder.glob("unit/*kinematics*.c"), *folder.glob("unit/*sphere*.c")]
    files += folder.glob("python/test_kinematics*.py")
    tests = {
        name
        for file in files
        for name in re.findall(r"(?:void|def) (test_\w+)\(", file.read_text(encoding="utf-8"))
    }

    assert {named for *_, named in rows()} <= tests
