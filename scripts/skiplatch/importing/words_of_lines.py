"""Tables without a head whose cells name themselves, ``X25.0064 F100.``, as DPRNT prints them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted

_NUMBER = r"(?:[-+]\s*)?(?:[0-9]+(?:\.[0-9]*|,[0-9]+)?|\.[0-9]+)"
_MOMENT = r"[0-9]{1,2}:[0-9]{2}(?::[0-9]{2}(?:[.,][0-9]+)?)?|[0-9]{1,2}\.[0-9]{1,2}\.[0-9]{4}"
"""A time of day, or a date with points."""
_WORD = re.compile(rf"([A-Z]+)\s*(?:=\s*)?({_MOMENT}|{_NUMBER})[\s,;]*", re.IGNORECASE)
_LINE = re.compile(rf"\s*(?:{_WORD.pattern})+", re.IGNORECASE)
_ASIDE = re.compile(r"[%\0-\x1f\x7f]*|\(.*\)|[;#].*|[-=_*]{3,}")
"""What tells nothing: the ends of a tape with the codes of its punch, comments, rules, empty lines.
"""
FEWEST = 2  # lines alike that make a table of what else is in a file


@dataclass(frozen=True, slots=True)
class WordTable:
    """A table of words.

    Attributes:
        before: Lines before it that are no asides.
        rows: Letters as a head, and below it the numbers of each line.
        below: Lines below it that are no asides.
    """

    before: list[str]
    rows: list[Row]
    below: list[str]


@dataclass(frozen=True, slots=True)
class _Line:
    """A line that is no aside; without letters where it is not all of words."""

    number: int
    text: str
    heads: tuple[str, ...]
    values: list[str]


def is_of_words(lines: Sequence[str]) -> bool:
    """Tell whether lines in a row have the same letters, or all of them are words."""
    filled = _filled(lines)
    return len(_longest_run(filled)) >= FEWEST or bool(
        filled and all(line.heads for line in filled)
    )


def word_table(path: Path, lines: Sequence[str]) -> WordTable:
    """Give the lines with the letters of the longest run, from the first to the last of them.

    Raises:
        InputError: A line between these is another one.
    """
    filled = _filled(lines)
    first = _longest_run(filled)[0]
    alike = [i for i, line in enumerate(filled) if line.heads == first.heads]
    begin, end = alike[0], alike[-1] + 1
    rows: list[Row] = [(filled[begin].number, list(first.heads))]
    for line in filled[begin:end]:
        if line.heads != first.heads:
            expected = f"expected {', '.join(first.heads)} as in line {filled[begin].number}"
            raise InputError(path, line.number, None, f"{expected}, got {quoted(line.text)}")
        rows.append((line.number, line.values))
    before, below = ([line.text for line in part] for part in (filled[:begin], filled[end:]))
    return WordTable(before, rows, below)


def _longest_run(filled: Sequence[_Line]) -> list[_Line]:
    runs = [list(run) for heads, run in groupby(filled, lambda line: line.heads) if heads]
    return max(runs, key=len, default=[])


def _filled(lines: Sequence[str]) -> list[_Line]:
    stripped = ((number, line.strip()) for number, line in enumerate(lines, start=1))
    return [_line(number, text) for number, text in stripped if not _ASIDE.fullmatch(text)]


def _line(number: int, text: str) -> _Line:
    words = _WORD.findall(text) if _LINE.fullmatch(text) else []
    values = ["".join(value.split()) for _, value in words]
    return _Line(number, text, tuple(head for head, _ in words), values)
