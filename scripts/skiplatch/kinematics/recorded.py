"""Recorded sphere centres as the stations of cycle 451: which of them measure which axis."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.cycle import MOST_STATIONS, setting
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.kinematics.points import Points
from skiplatch.kinematics.stations import Stations

PARAMETERS_OF_AXIS = {
    "A": (411, 412, 413, 414),
    "B": (415, 416, 417, 418),
    "C": (419, 420, 421, 422),
}
"""Start, end, incidence angle and number of points."""
SPHERE_RADIUS, BACKLASH = 407, 432
SAME_DEG = 0.01
TURN_DEG = 360.0


class RecordedError(Exception):
    """The recorded positions do not measure what the program asks for."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """Recorded positions, sorted as a cycle has them.

    Attributes:
        stations: Those that measure an axis: others at their incidence angles.
        points: All that count in the fit: every one but the second of two approaches.
        notes: What the operator should know, a sentence each.
    """

    stations: Stations
    points: Points
    notes: tuple[str, ...]


def sort_recorded(
    machine: Machine, points: Points, parameters: Mapping[int, float | str]
) -> Recorded:
    """Find the positions of each axis that the program measures.

    An axis is measured while the others stand at their incidence angles, from its position at 0°.
    With `approach` in the points, positions that were approached from the other side than most of
    an axis's, or than Q432 says, are second ones.

    Raises:
        RecordedError: An axis has no position at 0° or none beside it.
    """
    sorter = _Sorter(machine, points, parameters)
    rows = [row for letter in LETTERS for row in sorter.rows_of(letter)]
    if not rows:
        raise RecordedError("the program measures no axis of this machine")
    if len(rows) > MOST_STATIONS:
        raise RecordedError(f"{len(rows)} positions; a cycle has at most {MOST_STATIONS}")
    used = {row.place for row in rows} | set(np.flatnonzero(sorter.is_second))
    alone = len(points) - len(used)
    notes = list(sorter.notes)
    if alone:
        notes.append(
            f"{alone} of {len(points)} positions measure no axis, as another one is not at its "
            "incidence angle: they count in the fit alone."
        )
    return Recorded(sorter.stations(rows), sorter.first(), tuple(notes))


@dataclass(frozen=True, slots=True)
class _Row:
    place: int
    axis: int
    is_reference: bool
    is_second: bool


class _Sorter:
    def __init__(
        self, machine: Machine, points: Points, parameters: Mapping[int, float | str]
    ) -> None:
        self._machine = machine
        self._points = points
        self._parameters = parameters
        self._angles = np.zeros((len(points), len(LETTERS)))
        self._angles[:, [LETTERS.index(x) for x in machine.letters]] = points.angles_deg
        self._approach = np.zeros(len(points), dtype=np.int64)
        if points.approach is not None:
            self._approach = points.approach
        self.is_second = np.zeros(len(points), dtype=bool)
        self.notes: list[str] = []

    def _number(self, parameter: int) -> float:
        row = setting(parameter)
        given = self._parameters.get(parameter, row.initial if row else 0.0)
        return given if isinstance(given, float) else 0.0

    def _is_at(self, axis: int, angle_deg: float) -> NDArray[np.bool_]:
        off = np.abs(self._angles[:, axis] - angle_deg)
        return np.asarray(off < SAME_DEG)

    def rows_of(self, letter: str) -> list[_Row]:
        if letter not in self._machine.letters or self._number(PARAMETERS_OF_AXIS[letter][3]) < 1:
            return []
        axis = LETTERS.index(letter)
        own = np.ones(len(self._points), dtype=bool)
        for other in set(self._machine.letters) - {letter}:
            incidence_deg = self._number(PARAMETERS_OF_AXIS[other][2])
            own &= self._is_at(LETTERS.index(other), incidence_deg)
        at_zero = own & self._is_at(axis, 0.0)
        others = own & ~(at_zero | self._is_at(axis, TURN_DEG) | self._is_at(axis, -TURN_DEG))
        if not np.any(at_zero) or not np.any(others):
            wanted = "position at 0°, the reference," if np.any(others) else "position beside 0°"
            raise RecordedError(f"axis {letter}: no {wanted} with the others at their incidence")
        side = self._side(others)
        self.is_second |= own & (self._approach == -side) & (side != 0)
        return self._ordered(axis, at_zero, others)

    def _side(self, others: NDArray[np.bool_]) -> int:
        asked = np.sign(self._number(BACKLASH))
        most = asked or np.sign(np.sum(self._approach[others])) or self._approach[others][0]
        return int(most) if np.any(self._approach[others]) else 0

    def _ordered(
        self, axis: int, at_zero: NDArray[np.bool_], others: NDArray[np.bool_]
    ) -> list[_Row]:
        reference = np.flatnonzero(at_zero & ~self.is_second)
        start = reference[0] if len(reference) else np.flatnonzero(at_zero)[0]
        self.is_second[start] = False
        rows = [_Row(int(start), axis, is_reference=True, is_second=False)]
        seconds = list(np.flatnonzero(others & self.is_second))
        for place in np.flatnonzero(others & ~self.is_second):
            rows.append(_Row(int(place), axis, is_reference=False, is_second=False))
            same = [s for s in seconds if self._is_at(axis, self._angles[place, axis])[s]]
            if same:
                seconds.remove(same[0])
                rows.append(_Row(int(same[0]), axis, is_reference=False, is_second=True))
        firsts = sum(not row.is_reference and not row.is_second for row in rows)
        letter = LETTERS[axis]
        if firsts != (planned := self._planned(letter)):
            self.notes.append(f"{letter}: {firsts} positions beside 0°, the program has {planned}.")
        if seconds:
            self.notes.append(f"{letter}: {len(seconds)} approached from one side alone: left out.")
        return rows

    def _planned(self, letter: str) -> int:
        start, end, _, count = map(self._number, PARAMETERS_OF_AXIS[letter])
        angles = np.linspace(start, end, int(count))
        return int(np.sum(np.abs(angles - TURN_DEG * np.round(angles / TURN_DEG)) >= SAME_DEG))

    def stations(self, rows: list[_Row]) -> Stations:
        places = [row.place for row in rows]
        axis = np.array([row.axis for row in rows], dtype=np.int64)
        return Stations(
            self._angles[places],
            self._points.positions_mm[places],
            self._radius_mm()[places],
            axis,
            1 << axis,
            self._approach[places],
            np.array([row.is_reference for row in rows]),
            np.array([row.is_second for row in rows]),
        )

    def _radius_mm(self) -> FloatArray:
        if self._points.radius_mm is not None:
            return self._points.radius_mm
        return np.full(len(self._points), self._number(SPHERE_RADIUS))

    def first(self) -> Points:
        first = ~self.is_second
        return Points(self._points.angles_deg[first], self._points.positions_mm[first])
