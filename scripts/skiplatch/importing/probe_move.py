"""Moves by G38.2 to G38.5: along which axis, in which sense, from where."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

AXES = "XYZABC"
LINEAR = "XYZ"
SHARE_DIGITS = 3  # no feed is truer than 0.1 %
SHORTEST_REST = 0.01  # of a move, in mm or degrees, that tells its direction
BESIDE_MM = 0.1
"""From a move, within which it may end still: places are rounded, and an axis comes to rest."""

AT_TARGET_MM = 2e-3
"""From the target of a move, within which nothing was met: it ended there to the last count."""


@dataclass(frozen=True, slots=True)
class ProbeMove:
    """A move by G38.2 to G38.5, in mm, degrees and mm/min.

    Attributes:
        line: Number of the line, from 1.
        axis: That mostly moves; None where that is not known.
        sign: Its sense; None where it is not known.
        share: Of the way, and so of the feed, that the axis has: 1 where it moves alone; None
            where it is not known.
        start: Where the move begins, as far as known, by axis.
        feed: Along the way; None where it is not known.
        targets: Where the move would end, by axis; None where it is not known.
        is_release: Whether it ends where the probe lets go, by G38.4 or G38.5.
        is_inch: Whether the program counts in inches there.
    """

    line: int
    axis: str | None
    sign: int | None
    share: float | None
    start: Mapping[str, float]
    feed: float | None
    targets: Mapping[str, float | None] = field(default_factory=dict)
    is_release: bool = False
    is_inch: bool = False

    def along(self, ways: Mapping[str, float | None]) -> "ProbeMove":
        """Give the move with the direction of these ways."""
        axis, sign, share = direction_of(ways)
        return replace(self, axis=axis, sign=sign, share=share)

    def latched_at(self, position: Mapping[str, float]) -> "ProbeMove":
        """Give the move with the direction of what was left of it where it was latched.

        That is the direction of all of it, which is needed where the start is not known.
        """
        if self.sign is not None:
            return self
        rest = {
            axis: None if target is None or axis not in position else target - position[axis]
            for axis, target in self.targets.items()
        }
        tells = any(abs(way or 0.0) > SHORTEST_REST for way in rest.values())
        return self.along(rest) if tells else self

    def start_to(self, axis: str, latched: float) -> float | None:
        """Give where an axis began, as far as that goes with where it was latched.

        It does not where the axis was moved without a word in the log, as by a jog: the way is
        longer than the move, or goes against it.
        """
        start, target = self.start.get(axis), self.targets.get(axis)
        if start is None or target is None:
            return start
        low, high = sorted((start, target))
        return start if low - BESIDE_MM <= latched <= high + BESIDE_MM else None

    def met_nothing(self, axis: str, ended: float) -> bool:
        """Tell whether a move towards a surface went on to its target, by where an axis ended."""
        target = self.targets.get(axis)
        return not self.is_release and target is not None and abs(ended - target) < AT_TARGET_MM

    def ended_at(self, position: Sequence[float]) -> bool:
        """Tell whether a place, by axes in their order, is known to be where the move would end."""
        ends = {**self.start, **self.targets}
        if not self.targets or not self.targets.keys() <= self.start.keys():
            return False
        ways = [(ends[axis], at) for axis, at in zip(AXES, position, strict=False) if axis in ends]
        return all(end is not None and abs(end - at) <= BESIDE_MM for end, at in ways)


def direction_of(ways: Mapping[str, float | None]) -> tuple[str | None, int | None, float | None]:
    """Give the axis that goes the longest way, its sense, and its share of the way of all."""
    if len(ways) == 1:
        ((only, way),) = ways.items()
        return only, None if not way else int(math.copysign(1, way)), 1.0
    known = {axis: way for axis, way in ways.items() if way}
    if not known or None in ways.values():
        return None, None, None
    longest = max(known, key=lambda name: abs(known[name]))
    way = known[longest]
    alike = (w for axis, w in known.items() if (axis in LINEAR) == (longest in LINEAR))
    return longest, int(math.copysign(1, way)), round(abs(way) / math.hypot(*alike), SHARE_DIGITS)
