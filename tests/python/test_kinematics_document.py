"""docs/KINEMATICS.md lists every parameter of cycle 451 with its range and a test that shows it."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| Q(\d+) \| (\S+) … (\S+) \| [^|]+ \| `(test_\w+)` \|$", re.MULTILINE)
SETTING = re.compile(r"\{(\d+)u, (?:ANY|WHOLE), \w+, \"[^\"]*\", \"[^\"]*\", (\S+), (\S+), \S+\}")
TURN = 359.9999


def number(text: str) -> float:
    return float(text.replace("TURN", str(TURN)))


def rows() -> list[tuple[str, ...]]:
    return ROW.findall((ROOT / "docs" / "KINEMATICS.md").read_text(encoding="utf-8"))


def test_every_parameter_stands_there_with_its_range() -> None:
    source = (ROOT / "firmware" / "cycle" / "kinematics_settings.c").read_text(encoding="utf-8")
    ranges = {q: (number(low), number(high)) for q, low, high in SETTING.findall(source)}

    assert len(ranges) == 21
    assert {q: (float(low), float(high)) for q, low, high, _ in rows()} == ranges


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
