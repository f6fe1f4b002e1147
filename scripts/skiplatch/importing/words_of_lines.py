"""Tables without a head whose cells name themselves, ``X25.0064 F100.``, as DPRNT prints them."""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted

_WORD = re.compile(r"([A-Z]+)\s*=?\s*([-+]?\s*(?:[0-9]+\.?[0-9]*|\.[0-9]+))[\s,;]*", re.IGNORECASE)
_LINE = re.compile(rf"\s*(?:{_WORD.pattern})+", re.IGNORECASE)
_TAPE_END = "%"  # before and behind what goes out of a serial port


def is_of_words(lines: Sequence[str]) -> bool:
    """Tell a table all of whose lines are words of letters and numbers."""
    filled = _filled(lines)
    return bool(filled) and all(_LINE.fullmatch(line) for _, line in filled)


def word_rows(path: Path, lines: Sequence[str]) -> list[Row]:
    """Give the letters as a head, and below it the numbers of each line.

    Raises:
        InputError: A line has other letters than the first one.
    """
    filled = _filled(lines)
    heads = [head for head, _ in _WORD.findall(filled[0][1])]
    rows: list[Row] = [(filled[0][0], heads)]
    for number, line in filled:
        words = _WORD.findall(line)
        if not _LINE.fullmatch(line) or [head for head, _ in words] != heads:
            expected = f"expected {', '.join(heads)} as in line {filled[0][0]}"
            raise InputError(path, number, None, f"{expected}, got {quoted(line.strip())}")
        rows.append((number, [value.replace(" ", "") for _, value in words]))
    return rows


def _filled(lines: Sequence[str]) -> list[tuple[int, str]]:
    numbered = enumerate(lines, start=1)
    return [(number, line) for number, line in numbered if line.strip() not in ("", _TAPE_END)]
