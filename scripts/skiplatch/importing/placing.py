"""From where touches were latched to how far they are off: surfaces and their references.

Nobody knows where the surface is. Touches that belong to one surface are held against their own
middle, and the campaign says by `[datum]` that this middle is unknown.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, DatumFreedom, InputPath, Status, Touches
from skiplatch.campaign.columns import PLACE_DECIMALS
from skiplatch.campaign.session_names import surface_name
from skiplatch.importing.model import Touch
from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM

SAME_SURFACE_MM = 0.6
"""Touches of one place that are closer than this have touched one surface, where the log does not
say where the probe was sent."""
FEWEST_BY_CHANCE = 10
"""Surfaces, and touches that are near to another, from which on chance may have put them there."""
NEAR_BY_CHANCE = 0.2
"""Of `SAME_SURFACE_MM`, between neighbours in the middle; touches of one surface come nearer, and
where touches lie anywhere it is near to a half."""
STILL_K = 1.0
"""By which a temperature may vary and still be steady, as a heater keeps it."""
NEAREST_TO_FRAME = ("frame", "chamber", "machine", "bed")
Key = tuple[str, str, int, tuple[float, ...], int]


@np.errstate(invalid="ignore", over="ignore")  # what is infinite is refused when it is written
def as_touches(
    touches: Sequence[Touch], *, is_plc: bool, place_is_surface: bool = False
) -> tuple[Touches, DatumFreedom, dict[str, int]]:
    """Give columns, what the datum shares, and how often each surface was latched."""
    touches = [_with_sense(touch, touches) for touch in touches]
    surfaces = _surfaces(touches, place_is_surface=place_is_surface)
    names = {key: _name(key, surfaces) for key in surfaces}
    number_of = {id(touch): key for key, group in surfaces.items() for touch in group}
    keys = [number_of[id(touch)] for touch in touches]
    references = {key: _reference(group) for key, group in surfaces.items()}
    reference = np.array([references[key] for key in keys])
    coordinate = _column(touch.coordinate for touch in touches)
    sense = np.array([float(touch.sign or 1) for touch in touches])
    tells = np.array([_is_held(surfaces[key]) for key in keys])
    beyond = np.where(tells, sense * (coordinate - reference), np.nan)
    axes = np.array([Axis[touch.axis] for touch in touches])
    turns = axes >= Axis.A
    places = sorted({name for touch in touches for name in touch.temperatures})
    columns: dict[str, Any] = {
        "touch": np.arange(len(touches)),
        "path": np.full(len(touches), InputPath.PLC if is_plc else InputPath.SKIP),
        "status": _status(touches, coordinate),
        **_carried(touches),
    }
    made = Touches.from_columns(
        **columns,
        time_s=_from_zero(_column(touch.time_s for touch in touches)),
        axis=axes,
        sign=_column(touch.sign for touch in touches),
        feed_mm_min=_column(touch.feed for touch in touches),
        approach_mm=_column(
            _approach(touch, references[key]) for touch, key in zip(touches, keys, strict=True)
        ),
        position_mm=np.where(turns, np.nan, reference),
        deviation_um=np.where(turns, np.nan, beyond * UM_PER_MM),
        position_deg=np.where(turns, reference, np.nan),
        deviation_arcsec=np.where(turns, beyond * ARCSEC_PER_DEG, np.nan),
        session=[names[key] for key in keys] if any(names.values()) else [""] * len(touches),
        thermometers={
            place: _column(touch.temperatures.get(place) for touch in touches) for place in places
        },
    )
    latched = {_words(k): sum(t.coordinate is not None for t in v) for k, v in surfaces.items()}
    return made, _freedom(surfaces), {k: n for k, n in latched.items() if n}


def _status(touches: Sequence[Touch], coordinate: FloatArray) -> NDArray[np.int64]:
    is_false = np.array([touch.is_false for touch in touches])
    latched = np.where(np.isnan(coordinate), Status.MISSED, Status.OK)
    return np.where(is_false, Status.FALSE, latched).astype(np.int64)


def _carried(touches: Sequence[Touch]) -> dict[str, NDArray[Any]]:
    """Give the columns that a table has beside coordinates, and the machine's temperature."""
    names = sorted({name for touch in touches for name in touch.also})
    found: dict[str, NDArray[Any]] = {
        name: _column(touch.also.get(name) for touch in touches) for name in names
    }
    place = machine_thermometer(touches)
    if place and "temp_c" not in found:
        found["temp_c"] = _column(touch.temperatures.get(place) for touch in touches)
    for name in ("touch", "path", "status"):
        if name in found:
            found[name] = found[name].astype(np.int64)
    return found


