"""The tables of columns and keys as Markdown, for the documents."""

from collections.abc import Iterable, Mapping
from math import isinf
from typing import Any

from skiplatch.campaign.column_kinds import Column
from skiplatch.campaign.columns import COLUMNS, REQUIRED, THERMOMETER, TIME
from skiplatch.campaign.nominal import KEYS, Key

ALL_COLUMNS: Mapping[str, Column] = {**COLUMNS, "time": TIME, "temp_NAME_c": THERMOMETER}


def columns_table() -> str:
    """Describe every column of touches.csv."""
    return _table(
        ("column", "unit", "expected", "meaning", "example", "without it cannot be told"),
        (
            (f"`{name}`", c.unit, c.expected, c.meaning, f"`{c.example}`", c.lost)
            for name, c in ALL_COLUMNS.items()
        ),
    )


def keys_table() -> str:
    """Describe every number of nominal.toml."""
    return _table(
        ("key", "unit", "expected", "default", "meaning", "without it cannot be told"),
        (
            (
                f"`{section}.{name}`",
                key.unit,
                key.constraint.words,
                _default(key),
                key.meaning,
                key.lost,
            )
            for (section, name), key in KEYS.items()
        ),
    )


def as_json() -> dict[str, Any]:
    """Give both tables for programs; a default is None where there is no limit."""
    columns = {
        name: {
            "unit": c.unit,
            "expected": c.expected,
            "required": name in REQUIRED,
            "since": c.since,
            "meaning": c.meaning,
            "example": c.example,
            "lost": c.lost,
        }
        for name, c in ALL_COLUMNS.items()
    }
    keys = {
        f"{section}.{name}": {
            "unit": key.unit,
            "expected": key.constraint.words,
            "default": None if isinf(key.default) else key.default,
            "since": key.since,
            "meaning": key.meaning,
            "lost": key.lost,
        }
        for (section, name), key in KEYS.items()
    }
    return {"columns": columns, "keys": keys}


def _default(key: Key) -> str:
    return "no limit" if isinf(key.default) else f"{key.default:g}"


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)
