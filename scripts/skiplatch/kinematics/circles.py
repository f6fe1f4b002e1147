"""The circles that readings run round while one axis turns: ``comp/kinematics_circle.h``."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.kinematics.firmware import point_rows
from skiplatch.kinematics.machine import Machine
from skiplatch.kinematics.points import Points
from skiplatch.simulator.library import connection
from skiplatch.units import UM_PER_MM


@dataclass(frozen=True, slots=True)
class Circle:
    """The circle that the readings run round while one axis turns and the others stand still.

    Attributes:
        letter: The axis.
        others_deg: Where the others stand, by their letters.
        positions: How many there are.
        centre_mm: Its centre, in machine coordinates.
        radius_mm: Its radius.
        uncertainty_um: Standard uncertainty of a coordinate of the centre and of the radius; 0
            with two positions.
    """

    letter: str
    others_deg: Mapping[str, float]
    positions: int
    centre_mm: tuple[float, float, float]
    radius_mm: float
    uncertainty_um: float


def circles(machine: Machine, points: Points) -> list[Circle]:
    """Give each axis's circle where it turns most often with the others standing still.

    It is fitted by itself, in closed form; an axis that never turns alone has none.
    """
    found = []
    distinct = np.unique(points.angles_deg, axis=0)
    for place, letter in enumerate(machine.letters):
        stands, turns = np.unique(np.delete(distinct, place, axis=1), axis=0, return_counts=True)
        stand = stands[np.argmax(turns)]
        alone = np.all(np.delete(points.angles_deg, place, axis=1) == stand, axis=1)
        if np.max(turns) > 1 and (circle := _circle(machine, place, points, alone)):
            others = machine.letters[:place] + machine.letters[place + 1 :]
            others_deg = dict(zip(others, map(float, stand), strict=True))
            found.append(Circle(letter, others_deg, int(np.sum(alone)), *circle))
    return found


def _circle(
    machine: Machine, place: int, points: Points, alone: NDArray[np.bool_]
) -> tuple[tuple[float, float, float], float, float] | None:
    ffi, library = connection()
    rows = point_rows(machine, Points(points.angles_deg[alone], points.positions_mm[alone]))
    given = ffi.from_buffer("kinematics_point_t[]", rows)
    circle = ffi.new("kinematics_circle_t *")
    direction = ffi.new("double[3]", machine.axes[place].direction)
    if library.sim_kinematics_circle(direction, place, given, len(rows), circle) != 0:
        return None
    return tuple(circle.centre_mm), circle.radius_mm, UM_PER_MM * circle.uncertainty_mm