@np.errstate(invalid="ignore")  # as above
def machine_thermometer(touches: Sequence[Touch]) -> str | None:
    """Give the thermometer that stands for the machine, as what grows with it does.

    It is one that moves; of several the one nearest to the frame.
    """
    moving = [
        place
        for place in sorted({name for touch in touches for name in touch.temperatures})
        if np.ptp([t.temperatures[place] for t in touches if place in t.temperatures]) > STILL_K
    ]
    words = (word for word in NEAREST_TO_FRAME if any(word in place for place in moving))
    nearest = next(words, "")
    return next((place for place in moving if nearest in place), None)


def _with_sense(touch: Touch, touches: Sequence[Touch]) -> Touch:
    """Give a touch of unknown sense that of the others of its surface, if theirs is one."""
    if touch.sign is not None or touch.coordinate is None:
        return touch
    senses = {
        other.sign
        for other in touches
        if (other.session, other.axis) == (touch.session, touch.axis)
        and other.coordinate is not None
        and abs(other.coordinate - touch.coordinate) < SAME_SURFACE_MM
        and _place(other) == _place(touch)
    }
    known = senses - {None}
    return replace(touch, sign=known.pop()) if len(known) == 1 else touch


def _place(touch: Touch) -> tuple[float, ...]:
    return tuple(round(value, 1) + 0.0 for value in touch.place)


def _approach(touch: Touch, reference: float) -> float | None:
    """Give the way to the reference; to where it was latched it would go with the deviation."""
    known = touch.start is not None and touch.coordinate is not None
    way = abs(reference - (touch.start or 0.0)) if known else touch.approach
    return way or None


def _surfaces(touches: Sequence[Touch], *, place_is_surface: bool) -> dict[Key, list[Touch]]:
    """Group touches: of one session, axis, sense and place, and else near to each other.

    Where the place is that to which the probe was sent, no reading makes another surface: a probe
    that is far off would else hide its fault.
    """
    grouped: dict[tuple[str, str, int, tuple[float, ...]], list[Touch]] = defaultdict(list)
    for touch in touches:
        grouped[touch.session, touch.axis, touch.sign or 0, _place(touch)].append(touch)
    surfaces: dict[Key, list[Touch]] = {}
    for key, group in grouped.items():
        for number, near in enumerate([group] if place_is_surface else _near(group)):
            surfaces[*key, number] = near
    return surfaces


def _near(group: Sequence[Touch]) -> list[list[Touch]]:
    """Part touches where their coordinates leave a gap; missed ones go with the first."""
    missed = [touch for touch in group if touch.coordinate is None]
    known = [touch for touch in group if touch.coordinate is not None]
    known.sort(key=lambda touch: touch.coordinate or 0.0)
    parts: list[list[Touch]] = [[]]
    for touch in known:
        last = parts[-1][-1].coordinate if parts[-1] else touch.coordinate
        if (touch.coordinate or 0.0) - (last or 0.0) > SAME_SURFACE_MM:
            parts.append([])
        parts[-1].append(touch)
    if _are_near_by_chance(known, len(parts)):
        parts = [[touch] for touch in known]
    parts[0] += missed
    return parts


def _are_near_by_chance(known: Sequence[Touch], surfaces: int) -> bool:
    """Tell whether touches lie anywhere, so that those near to each other share no surface."""
    ways_mm = np.diff([touch.coordinate or 0.0 for touch in known])
    near_mm = ways_mm[ways_mm <= SAME_SURFACE_MM]
    if min(surfaces, len(near_mm)) < FEWEST_BY_CHANCE:
        return False
    return bool(np.median(near_mm) > NEAR_BY_CHANCE * SAME_SURFACE_MM)


def _reference(group: Sequence[Touch]) -> float:
    known = [touch.coordinate for touch in group if touch.coordinate is not None]
    return round(median(known), PLACE_DECIMALS) if known else math.nan


def _is_held(surface: Sequence[Touch]) -> bool:
    """Tell whether touches hold each other: one alone is where its surface is, and no more."""
    return sum(touch.coordinate is not None for touch in surface) > 1


def _freedom(surfaces: dict[Key, list[Touch]]) -> DatumFreedom:
    """Give each surface a place of its own; one for an axis is what a machine has anyway."""
    axes = [key[1] for key in surfaces]
    return DatumFreedom.AXIS if len(set(axes)) == len(axes) else DatumFreedom.SESSION


def _name(key: Key, surfaces: dict[Key, list[Touch]]) -> str:
    """Name the session that makes a surface one of its own, where that is needed."""
    if _freedom(surfaces) is DatumFreedom.AXIS:
        return key[0]
    return _words(key)


def _words(key: Key) -> str:
    session, axis, sign, place, number = key
    sense = {1: "+", -1: "-", 0: ""}[sign]
    return surface_name(session, f"{axis}{sense}", place, number)


def _column(values: Iterable[float | None]) -> FloatArray:
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def _from_zero(time_s: FloatArray) -> FloatArray:
    return time_s if np.isnan(time_s).all() else time_s - np.nanmin(time_s)
