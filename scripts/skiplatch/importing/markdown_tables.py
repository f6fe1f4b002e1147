"""A table of Markdown, ``| a | b |``, as reports and issues have it."""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError
from skiplatch.importing.named_lines import named

_RULE = re.compile(r"\s*\|?\s*:?-{3,}:?\s*\|(?:\s*:?-{3,}:?\s*\|)*(?:\s*:?-{3,}:?)?\s*")
_PARTED = re.compile(r"(?<!\\)\|")


def is_markdown(lines: Sequence[str]) -> bool:
    """Tell whether there is such a table: below its head stands ``|---|---|``."""
    return bool(_rules(lines))


def _rules(lines: Sequence[str]) -> list[int]:
    return [i for i, line in enumerate(lines) if i and _RULE.fullmatch(line)]


def markdown_rows(path: Path, lines: Sequence[str]) -> tuple[int, list[Row]]:
    """Give how many lines are before the table, and its rows, the head first.

    Raises:
        InputError: It has several.
    """
    rules = _rules(lines)
    if len(rules) > 1:
        message = (
            f"expected one table, got {len(rules)} of Markdown, {named(rules)}: copy the one that "
            "is meant into a file of its own, for import iso230 with all runs side by side"
        )
        raise InputError(path, None, None, message)
    (rule,) = rules
    end = rule + 1
    while end < len(lines) and "|" in lines[end]:
        end += 1
    numbers = [rule - 1, *range(rule + 1, end)]
    return rule - 1, [(i + 1, _cells(lines[i])) for i in numbers]


def _cells(line: str) -> list[str]:
    text = line.strip().removeprefix("|").removesuffix("|")
    return [cell.strip().replace("\\|", "|").strip("*`") for cell in _PARTED.split(text)]
