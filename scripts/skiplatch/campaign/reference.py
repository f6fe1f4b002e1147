"""The tables of columns and keys as Markdown, for the documents."""

from collections.abc import Iterable

from skiplatch.campaign.columns import COLUMNS, REQUIRED_IN_VERSION_1
from skiplatch.campaign.nominal import KEYS


def columns_table() -> str:
    """Describe every column of touches.csv."""
    return _table(
        ("column", "unit", "expected", "required", "meaning"),
        (
            (f"`{name}`", c.unit, c.expected, _required(name), c.meaning)
            for name, c in COLUMNS.items()
        ),
    )


def keys_table() -> str:
    """Describe every number of nominal.toml."""
    return _table(
        ("key", "unit", "expected", "meaning"),
        (
            (f"`{section}.{name}`", key.unit, key.constraint.words, key.meaning)
            for (section, name), key in KEYS.items()
        ),
    )


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


def _required(name: str) -> str:
    return "yes" if name in REQUIRED_IN_VERSION_1 else ""
