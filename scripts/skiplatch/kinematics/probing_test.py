"""Probing test on a sphere: 25 points three times, as ISO 10360-5 and ISO 230-10 have it.

Form is the range of the 25 distances from the least-squares sphere, size its diameter less the
calibrated one, both of each run by itself and with every point in it. The recommended places are
those of ISO 10360-5: the pole; 4 at 22.5° from it; 8 at 45°; 4 at 67.5°; 8 at 90°; each ring turned
by 22.5° against the one above.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.errors import InputError
from skiplatch.kinematics.points import POSITION_COLUMNS, read_columns
from skiplatch.kinematics.sphere import least_squares_sphere
from skiplatch.units import UM_PER_MM

POINTS, RUNS = 25, 3
RINGS = ((0.0, 1, 0.0), (22.5, 4, 0.0), (45.0, 8, 22.5), (67.5, 4, 45.0), (90.0, 8, 67.5))
"""Angle from the pole, number of points, azimuth of the first; degrees."""
TURNS_DEG = np.arange(0.0, 90.0, 2.5)
"""The pattern repeats after 90°; its azimuth is free."""


@dataclass(frozen=True, slots=True)
class ProbingRun:
    """One run: its form error, and its size error where the calibrated radius is known."""

    form_um: float
    size_um: float | None


@dataclass(frozen=True, slots=True)
class ProbingTest:
    """What a report states.

    Attributes:
        runs: Each run by itself.
        form_um: The largest form error: P_Form.Sph.1x25 (P_FTU of earlier editions), P_FTU,3D.
        size_um: The size error that is largest, with its sign: P_Size.Sph.1x25 (P_STU).
        off_pattern_deg: How far the farthest point is from its recommended place.
    """

    runs: tuple[ProbingRun, ...]
    form_um: float
    size_um: float | None
    off_pattern_deg: float


def pattern() -> FloatArray:
    """Give the recommended places as unit vectors, the pole along Z; shape (25, 3)."""
    rows = []
    for polar_deg, count, first_deg in RINGS:
        polar = np.radians(polar_deg)
        azimuth = np.radians(first_deg + np.arange(count) * 360.0 / count)
        flat = np.sin(polar) * np.ones(count)
        across = [flat * np.cos(azimuth), flat * np.sin(azimuth)]
        rows.append(np.column_stack([*across, np.cos(polar) * np.ones(count)]))
    return np.vstack(rows)


def read_test(path: Path) -> list[FloatArray]:
    """Read the runs of a test: columns run, x_mm, y_mm, z_mm; each of shape (25, 3) in mm.

    Raises:
        InputError: The file cannot be read, or is not of three runs of 25 points.
    """
    lines, rows = read_columns(path, ("run", *POSITION_COLUMNS))
    _refuse_rows(path, lines, rows)
    numbers = np.unique(rows[:, 0])
    if len(numbers) != RUNS:
        raise InputError(path, None, "run", f"expected {RUNS} runs, got {len(numbers)}")
    runs = [rows[rows[:, 0] == number, 1:] for number in numbers]
    for number, points in zip(numbers, runs, strict=True):
        if len(points) != POINTS:
            message = f"run {number:g}: expected {POINTS} points, got {len(points)}"
            raise InputError(path, None, "run", message)
    return runs


def _refuse_rows(path: Path, lines: list[int], rows: FloatArray) -> None:
    """Refuse what is no number of a run, and a point that stands there twice in one."""
    line_of: dict[tuple[float, ...], int] = {}
    for line, row in zip(lines, rows.tolist(), strict=True):
        if row[0] < 1.0 or row[0] % 1.0:
            message = f"expected the number of a run, from 1 on, got {row[0]:g}"
            raise InputError(path, line, "run", message)
        first = line_of.setdefault(tuple(row), line)
        if first != line:
            message = f"expected {POINTS} points of their own, got that of line {first} again"
            raise InputError(path, line, None, message)


def probing_test(runs: list[FloatArray], expected_mm: float | None) -> ProbingTest:
    """Evaluate a test.

    Args:
        runs: Points, each of shape (25, 3), the pole along Z.
        expected_mm: Radius that the points should have: the calibrated one of the sphere, with that
            of the tip where points are its centre; None where it is not known.

    Raises:
        NoSphereError: A run determines no sphere.
    """
    spheres = [least_squares_sphere(points) for points in runs]
    told = tuple(
        _run(points, sphere, expected_mm) for points, sphere in zip(runs, spheres, strict=True)
    )
    sizes = [run.size_um for run in told if run.size_um is not None]
    off_deg = [
        _off_pattern_deg(points - sphere[:3]) for points, sphere in zip(runs, spheres, strict=True)
    ]
    return ProbingTest(
        told, max(run.form_um for run in told), max(sizes, key=abs, default=None), max(off_deg)
    )


def _run(points: FloatArray, sphere: FloatArray, expected_mm: float | None) -> ProbingRun:
    lengths = np.linalg.norm(points - sphere[:3], axis=1)
    size = None if expected_mm is None else 2.0 * UM_PER_MM * float(sphere[3] - expected_mm)
    return ProbingRun(UM_PER_MM * float(np.ptp(lengths)), size)


def _off_pattern_deg(away: FloatArray) -> float:
    """Give the greatest angle between a point and its place, at the azimuth that fits best."""
    away = away / np.linalg.norm(away, axis=1)[:, None]
    return min(_farthest_deg(away, pattern() @ _about_z(turn_deg)) for turn_deg in TURNS_DEG)


def _about_z(turn_deg: float) -> FloatArray:
    cos, sin = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    return np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _farthest_deg(away: FloatArray, places: FloatArray) -> float:
    cosines = np.clip(away @ places.T, -1.0, 1.0)
    angles_deg = np.degrees(np.arccos(cosines))
    return float(angles_deg[scipy.optimize.linear_sum_assignment(angles_deg**2)].max())
