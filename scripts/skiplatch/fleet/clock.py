"""The clock of this machine: what was recorded is never later."""

from datetime import UTC, datetime, timedelta

EASTERNMOST = timedelta(hours=14)
"""How far ahead of UTC a time may be that has no zone: as on the Line Islands."""


def now() -> datetime:
    """Give the time in UTC, without a zone as a store has it."""
    return datetime.now(UTC).replace(tzinfo=None)
