"""Runs of a table of ISO 230-2 that stand in pairs: 1F and 1R, P1 and N1."""

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.importing.iso230_heads import is_negative
from skiplatch.importing.iso230_run_table import RunTable
from skiplatch.importing.spreadsheets import WORKED_OUT
from skiplatch.importing.units_in_heads import bracketed, split_unit

_LETTERS = {"fr", "fb", "pn", "pm", "ud", "vr", "vz", "hr", "hz"}
"""Of the positive and of the negative sense: forward, plus, up, vor, hin."""
_NUMBER = re.compile(r"\d+", re.ASCII)


def with_senses(path: Path, line: int, table: RunTable) -> RunTable:
    """Say the sense of runs in pairs that letters tell, in their heads.

    Raises:
        InputError: Runs stand in pairs, and nothing tells which of them are in which sense.
    """
    numbers: dict[str, list[str]] = defaultdict(list)
    stems = [_stem(head) for head in table.heads]
    for stem, number in stems[1:]:
        if number:
            numbers[stem].append(number)
    if len(numbers) != 2 or len({tuple(sorted(own)) for own in numbers.values()}) != 1:
        return table
    if len({is_negative(stem) for stem in numbers}) == 2:
        return table
    words = _words(list(numbers))
    if not words:
        one, other = (quoted(next(h for h, s in _with(table, stems) if s == k)) for k in numbers)
        message = f"expected senses such as + and - or fwd and rev, got pairs as {one} and {other}"
        raise InputError(path, line, None, message)
    heads = [f"{words[s]} {h}" if s in words and h else h for h, s in _with(table, stems)]
    return replace(table, heads=[table.heads[0], *heads])


def _with(table: RunTable, stems: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Give the head of each run with its stem; no stem where it has no number."""
    pairs = zip(table.heads[1:], stems[1:], strict=True)
    return [(head, stem if number else "-") for head, (stem, number) in pairs]


def _stem(head: str) -> tuple[str, str]:
    """Part a head from the one number in it; nothing of a result, or where there are more."""
    name = split_unit(bracketed(head.strip())[0], "µm")[0].lower()
    found = _NUMBER.findall(name)
    if len(found) != 1 or WORKED_OUT.search(name):
        return "", ""
    return _NUMBER.sub("", name).strip(" _."), found[0]


def _words(stems: Sequence[str]) -> dict[str, str]:
    """Give the word for the sense that each of two letters stands for; none where they do not."""
    for one, other in (stems, stems[::-1]):
        if len(one) == len(other) == 1 and one + other in _LETTERS:
            return {one: "fwd", other: "rev"}
    return {}
