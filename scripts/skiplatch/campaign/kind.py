"""The two kinds of campaigns."""

from enum import StrEnum


class Kind(StrEnum):
    """How a campaign was recorded."""

    BENCH = "bench"
    """Edges injected at the connector at known times; no probe mechanics."""
    MACHINE = "machine"
    """A probe touches a surface; nobody knows the true edge time."""


NOT_ON_A_BENCH = ("probe", "link")
"""Stages of the chain that a bench has none of: effects in them do nothing there."""
