"""What cycle 451's measurements say of each axis, before and after a correction.

An error is measured minus expected, both relative to the measurement at 0°, the reference.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from skiplatch.kinematics.cycle import Stations, expected_mm
from skiplatch.kinematics.firmware import Fit, fit
from skiplatch.kinematics.five_axis import ARCSEC_PER_DEG, UM_PER_MM, Truth
from skiplatch.kinematics.machine import LETTERS, Machine, RotaryAxis, Vector
from skiplatch.kinematics.points import Points

FloatArray = NDArray[np.float64]
CHECK, POSITIONS, ANGLES, ORIGIN = range(4)
"""The modes of Q406."""
LEAST_CIRCLE_MM = 1.0
"""Radius below which no backlash is computed."""
SLOPE_STEP_DEG = 1e-3
NOT_MEASURED = -1.0


@dataclass(frozen=True, slots=True, eq=False)
class AxisResult:
    """One measured axis; n is the number of positions besides the reference.

    Attributes:
        letter: The axis.
        angle_deg: Its positions, shape (n,).
        radius_mm: Radius of the circle on which the sphere or the tip went.
        backlash_arcsec: Mean over the positions; None when not measured or not computed.
        before_mm: Errors with the kinematics as they were, shape (n, 3).
        after_mm: Errors with the corrected kinematics, shape (n, 3).
        positioning_arcsec: Mean positioning error relative to 0°, corrected kinematics.
        positioning_scatter_arcsec: Its standard deviation; 0 with a single position.
    """

    letter: str
    angle_deg: FloatArray
    radius_mm: float
    backlash_arcsec: float | None
    before_mm: FloatArray
    after_mm: FloatArray
    positioning_arcsec: float
    positioning_scatter_arcsec: float

    @property
    def scatter_before_mm(self) -> float:
        """Root mean square of the errors in space; with one position its error."""
        return _scatter(self.before_mm)

    @property
    def scatter_after_mm(self) -> float:
        """The same with the corrected kinematics."""
        return _scatter(self.after_mm)

    @property
    def greatest_before_mm(self) -> float:
        """Greatest error in space."""
        return float(np.max(np.linalg.norm(self.before_mm, axis=1)))

    @property
    def greatest_after_mm(self) -> float:
        """The same with the corrected kinematics."""
        return float(np.max(np.linalg.norm(self.after_mm, axis=1)))


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """What a cycle found.

    Attributes:
        mode: Q406.
        believed: The kinematics as they were.
        corrected: As they are, or in mode 0 would be, corrected.
        fit: The firmware's fit of the location errors.
        axes: Each measured axis.
    """

    mode: int
    believed: Machine
    corrected: Machine
    fit: Fit
    axes: tuple[AxisResult, ...]

    @property
    def shift_mm(self) -> Vector:
        """Q147 to Q149: shift of the line of the last axis that has that coordinate."""
        found = [0.0, 0.0, 0.0]
        for before, after in zip(self.believed.axes, self.corrected.axes, strict=True):
            for i in range(3):
                if abs(before.direction[i]) < 0.5:
                    found[i] = after.point_mm[i] - before.point_mm[i]
        return found[0], found[1], found[2]

    @property
    def change_mm(self) -> float:
        """The largest change of the location of an axis."""
        return max(
            float(np.linalg.norm(np.subtract(after.point_mm, before.point_mm)))
            for before, after in zip(self.believed.axes, self.corrected.axes, strict=True)
        )

    def q_parameters(self) -> dict[int, float]:
        """Give Q141 to Q149 in mm."""
        found = dict.fromkeys(range(141, 147), NOT_MEASURED)
        for axis in self.axes:
            place = LETTERS.index(axis.letter)
            found[141 + place] = axis.scatter_before_mm
            if self.mode != CHECK:
                found[144 + place] = axis.scatter_after_mm
        return found | dict(zip(range(147, 150), self.shift_mm, strict=True))


def _scatter(errors_mm: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.sum(errors_mm**2, axis=1))))


def evaluate(machine: Machine, truth: Truth, stations: Stations, mode: int) -> Evaluation:
    """Fit the location errors and tell what each axis shows before and after the correction.

    Of a position approached from both sides the side of the reference counts; the other is for the
    backlash.

    Raises:
        NoFitError: The positions are too few.
    """
    known = replace(machine, tool_mm=machine.tool_mm or (0.0, 0.0, 0.0))
    forward = _forward(stations)
    order = [LETTERS.index(letter) for letter in machine.letters]
    points = Points(stations.angle_deg[forward][:, order], stations.centre_mm[forward])
    found = fit(known, points)
    corrected = correct(machine, found, angles=mode != POSITIONS)
    axes = tuple(
        _axis(letter, machine, corrected, truth, stations)
        for letter in LETTERS
        if letter in machine.letters and np.any(stations.of(letter) & ~stations.is_reference)
    )
    return Evaluation(mode, machine, corrected, found, axes)


def correct(machine: Machine, found: Fit, *, angles: bool) -> Machine:
    """Put the determined location errors into the description; the others are left alone.

    Args:
        machine: As believed.
        found: The location errors.
        angles: Correct the directions too, not only the points.
    """
    amounts = {name: estimate.value for name, estimate in found.parameters.items()}
    return replace(machine, axes=tuple(_corrected(a, amounts, angles) for a in machine.axes))


def _corrected(axis: RotaryAxis, amounts: Mapping[str, float], angles: bool) -> RotaryAxis:  # noqa: FBT001
    point_mm = [
        value + amounts.get(f"{name}O{axis.letter}", 0.0) / UM_PER_MM
        for name, value in zip("XYZ", axis.point_mm, strict=True)
    ]
    tilt_rad = [
        radians(amounts.get(f"{name}O{axis.letter}", 0.0) / ARCSEC_PER_DEG) if angles else 0.0
        for name in LETTERS
    ]
    tilt_rad[LETTERS.index(axis.letter)] = 0.0
    direction = Rotation.from_euler("xyz", tilt_rad).apply(axis.direction)
    return replace(
        axis,
        point_mm=cast(Vector, tuple(point_mm)),
        direction=cast(Vector, tuple(direction / np.linalg.norm(direction))),
    )


def _forward(stations: Stations) -> NDArray[np.bool_]:
    """Tell which measurements came from the side of the reference, or as it came."""
    sides = stations.approach[stations.is_reference & (stations.approach != 0)]
    side = sides[0] if len(sides) else 1
    return np.asarray((stations.approach == 0) | (stations.approach == side))


def _axis(
    letter: str, machine: Machine, corrected: Machine, truth: Truth, stations: Stations
) -> AxisResult:
    own = stations.of(letter)
    reference = np.flatnonzero(own & stations.is_reference)[0]
    measured = np.flatnonzero(own & ~stations.is_reference & _forward(stations))
    place = LETTERS.index(letter)
    slopes = _slopes(corrected, truth, stations, place)
    after_mm = _errors(corrected, truth, stations, reference, measured)
    along_deg = _along(after_mm, slopes[measured])
    radius_mm = float(np.mean(np.linalg.norm(slopes[measured], axis=1)) / radians(1.0))
    backlash_deg = _backlash(stations, own, slopes, place) if radius_mm >= LEAST_CIRCLE_MM else None
    scatter_deg = float(np.std(along_deg, ddof=1)) if len(along_deg) > 1 else 0.0
    return AxisResult(
        letter,
        stations.angle_deg[measured, place],
        radius_mm,
        None if backlash_deg is None else backlash_deg * ARCSEC_PER_DEG,
        _errors(machine, truth, stations, reference, measured),
        after_mm,
        float(np.mean(along_deg)) * ARCSEC_PER_DEG,
        scatter_deg * ARCSEC_PER_DEG,
    )


def _errors(
    machine: Machine,
    truth: Truth,
    stations: Stations,
    reference: np.intp,
    measured: NDArray[np.intp],
) -> FloatArray:
    """Give measured minus expected in mm, from a sphere put where the reference was measured."""
    sphere_mm = _turned_back(
        machine, truth, stations.angle_deg[reference], stations.centre_mm[reference]
    )
    expected = expected_mm(machine, truth, sphere_mm, stations.angle_deg[measured])
    return stations.centre_mm[measured] - expected


def _turned_back(
    machine: Machine, truth: Truth, angle_deg: FloatArray, centre_mm: FloatArray
) -> FloatArray:
    """Give where the sphere is at zero; what is read is linear in that."""
    origin = expected_mm(machine, truth, np.zeros(3), angle_deg[np.newaxis])[0]
    images = [expected_mm(machine, truth, e, angle_deg[np.newaxis])[0] for e in np.eye(3)]
    return np.linalg.solve(np.transpose(images - origin), centre_mm - origin)


def _slopes(machine: Machine, truth: Truth, stations: Stations, place: int) -> FloatArray:
    """Give how the expected reading changes with the axis's angle, mm a degree; shape (n, 3)."""
    rows = []
    for angle_deg, centre_mm in zip(stations.angle_deg, stations.centre_mm, strict=True):
        sphere_mm = _turned_back(machine, truth, angle_deg, centre_mm)
        step = SLOPE_STEP_DEG * np.eye(3)[place]
        ends = expected_mm(
            machine, truth, sphere_mm, np.array([angle_deg - step, angle_deg + step])
        )
        rows.append((ends[1] - ends[0]) / (2.0 * SLOPE_STEP_DEG))
    return np.array(rows)


def _along(errors_mm: FloatArray, slopes: FloatArray) -> FloatArray:
    """Give the angles in degrees that the errors are along the motion; shape (n,)."""
    squares = np.sum(slopes**2, axis=1)
    return np.asarray(np.sum(errors_mm * slopes, axis=1) / np.maximum(squares, 1e-12))


def _backlash(
    stations: Stations, own: NDArray[np.bool_], slopes: FloatArray, place: int
) -> float | None:
    """Give how far the falling approach is ahead of the rising one in degrees, on average."""
    rising = np.flatnonzero(own & (stations.approach > 0) & ~stations.is_reference)
    falling = np.flatnonzero(own & (stations.approach < 0) & ~stations.is_reference)
    angles = stations.angle_deg[:, place]
    pairs = [(r, f) for r in rising for f in falling if angles[r] == angles[f]]
    if not pairs:
        return None
    first, second = np.array(pairs).T
    moved_mm = stations.centre_mm[second] - stations.centre_mm[first]
    return float(np.mean(_along(moved_mm, slopes[first])))
