"""Error motions of rotary axes after ISO 230-7, from the centres of one sphere.

While an axis turns and the others stand, the readings run round a circle about its average line.
What they are off it is the error motion at the place of the sphere: across the axis the radial
error motion, along it the face error motion (axial, and tilt times the distance from the axis). The
mean circle and the mean plane are taken off: they are location errors of the average line. One
sphere cannot tell a turn of the axis (its angular positioning error) from a motion along the
circle, nor an axial motion from a tilt: that takes a second sphere at another height or radius.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.machine import LETTERS, Machine, RotaryAxis
from skiplatch.kinematics.points import Points
from skiplatch.units import UM_PER_MM

SAME_DEG = 0.01
LEAST_RADIUS_MM = 1e-3  # a circle of 1 µm is noise
FEWEST = 5
"""Angles: a mean circle and a mean plane take three from each coordinate's four or more."""
ARCSEC_PER_RAD = 206264.80624709636


@dataclass(frozen=True, slots=True, eq=False)
class ErrorMotion:
    """Error motion of one axis at the place of the sphere; k angles, means where several readings.

    Attributes:
        letter: The axis.
        others_deg: Where the others stand, by their letters.
        radius_mm: Of the mean circle.
        angle_deg: Shape (k,).
        motion_um: In machine coordinates, such as EXC, EYC and EZC, shape (k, 3).
        radial_um: Away from the average line, shape (k,).
        face_um: Along it, shape (k,).
        turn_arcsec: Along the circle, as the turn of the axis that it would be, shape (k,).
        asynchronous_um: Largest range of readings at one angle; None without repeats.
    """

    letter: str
    others_deg: dict[str, float]
    radius_mm: float
    angle_deg: FloatArray
    motion_um: FloatArray
    radial_um: FloatArray
    face_um: FloatArray
    turn_arcsec: FloatArray
    asynchronous_um: float | None

    @property
    def values_um(self) -> dict[str, float]:
        """Error motion values: ranges of the radial and of the face error motion."""
        return {"radial": float(np.ptp(self.radial_um)), "face": float(np.ptp(self.face_um))}


def error_motions(machine: Machine, points: Points) -> list[ErrorMotion]:
    """Find the error motion of each axis that turned to five angles while the others stood.

    A sphere on the axis itself goes round no circle and shows none.
    """
    found = (
        _motion(machine.axes[axis], axis, machine, points, rows)
        for axis in range(len(machine.axes))
        for rows in _groups(points.angles_deg, axis)
        if len(np.unique(_steps(points.angles_deg[rows, axis]))) >= FEWEST
    )
    return [motion for motion in found if motion is not None]


def _steps(angles_deg: FloatArray) -> NDArray[np.int64]:
    return np.round(angles_deg / SAME_DEG).astype(np.int64)


def _groups(angles_deg: FloatArray, axis: int) -> Iterator[NDArray[np.intp]]:
    """Give the rows at which the other axes stand alike."""
    others = np.delete(_steps(angles_deg), axis, axis=1)
    group = np.unique(others, axis=0, return_inverse=True)[1].ravel()
    for number in range(int(group.max()) + 1):
        yield np.flatnonzero(group == number)


def _motion(
    axis: RotaryAxis, place: int, machine: Machine, points: Points, rows: NDArray[np.intp]
) -> ErrorMotion | None:
    angles_deg = points.angles_deg[rows, place]
    frame = _frame(axis, machine, points.angles_deg[rows[0]])
    seen = points.positions_mm[rows] @ frame.T
    _, first, of_angle = np.unique(_steps(angles_deg), return_index=True, return_inverse=True)
    count = np.bincount(of_angle.ravel())
    mean = np.column_stack([np.bincount(of_angle.ravel(), x) / count for x in seen.T])
    theta = np.radians(angles_deg[first])
    off, arm = _off_circle(mean, theta)
    radius_mm = float(np.hypot(*arm))
    if radius_mm < LEAST_RADIUS_MM:
        return None
    towards = _turned(arm / radius_mm, theta)
    along = np.column_stack([-towards[:, 1], towards[:, 0]])
    turn_rad = np.sum(off[:, :2] * along, axis=1) / radius_mm
    spread = [np.ptp(seen[of_angle.ravel() == i], axis=0).max() for i in np.flatnonzero(count > 1)]
    others = {
        other.letter: float(points.angles_deg[rows[0], i])
        for i, other in enumerate(machine.axes)
        if i != place
    }
    return ErrorMotion(
        axis.letter,
        others,
        radius_mm,
        angles_deg[first],
        UM_PER_MM * off @ frame,
        UM_PER_MM * np.sum(off[:, :2] * towards, axis=1),
        UM_PER_MM * off[:, 2],
        ARCSEC_PER_RAD * turn_rad,
        UM_PER_MM * float(max(spread)) if spread else None,
    )


def _frame(axis: RotaryAxis, machine: Machine, angles_deg: FloatArray) -> FloatArray:
    """Give unit vectors across and along an axis as its carriers have turned it, shape (3, 3)."""
    direction = np.array(axis.direction)
    carriers = [
        (other, angle)
        for other, angle in zip(machine.axes, angles_deg, strict=True)
        if other.in_head == axis.in_head
    ]
    before = carriers[: [other.letter for other, _ in carriers].index(axis.letter)]
    for other, angle in reversed(before):
        direction = _about(np.array(other.direction), np.radians(angle), direction)
    across = np.eye(3)[(LETTERS.index(axis.letter) + 1) % 3]
    first = across - (across @ direction) * direction
    first /= np.linalg.norm(first)
    return np.vstack([first, np.cross(direction, first), direction])


def _about(axis: FloatArray, angle: float, vector: FloatArray) -> FloatArray:
    """Turn a vector about a unit vector (Rodrigues)."""
    return np.asarray(
        np.cos(angle) * vector
        + np.sin(angle) * np.cross(axis, vector)
        + (1.0 - np.cos(angle)) * (axis @ vector) * axis
    )


def _turned(arm: FloatArray, theta: FloatArray) -> FloatArray:
    """Give an arm, shape (2,), at k angles, shape (k, 2)."""
    cos, sin = np.cos(theta), np.sin(theta)
    return np.column_stack([cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]])


def _off_circle(seen: FloatArray, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Take the mean circle and the mean plane off; give what is left, and the circle's arm at 0."""
    cos, sin, one = np.cos(theta), np.sin(theta), np.ones_like(theta)
    nothing = np.zeros_like(theta)
    rows = np.block(
        [
            [np.column_stack([one, nothing, cos, -sin])],
            [np.column_stack([nothing, one, sin, cos])],
        ]
    )
    circle = np.linalg.lstsq(rows, seen[:, :2].T.ravel(), rcond=None)[0]
    plane_rows = np.column_stack([one, cos, sin])
    plane = np.linalg.lstsq(plane_rows, seen[:, 2], rcond=None)[0]
    off_circle = seen[:, :2] - (rows @ circle).reshape(2, -1).T
    return np.column_stack([off_circle, seen[:, 2] - plane_rows @ plane]), circle[2:]
