"""Machines with planted location errors, by full rotation matrices and with nothing of the fit.

A machine's true axis lines are shifted and tilted, and every measured centre follows from turning
whole points about whole lines, one after the other.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM

OWN = {"A": 0, "B": 1, "C": 2}

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Kind:
    """A type of machine: its axes from the bed outwards and from the ram to the tool."""

    table: str
    head: str

    @property
    def axes(self) -> str:
        return self.table + self.head


TABLE_TABLE = Kind("AC", "")
HEAD_HEAD = Kind("", "CA")
TABLE_HEAD = Kind("C", "B")
KINDS = {"table-table": TABLE_TABLE, "head-head": HEAD_HEAD, "table-head": TABLE_HEAD}


@dataclass(frozen=True, slots=True)
class Line:
    """A line in space: a point in mm and a unit vector."""

    point: Array
    direction: Array


@dataclass(frozen=True, slots=True)
class Planted:
    """A machine as believed and as it is, and the difference by the names of ISO 230-7."""

    kind: Kind
    believed: dict[str, Line]
    actual: dict[str, Line]
    errors: dict[str, float]
    sphere: Array
    tip: Array


def names_of(letter: str) -> tuple[list[str], list[str]]:
    """Give the names of the two offsets and the two tilts of an axis."""
    others = [i for i in range(3) if i != OWN[letter]]
    return [f"{'XYZ'[i]}O{letter}" for i in others], [f"{'ABC'[i]}O{letter}" for i in others]


def plant(kind: Kind, rng: np.random.Generator, *, scale: float = 1.0) -> Planted:
    """Make a machine with errors of up to ± 0.5 mm and ± 0.05°."""
    believed, actual, errors = {}, {}, {}
    for letter in kind.axes:
        line = Line(rng.uniform(-60.0, 60.0, 3), np.eye(3)[OWN[letter]])
        offsets, tilts = names_of(letter)
        point, turn = line.point.copy(), Rotation.identity()
        for name in offsets:
            shift_mm = scale * rng.uniform(-0.5, 0.5)
            point["XYZ".index(name[0])] += shift_mm
            errors[name] = shift_mm * UM_PER_MM
        for name in tilts:
            tilt_deg = scale * rng.uniform(-0.05, 0.05)
            turn = (
                Rotation.from_euler(
                    name[0].replace("A", "x").replace("B", "y").replace("C", "z"),
                    tilt_deg,
                    degrees=True,
                )
                * turn
            )
            errors[name] = tilt_deg * ARCSEC_PER_DEG
        believed[letter] = line
        actual[letter] = Line(point, turn.apply(line.direction))
    sphere = np.array([rng.uniform(80, 200), rng.uniform(-150, 150), rng.uniform(20, 120)])
    tip = np.array([rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-300, -180)])
    return Planted(kind, believed, actual, errors, sphere, tip)


def positions(kind: Kind) -> Array:
    """Give the angles of a thorough measurement, shape (n, axes): the whole grid."""
    tilting = np.arange(-90.0, 91.0, 30.0)
    turning = np.arange(0.0, 360.0, 45.0)
    grids = [turning if letter == "C" else tilting for letter in kind.axes]
    return np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1).reshape(-1, len(grids))


def turned(line: Line, angles_deg: Array, places: Array) -> Array:
    """Turn places, shape (n, 3), about a line by n angles."""
    turns = Rotation.from_rotvec(np.radians(angles_deg)[:, None] * line.direction)
    return np.asarray(line.point + turns.apply(places - line.point))


def centres(
    machine: Planted, angles_deg: Array, rng: np.random.Generator, noise_mm: float
) -> Array:
    """Give what the linear axes read with the tip in the sphere's centre, shape (n, 3)."""
    read = readings(machine.kind, machine.actual, machine.sphere, machine.tip, angles_deg)
    return read + rng.normal(0.0, noise_mm, read.shape)


def readings(
    kind: Kind, lines: Mapping[str, Line], sphere_mm: Array, tip_mm: Array, angles_deg: Array
) -> Array:
    """Give what they read on a machine whose axes are these lines, shape (n, 3)."""
    at = dict(zip(kind.axes, angles_deg.T, strict=True))
    sphere = np.tile(sphere_mm, (len(angles_deg), 1))
    tip = np.tile(tip_mm, (len(angles_deg), 1))
    for letter in reversed(kind.table):
        sphere = turned(lines[letter], at[letter], sphere)
    for letter in reversed(kind.head):
        tip = turned(lines[letter], at[letter], tip)
    return np.asarray(sphere - (tip - tip_mm))


def best_offsets(
    kind: Kind, lines: Mapping[str, Line], angles_deg: Array, read_mm: Array, *, weight_z: float
) -> dict[str, Line]:
    """Shift the lines of a table so that the readings fit best, with all directions as they are.

    Args:
        kind: The machine, without a head.
        lines: As believed.
        angles_deg: Shape (n, axes).
        read_mm: Shape (n, 3).
        weight_z: Of a residual in Z, against one in X or Y.
    """
    names = [name for letter in kind.axes for name in names_of(letter)[0]]

    def shifted(offsets_mm: Array) -> dict[str, Line]:
        found = {x: Line(line.point.copy(), line.direction) for x, line in lines.items()}
        for name, offset_mm in zip(names, offsets_mm, strict=True):
            found[name[-1]].point["XYZ".index(name[0])] += offset_mm
        return found

    def residuals(unknowns: Array) -> Array:
        fitted = readings(kind, shifted(unknowns[3:]), unknowns[:3], np.zeros(3), angles_deg)
        return np.ravel((read_mm - fitted) * (1.0, 1.0, weight_z))

    start = np.concatenate([read_mm[0], np.zeros(len(names))])
    found = least_squares(residuals, start, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return shifted(found.x[3:])


def write_machine(path: Path, machine: Planted) -> None:
    """Write MACHINE.toml as believed."""
    chains = [
        f"{key} = {list(letters)}"
        for key, letters in (("table", machine.kind.table), ("head", machine.kind.head))
    ]
    lines = [chain.replace("'", '"') for chain in chains]
    for letter, line in machine.believed.items():
        lines += [
            f"[axes.{letter}]",
            f"direction = {line.direction.tolist()}",
            f"point_mm = {line.point.tolist()}",
        ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_points(path: Path, machine: Planted, angles_deg: Array, read_mm: Array) -> None:
    """Write POINTS.csv."""
    header = [*(f"{letter.lower()}_deg" for letter in machine.kind.axes), "x_mm", "y_mm", "z_mm"]
    rows = np.hstack([angles_deg, read_mm])
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(header), comments="")
