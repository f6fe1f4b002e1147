"""A sphere through measured points: centre, radius, form, and how well they are known."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.errors import InputError
from skiplatch.kinematics.points import POSITION_COLUMNS, read_positions
from skiplatch.units import UM_PER_MM

LEAST_POINTS = 6
UNKNOWNS = 4
FALSE_ALARM = 1e-4
MOST_SHARE = 0.2
COVERAGE = 0.9973
LARGEST_CONDITION = 1e6


@dataclass(frozen=True, slots=True)
class Sphere:
    """What n points say of a sphere.

    Attributes:
        centre_mm: Its centre.
        radius_mm: Its radius, to the points as they are: with a tip's where they are its centre.
        form_um: Largest minus smallest distance from the centre, outliers left out.
        u_um: Standard uncertainty of x, y, z and radius; ± 3 of them hold 99.73 %.
        residual_um: Standard deviation of a distance.
        outliers: Index and distance from the sphere in µm of each point that was left out.
    """

    centre_mm: tuple[float, float, float]
    radius_mm: float
    form_um: float
    u_um: tuple[float, float, float, float]
    residual_um: float
    outliers: tuple[tuple[int, float], ...]


class NoSphereError(Exception):
    """The points determine no sphere."""


def read_sphere_points(path: Path) -> FloatArray:
    """Read points, shape (n, 3) in mm.

    Raises:
        InputError: The file cannot be read, or has fewer than six points.
    """
    points = read_positions(path)
    if len(points) < LEAST_POINTS:
        columns = ", ".join(POSITION_COLUMNS)
        message = f"{len(points)} points; expected at least {LEAST_POINTS}, with {columns}"
        raise InputError(path, len(points) + 1, None, message)
    return points


def fit_sphere(points_mm: FloatArray) -> Sphere:
    """Fit a sphere to points, shape (n, 3), by least squares of their distances.

    A point goes whose absence takes so much off the squares that scatter alone would do so once
    in 1/`FALSE_ALARM` fits (F test, Bonferroni); then the next.

    Raises:
        NoSphereError: They lie in a plane or a line, or on too small a part of a sphere.
    """
    stays = np.ones(len(points_mm), dtype=bool)
    unknowns = least_squares_sphere(points_mm)
    while np.sum(~stays) < int(MOST_SHARE * len(points_mm)):
        worst = _worst(points_mm, stays, unknowns)
        if worst is None:
            break
        place, unknowns = worst
        stays[place] = False
    return _told(points_mm, stays, unknowns)


def least_squares_sphere(points: FloatArray) -> FloatArray:
    """Give centre and radius by least squares of the distances, shape (4,), from the algebraic one.

    Raises:
        NoSphereError: The points determine none.
    """
    middle = points.mean(axis=0)
    near = points - middle
    scale = float(np.sqrt(np.mean(np.sum(near**2, axis=1))))
    if scale <= 0.0:
        raise NoSphereError("all points are the same")
    near = near / scale
    rows = np.column_stack([2.0 * near, np.ones(len(near))])
    if np.linalg.cond(rows) > LARGEST_CONDITION:
        raise NoSphereError("the points lie in a plane: they determine no sphere")
    x = np.linalg.lstsq(rows, np.sum(near**2, axis=1), rcond=None)[0]
    start = np.append(x[:3], np.sqrt(max(x[3] + x[:3] @ x[:3], 1e-12)))
    found = scipy.optimize.least_squares(
        _residuals, start, _slopes, args=(near,), xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    centre = middle + scale * found.x[:3]
    return np.append(centre, scale * found.x[3])


def _residuals(unknowns: FloatArray, points: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(points - unknowns[:3], axis=1) - unknowns[3])


def _slopes(unknowns: FloatArray, points: FloatArray) -> FloatArray:
    away = points - unknowns[:3]
    length = np.linalg.norm(away, axis=1)[:, None]
    return np.column_stack([-away / length, -np.ones(len(points))])


def _worst(
    points: FloatArray, stays: NDArray[np.bool_], unknowns: FloatArray
) -> tuple[int, FloatArray] | None:
    count = int(np.sum(stays))
    left = count - 1 - UNKNOWNS
    if left <= 0:
        return None
    all_squares = float(np.sum(_residuals(unknowns, points[stays]) ** 2))
    best: tuple[float, int, FloatArray] | None = None
    for place in np.flatnonzero(stays):
        rows = stays.copy()
        rows[place] = False
        try:
            other = least_squares_sphere(points[rows])
        except NoSphereError:
            continue
        squares = float(np.sum(_residuals(other, points[rows]) ** 2))
        if best is None or squares < best[0]:
            best = (squares, int(place), other)
    if best is None:
        return None
    ratio = (all_squares - best[0]) / max(best[0] / left, np.finfo(float).tiny)
    limit = scipy.stats.f.isf(FALSE_ALARM / count, 1, left)
    is_exact = all_squares <= (1e-12 * unknowns[3]) ** 2 * count
    return None if is_exact or ratio <= limit else (best[1], best[2])


def _told(points: FloatArray, stays: NDArray[np.bool_], unknowns: FloatArray) -> Sphere:
    kept = points[stays]
    off = _residuals(unknowns, kept)
    freedom = len(kept) - UNKNOWNS
    residual = float(np.sqrt(np.sum(off**2) / freedom))
    slopes = _slopes(unknowns, kept)
    covariance = np.linalg.inv(slopes.T @ slopes)
    widened = float(scipy.stats.t.isf(0.5 * (1.0 - COVERAGE), freedom)) / 3.0
    u_um = UM_PER_MM * residual * widened * np.sqrt(np.diag(covariance))
    outside = _residuals(unknowns, points)
    x, y, z, radius = map(float, unknowns)
    return Sphere(
        (x, y, z),
        radius,
        UM_PER_MM * float(np.ptp(off)),
        (float(u_um[0]), float(u_um[1]), float(u_um[2]), float(u_um[3])),
        UM_PER_MM * residual,
        tuple((int(i), UM_PER_MM * float(outside[i])) for i in np.flatnonzero(~stays)),
    )
