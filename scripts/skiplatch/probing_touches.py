"""Touches that a controller is to make, by the surface that they touch."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from skiplatch.campaign import Axis, InputPath, Touches
from skiplatch.campaign.session_names import place_in
from skiplatch.units import UM_PER_MM

SAME_SURFACE_MM = 0.5
BEYOND_MM = 2.0
"""How far behind the surface a probing move would end, and how far off the surface may be."""
LOCATING_MM = 10.0
"""How far in front of its surface the probe may stand before a program begins, at most."""
LEAST_LOCATING_MM = 0.1
"""The same, at least: nearer, nobody can set a probe by hand."""
NEGLIGIBLE_MM = 1e-6
BESIDE_MM = 0.5
"""How far beside its place a surface may be touched."""
LOCATING_MM_MIN = 100.0
"""The feed of the touch that finds the surface, where no touch asked for is slower."""

LINEAR = "XYZ"
FEED_STEPS_MM_MIN: Mapping[str, float] = {"klipper": 6.0}
"""By controller: PROBE_ACCURACY prints its speed with one decimal of mm/s."""


@dataclass(frozen=True, slots=True)
class Touch:
    """One touch: places in mm along its axis, feed in mm/min, rest before it in s.

    `room` is the way from the surface to the limit of the axis behind it. `place` is what tells
    the surface from others beside it; empty where the campaign does not say it. `beside` has the
    coordinates of the other axes, where that is what it is: of rotary ones those that are not 0.
    """

    axis: str
    sign: int
    start: float
    surface: float
    end: float
    room: float
    feed: float
    rest_s: float
    place: tuple[float, ...] = ()
    beside: Mapping[str, float] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """Say which surface it is."""
        side = f"{self.axis}{'+' if self.sign > 0 else '-'}"
        return f"surface {side} at {self.surface:g} mm{self._there}"

    @property
    def _there(self) -> str:
        if self.beside:
            return f", {' '.join(f'{axis}{value:g}' for axis, value in self.beside.items())}"
        return f", place {' '.join(f'{value:g}' for value in self.place)}" if self.place else ""

    @property
    def approach(self) -> float:
        """Give the way from the start to the surface."""
        return abs(self.surface - self.start)

    def is_of(self, other: "Touch") -> bool:
        """Tell whether it touches the same surface.

        At one height there may be many, so places tell them apart where they are known.
        """
        near = abs(self.surface - other.surface) <= SAME_SURFACE_MM
        return near and (self.axis, self.sign, self.place) == (other.axis, other.sign, other.place)


def as_logged(kind: str, touches: Touches) -> Touches:
    """Give touches at feeds that the log of a kind of controller prints in full."""
    step = FEED_STEPS_MM_MIN.get(kind)
    if step is None:
        return touches
    return replace(touches, feed_mm_min=np.maximum(np.round(touches.feed_mm_min / step), 1) * step)


def as_made(
    touches: Touches, rest_s: Sequence[float], reach_mm: tuple[float, float]
) -> list[Touch]:
    """Give touches as a controller makes them.

    Raises:
        ValueError: Too little is known of one.
    """
    return [_touch(touches, i, float(rest_s[i]), reach_mm) for i in range(len(touches))]


def path_of(touches: Touches) -> str:
    """Give the path that latches all touches, skip or plc.

    Raises:
        ValueError: Both do: no log of a controller tells them apart.
    """
    if len(set(touches.path.tolist())) > 1:
        raise ValueError("expected touches of one path, as a log names none, got skip and plc")
    return InputPath(int(touches.path[0])).name.lower()


def by_surface(touches: Sequence[Touch]) -> list[list[Touch]]:
    """Put touches of one surface together, the surfaces in the order of their first touch."""
    groups: list[list[Touch]] = []
    for touch in touches:
        for group in groups:
            if touch.is_of(group[0]):
                group.append(touch)
                break
        else:
            groups.append([touch])
    return groups


def taken_for_one(touches: Sequence[Touch]) -> list[Touch]:
    """Give a touch of each surface that may be several, as the campaign says no places of them."""
    return [
        group[0]
        for group in by_surface(touches)
        if not group[0].place and len({touch.surface for touch in group}) > 1
    ]


def locating_mm_min(touches: Sequence[Touch]) -> float:
    """Give the feed of the touch that finds a surface."""
    return min(LOCATING_MM_MIN, *(touch.feed for touch in touches))


def locating_mm(touches: Sequence[Touch]) -> float:
    """Give the way of the touch that finds a surface, and how near the probe has to be set.

    No controller says where that was, so from right in front of the surface it stays within reach.

    Raises:
        ValueError: The axis ends right behind the surface.
    """
    tightest = min(touches, key=lambda touch: touch.room)
    way_mm = min(LOCATING_MM, tightest.room)
    if way_mm < LEAST_LOCATING_MM - NEGLIGIBLE_MM:
        end = "max_mm" if tightest.sign > 0 else "min_mm"
        raise ValueError(
            f"{tightest.title}: {end} of [axis] is {tightest.room:.3g} mm behind it, expected "
            f"{LEAST_LOCATING_MM:g} mm or more, in which a touch finds it"
        )
    return math.floor((way_mm + NEGLIGIBLE_MM) * UM_PER_MM) / UM_PER_MM


def farthest(touches: Sequence[Touch]) -> Touch:
    """Give the touch of a surface that starts the farthest from it."""
    return max(touches, key=lambda touch: touch.approach)


def _touch(touches: Touches, i: int, rest_s: float, reach_mm: tuple[float, float]) -> Touch:
    known = (
        touches.sign[i],
        touches.position_mm[i],
        touches.approach_mm[i],
        touches.feed_mm_min[i],
    )
    if touches.axis[i] not in (Axis.X, Axis.Y, Axis.Z) or np.isnan(known).any():
        raise ValueError(f"touch {i}: a program needs linear axis, sense, place, approach and feed")
    sign, surface, approach, feed = (float(value) for value in known)
    room = sign * (reach_mm[1 if sign > 0 else 0] - surface)
    start, end = np.clip([surface - sign * approach, surface + sign * BEYOND_MM], *reach_mm)
    axis = Axis(int(touches.axis[i])).name
    place = place_in(touches.session_names[touches.session[i]])
    # A table may tell surfaces apart by the azimuth in place of coordinates.
    is_coordinates = len(place) >= len(LINEAR) - 1 and np.isnan(touches.alpha_deg[i])
    others = zip((other.name for other in Axis if other.name != axis), place, strict=False)
    beside = {other: value for other, value in others if other in LINEAR or value}
    return Touch(
        axis,
        int(sign),
        float(start),
        surface,
        float(end),
        room,
        feed,
        rest_s,
        place,
        beside if is_coordinates else {},
    )
