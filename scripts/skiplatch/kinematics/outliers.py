"""Positions that do not belong to the others: found one by one, and named."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.kinematics.axis_report import expected_mm
from skiplatch.kinematics.correction import apply_fit
from skiplatch.kinematics.firmware import Fit, NoFitError, fit
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.kinematics.points import Points
from skiplatch.units import UM_PER_MM

FALSE_ALARM = 1e-4
"""Rate at which scatter alone makes a fit name an outlier."""
MOST_SHARE = 0.2
"""Of the positions: more are no outliers but another machine."""
COORDINATES = 3


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
    Positions that alone determine something are never judged, nor are few. Where all together fit
    no machine, that one goes without which the others fit best.
    """
    stays = np.ones(len(points), dtype=bool)
    found = _fit_of(machine, points, stays, touches)
    while np.sum(~stays) < int(MOST_SHARE * len(points)):
        best = _best_without_one(machine, points, stays, touches)
        if best is None or not _is_surprising(found, best[1], np.sum(stays)):
            break
        place, found = best
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


def _best_without_one(
    machine: Machine, points: Points, stays: NDArray[np.bool_], touches: int | None
) -> tuple[int, Fit] | None:
    """Give the position whose absence leaves least, and the fit of the others.

    What determines as much as all do goes before what leaves less.
    """
    best: tuple[int, Fit] | None = None
    for place in np.flatnonzero(stays):
        rows = stays.copy()
        rows[place] = False
        other = _fit_of(machine, points, rows, touches)
        if other is not None and (best is None or _order(other) < _order(best[1])):
            best = (int(place), other)
    return best


def _order(found: Fit) -> tuple[int, float]:
    return -found.rank, _squares(found)


def _is_surprising(found: Fit | None, without: Fit, count: int) -> bool:
    """Tell whether scatter alone hardly ever leaves so much less for the want of a position."""
    if found is None:
        return True
    left = found.freedom - COORDINATES
    if left <= 0 or without.rank != found.rank:
        return False
    saved = (_squares(found) - _squares(without)) / COORDINATES
    ratio = saved / max(without.residual_um**2, 1e-12)
    return bool(ratio > scipy.stats.f.isf(FALSE_ALARM / count, COORDINATES, left))


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
