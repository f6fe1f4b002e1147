"""How importers name the sessions that they begin, ``after homing 2``, and how that is told again.

Touches are compared within a session only, so whoever has none to compare is told what began them.
Where surfaces have sessions of their own, the name says which: ``after homing 2 Z- at 50 40 #1``.
"""

import re
from collections.abc import Sequence

HOMING = "homing"
_SURFACE = re.compile(
    r"(?:^| )(?P<surface>[XYZABC][+-]? at (?P<place>-?\d\S*(?: -?\d\S*)*)(?: #\d+)?)$"
)


def session_after(counts: dict[str, int]) -> str:
    """Name the session after so many of each; empty before any of them."""
    after = [f"{what} {count}" for what, count in counts.items() if count]
    return f"after {' and '.join(after)}" if after else ""


def begun_by(name: str, what: str) -> int | None:
    """Give how many of these came before a session; None where none of them began it."""
    match = re.match(rf"after (?:\D+ \d+ and )?{re.escape(what)} (\d+)", name)
    return int(match[1]) if match else None


def surface_name(session: str, title: str, place: Sequence[float], number: int) -> str:
    """Name a surface of a session, and so the session that it has for itself.

    Args:
        session: What was begun before; empty where nothing was.
        title: Axis and sense, ``Z-``.
        place: What else tells it from others: the coordinates of the other axes.
        number: Of this one at the place, from 0.
    """
    where = " ".join(f"{value:g}" for value in place)
    parts = (session, title, f"at {where}" if place else "", f"#{number}" * (number > 0))
    return " ".join(part for part in parts if part)


def surface_in(name: str) -> str:
    """Give the part of a name that says at which place a surface is; empty where none does."""
    match = _SURFACE.search(name)
    return match["surface"] if match else ""


def place_in(name: str) -> tuple[float, ...]:
    """Give the place of the surface that a name says; empty where it says none."""
    match = _SURFACE.search(name)
    try:
        return tuple(map(float, match["place"].split())) if match else ()
    except ValueError:  # somebody else named it
        return ()
