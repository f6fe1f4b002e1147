"""docs/STATUSES.md has every exit status and every format that the code has."""

import re
from pathlib import Path

from documents import ROOT
from skiplatch import cli, undo

PAGE = (ROOT / "docs" / "STATUSES.md").read_text()
PACKAGE = ROOT / "scripts" / "skiplatch"
FORMAT = re.compile(r"skiplatch-[a-z-]+/[0-9]+")
ONE = re.compile(r"^[A-Z_]+ = 1\b.*\n(?:\"\"\")?.*[Ee]xit status|^[A-Z_]+ = 1 +# exit status", re.M)


def command_of(path: Path) -> str:
    return path.stem.replace("_", " ")


def test_every_format_is_listed() -> None:
    texts = [path.read_text() for path in PACKAGE.rglob("*.py")]

    assert set(FORMAT.findall(PAGE)) == {one for text in texts for one in FORMAT.findall(text)}


def test_every_command_that_ends_with_1_is_listed() -> None:
    found = {
        command_of(path)
        for path in (PACKAGE / "commands").glob("*.py")
        if ONE.search(path.read_text())
    }
    listed = re.findall(r"^\| 1 \|.*\| `([a-z ]+)", PAGE, re.M)

    assert {name.strip() for name in listed} == found


def test_the_other_statuses_are_those_of_the_command_line() -> None:
    cells = re.findall(r"^\| ([\d, ]+) \|", PAGE, re.M)
    listed = set(map(int, re.findall(r"\d+", " ".join(cells))))

    assert listed == {0, 1, cli.BAD_INPUT, cli.NO_READER, undo.INTERRUPTED, undo.TERMINATED}
