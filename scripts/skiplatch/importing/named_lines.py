"""Which lines of a log are meant, in a few words."""

from collections.abc import Sequence

NAMED = 5
"""Lines that are named at most."""


def named(lines: Sequence[int]) -> str:
    """Give ``line 5, 7 and 9 more``: the first few, and how many there are besides."""
    first = ", ".join(map(str, lines[:NAMED]))
    more = len(lines) - NAMED
    return f"line {first} and {more} more" if more > 0 else f"line {first}"
