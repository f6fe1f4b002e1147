"""How importers name the sessions that they begin, ``after homing 2``, and how that is told again.

Touches are compared within a session only, so whoever has none to compare is told what began them.
"""

import re

HOMING = "homing"


def session_after(counts: dict[str, int]) -> str:
    """Name the session after so many of each; empty before any of them."""
    after = [f"{what} {count}" for what, count in counts.items() if count]
    return f"after {' and '.join(after)}" if after else ""


def begun_by(name: str, what: str) -> int | None:
    """Give how many of these came before a session; None where none of them began it."""
    match = re.match(rf"after (?:\D+ \d+ and )?{re.escape(what)} (\d+)", name)
    return int(match[1]) if match else None
