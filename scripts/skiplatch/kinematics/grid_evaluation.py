"""What cycle 453 finds: how far the sphere is off over the grid, and the table that makes good."""

from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.axis_report import expected_mm
from skiplatch.kinematics.evaluate import has_unknown_tip, turned_back
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.grid import Grid
from skiplatch.kinematics.machine import LETTERS, Machine, Vector
from skiplatch.kinematics.points import Points
from skiplatch.kinematics.stations import Stations

DELETE = -1
"""A mode of Q406, besides the check and 1, compensate."""
SAME_DEG = 0.01
TABLE_DIGITS = 7
"""Of mm: a table is kept to 0.1 nm, so that a file has what a run had."""


class NoGridError(Exception):
    """The machine or its recorded positions are none that a grid can be evaluated of."""


@dataclass(frozen=True, slots=True, eq=False)
class GridEvaluation:
    """What a cycle 453 found at n positions, the reference first.

    Attributes:
        mode: Q406: -1 delete, 0 check, 1 compensate.
        believed: The description, with its table, as it was.
        corrected: With the table as it is now, or in a check would be.
        angle_deg: Where A, B, C stood, shape (n, 3).
        off_mm: How far the sphere was from where the kinematics with the table expect it when it
            stands where the reference found it, shape (n, 3).
    """

    mode: int
    believed: Machine
    corrected: Machine
    angle_deg: FloatArray
    off_mm: FloatArray

    @property
    def distance_mm(self) -> FloatArray:
        """How far off in space, shape (n,)."""
        return np.asarray(np.linalg.norm(self.off_mm, axis=1))

    @property
    def deviation_mm(self) -> float:
        """Root mean square of that over the positions besides the reference."""
        return float(np.sqrt(np.mean(self.distance_mm[1:] ** 2)))

    @property
    def greatest(self) -> int:
        """Which position is farthest off."""
        return int(np.argmax(self.distance_mm))

    @property
    def change_mm(self) -> float:
        """The greatest change of a value of the table, in space."""
        return float(np.max(self.distance_mm))

    def place_text(self, position: int) -> str:
        """Say where the axes of the machine stand at a position."""
        return ", ".join(
            f"{letter} {angle:g}°"
            for letter, angle in zip(LETTERS, self.angle_deg[position], strict=True)
            if letter in self.believed.letters
        )


def evaluate_grid(machine: Machine, truth: Truth, stations: Stations, mode: int) -> GridEvaluation:
    """Tell how far the sphere is off over the grid, and add that to the table.

    Args:
        machine: As believed, with a grid.
        truth: What the simulated machine knows of its tip.
        stations: What was measured, the reference first.
        mode: Q406, 0 or 1.
    """
    angles_deg, centres_mm = stations.angle_deg, stations.centre_mm
    sphere_mm = turned_back(machine, truth, angles_deg[:1], centres_mm[:1])[0]
    off_mm = centres_mm - expected_mm(machine, truth, sphere_mm, angles_deg)
    grid = compensated(_grid_of(machine), angles_deg, off_mm)
    return GridEvaluation(mode, machine, replace(machine, grid=grid), angles_deg, off_mm)


def deleted(machine: Machine) -> GridEvaluation:
    """Take back all that is compensated; nothing was measured."""
    none = np.zeros((0, len(LETTERS)))
    cleared = replace(machine, grid=_grid_of(machine).cleared())
    return GridEvaluation(DELETE, machine, cleared, none, none)


def _grid_of(machine: Machine) -> Grid:
    if machine.grid is None:  # the cycle has refused it before
        raise NoGridError("the machine has no grid")
    return machine.grid


def compensated(grid: Grid, angles_deg: FloatArray, off_mm: FloatArray) -> Grid:
    """Add what was found at the positions of a grid, in any order, to its table."""
    table_mm = []
    for position, row in zip(grid.positions_deg, grid.table_mm, strict=True):
        (found,) = np.flatnonzero(np.all(np.abs(angles_deg - position) < SAME_DEG, axis=1))
        x, y, z = np.round(np.add(row, off_mm[found]), TABLE_DIGITS).tolist()
        table_mm.append((x, y, z))
    return replace(grid, offset_mm=tuple(table_mm))


def sort_grid(machine: Machine, points: Points, radius_mm: float) -> tuple[Stations, list[str]]:
    """Find the recorded positions of a grid, the reference first; several of one are averaged.

    Returns:
        The stations, and what the operator should know.

    Raises:
        NoGridError: A position of the grid is missing, or where the tip is.
    """
    if has_unknown_tip(machine):
        raise NoGridError("tool_mm is needed of a machine with axes in the head")
    shown_deg = np.zeros((len(points), len(LETTERS)))
    shown_deg[:, [LETTERS.index(letter) for letter in machine.letters]] = points.angles_deg
    zero: Vector = (0.0, 0.0, 0.0)
    grid = _grid_of(machine)
    angles_deg = np.array([zero, *(p for p in grid.positions_deg if p != zero)])
    radii_mm = np.full(len(points), radius_mm) if points.radius_mm is None else points.radius_mm
    centres, radii, used = [], [], 0
    for position in angles_deg:
        own = np.all(np.abs(shown_deg - position) < SAME_DEG, axis=1)
        if not np.any(own):
            stands = ", ".join(f"{x} {position[LETTERS.index(x)]:g}°" for x in machine.letters)
            raise NoGridError(f"no recorded position at {stands}, which the grid has")
        used += int(np.sum(own))
        centres.append(np.mean(points.positions_mm[own], axis=0))
        radii.append(float(np.mean(radii_mm[own])))
    alone = len(points) - used
    notes = [f"{alone} of {len(points)} positions are none of the grid: left out."] if alone else []
    return _stations(angles_deg, np.array(centres), np.array(radii)), notes


def _stations(angles_deg: FloatArray, centres_mm: FloatArray, radii_mm: FloatArray) -> Stations:
    none = np.zeros(len(angles_deg), dtype=np.int64)
    first = np.arange(len(angles_deg)) == 0
    return Stations(angles_deg, centres_mm, radii_mm, none, none, none, first, none > 0)
