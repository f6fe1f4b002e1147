"""INI lines of the pages and of the rig: comments stand on lines of their own."""

import re
from pathlib import Path

import pytest

BLOCK = re.compile(r"^```ini\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SOURCES = [*sorted(Path("docs").glob("*.md")), *sorted(Path("tests/linuxcnc").glob("*.ini"))]


def ini_lines(path: Path) -> list[str]:
    text = path.read_text(encoding="utf-8")
    blocks = [text] if path.suffix == ".ini" else BLOCK.findall(text)
    return [line for block in blocks for line in block.splitlines()]


@pytest.mark.parametrize("path", [p for p in SOURCES if ini_lines(p)], ids=str)
def test_no_value_has_a_comment_behind_it(path: Path) -> None:
    """Neither LinuxCNC nor systemd reads one: it would be part of the value."""
    for line in ini_lines(path):
        if not line.startswith(("#", ";")):
            assert not re.search(r"\s[#;]", line), line
