"""Where the keys of a TOML text stand; tomllib does not tell."""

import re
from collections import Counter
from dataclasses import dataclass

KeyPath = tuple[str, ...]

_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_PATH = rf"{_PART}(?:[ \t]*\.[ \t]*{_PART})*"
_HEADER = re.compile(rf"[ \t]*\[\[?[ \t]*(?P<path>{_PATH})[ \t]*\]")
_ENTRY = re.compile(rf"[ \t]*(?P<path>{_PATH})[ \t]*=[ \t]*")


@dataclass(frozen=True, slots=True)
class Position:
    """A place in a text: the line, the column of the key and that of its value, all from 1."""

    line: int
    key_column: int
    value_column: int | None = None


def key_positions(text: str) -> dict[KeyPath, Position]:
    """Find the first place of each section and of each key, down to a key of a subsection.

    The text has to be valid TOML. Of an array of tables each is found as `nth_table`, too.

    Keys inside of inline tables or written with escapes are not found, and a multi-line string
    may feign some.
    """
    positions: dict[KeyPath, Position] = {}
    section: KeyPath = ()
    tables: Counter[KeyPath] = Counter()
    nth: KeyPath = ()
    for number, line in enumerate(text.split("\n"), 1):
        if match := _HEADER.match(line):
            path = section = _parts(match["path"])
            position = Position(number, match.start("path") + 1)
            tables[section] += 1
            nth = (*section, nth_table(tables[section]))
            positions[nth] = position
        elif match := _ENTRY.match(line):
            position = Position(number, match.start("path") + 1, match.end() + 1)
            path = section + _parts(match["path"])
            positions.setdefault((*nth, *path[len(section) :]), position)
        else:
            continue
        for depth in range(1, min(len(path), 3) + 1):
            positions.setdefault(path[:depth], position)
    return positions


def nth_table(number: int) -> str:
    """Name a table of those with the same head, in a path behind that; the first is 1."""
    return f"[{number}]"


def is_nth_table(part: str) -> bool:
    """Tell whether a part of a path is such a name."""
    return part.startswith("[")


def _parts(path: str) -> KeyPath:
    return tuple(part.strip("\"'") for part in re.findall(_PART, path))
