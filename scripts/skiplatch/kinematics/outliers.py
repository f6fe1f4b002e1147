"""Positions that do not belong to the others: found one by one, and named."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from skiplatch.kinematics.correction import apply_fit
from skiplatch.kinematics.cycle import expected_mm
from skiplatch.kinematics.firmware import Fit, NoFitError, fit
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.kinematics.points import Points

FALSE_ALARM = 1e-4
"""Rate at which scatter alone makes a fit name an outlier."""
MOST_SHARE = 0.2
"""Of the positions: more are no outliers but another machine."""
COORDINATES = 3
UM_PER_MM = 1000.0


@dataclass(frozen=True, slots=True)
class Outlier:
    """A position that the fit leaves out.

    Attributes:
        place: Its index among the points.
        off_um: How far it is from where all others expect it, in space.
        text: Where the axes stood, and how far it is off.
    """

    place: int
    off_um: float
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Points without their outliers.

    Attributes:
        kept: The others.
        outliers: In order of their places.
    """

    kept: Points
    outliers: tuple[Outlier, ...]


def without_outliers(machine: Machine, points: Points, touches: int | None) -> Judged:
    """Leave out what does not belong to the rest.

    That position goes whose absence takes most off the squares left, if scatter alone would do so
    once in 1/`FALSE_ALARM` fits (F test of its three coordinates, Bonferroni); then the next.
    Positions that alone determine something are never judged, nor are few.
    """
    stays = np.ones(len(points), dtype=bool)
    found = _fit_of(machine, points, stays, touches)
    while found is not None and np.sum(~stays) < int(MOST_SHARE * len(points)):
        worst = _worst(machine, points, stays, touches, found)
        if worst is None:
            break
        place, found = worst
        stays[place] = False
    outliers = () if found is None else tuple(_named(machine, points, stays, found))
    return Judged(_of(points, stays), outliers)


def _of(points: Points, rows: NDArray[np.bool_]) -> Points:
    return Points(points.angles_deg[rows], points.positions_mm[rows])


def _fit_of(
    machine: Machine, points: Points, rows: NDArray[np.bool_], touches: int | None
) -> Fit | None:
    try:
        return fit(machine, _of(points, rows), touches=touches)
    except NoFitError:
        return None


def _squares(found: Fit) -> float:
    return found.freedom * found.residual_um**2


def _worst(
    machine: Machine,
    points: Points,
    stays: NDArray[np.bool_],
    touches: int | None,
    found: Fit,
) -> tuple[int, Fit] | None:
    left = found.freedom - COORDINATES
    if left <= 0:
        return None
    best: tuple[int, Fit] | None = None
    for place in np.flatnonzero(stays):
        rows = stays.copy()
        rows[place] = False
        other = _fit_of(machine, points, rows, touches)
        alike = other is not None and other.rank == found.rank
        if other is not None and alike and (best is None or _squares(other) < _squares(best[1])):
            best = (int(place), other)
    if best is None:
        return None
    saved = (_squares(found) - _squares(best[1])) / COORDINATES
    ratio = saved / max(best[1].residual_um ** 2, 1e-12)
    level = FALSE_ALARM / np.sum(stays)
    return best if ratio > stats.f.isf(level, COORDINATES, left) else None


def _named(
    machine: Machine, points: Points, stays: NDArray[np.bool_], found: Fit
) -> Iterator[Outlier]:
    fitted = replace(apply_fit(machine, found), tool_mm=found.tip_mm)
    order = [LETTERS.index(letter) for letter in machine.letters]
    for place in np.flatnonzero(~stays):
        angle_deg = np.zeros(len(LETTERS))
        angle_deg[order] = points.angles_deg[place]
        expected = expected_mm(fitted, Truth(), np.array(found.sphere_mm), angle_deg[np.newaxis])
        off = points.positions_mm[place] - expected[0]
        off_um = UM_PER_MM * float(np.linalg.norm(off))
        stand = ", ".join(
            f"{letter} {angle:g}°"
            for letter, angle in zip(machine.letters, points.angles_deg[place], strict=True)
        )
        yield Outlier(int(place), off_um, f"{stand}: off by {off_um:.1f} µm")
