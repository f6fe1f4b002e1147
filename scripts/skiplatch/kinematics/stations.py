"""The measurements of a cycle, one after another."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.machine import LETTERS
from skiplatch.simulator.library import CData, connection


@dataclass(frozen=True, slots=True)
class Stations:
    """The measurements of one cycle, n of them.

    Attributes:
        angle_deg: What A, B, C were told, shape (n, 3).
        centre_mm: The sphere's centre, shape (n, 3).
        radius_mm: Its radius, shape (n,).
        axis: Index of the axis that was being measured, shape (n,).
        serves: Bits of the axes whose measurement it is, shape (n,).
        approach: 1 or -1 for the sense in which the axis came, 0 as it comes, shape (n,).
        is_reference: The axis stood at 0°, shape (n,).
        is_second: It is the second of two approaches to one position, shape (n,).
    """

    angle_deg: FloatArray
    centre_mm: FloatArray
    radius_mm: FloatArray
    axis: NDArray[np.int64]
    serves: NDArray[np.int64]
    approach: NDArray[np.int64]
    is_reference: NDArray[np.bool_]
    is_second: NDArray[np.bool_]

    def of(self, letter: str) -> NDArray[np.bool_]:
        """Tell which measurements are those of an axis; shape (n,)."""
        return np.asarray((self.serves >> LETTERS.index(letter)) & 1 == 1)

    def letters(self) -> frozenset[str]:
        """Name the axes that were measured."""
        return frozenset(letter for letter in LETTERS if np.any(self.of(letter)))

    def has_second(self, letter: str) -> bool:
        """Tell whether an axis was approached from both sides."""
        return bool(np.any(self.is_second & (self.axis == LETTERS.index(letter))))


def station_rows(stations: Stations) -> CData:
    """Lay stations out as an array of sim_station_t, n of them."""
    ffi, _ = connection()
    rows = ffi.new("sim_station_t[]", len(stations.axis))
    for i, row in enumerate(rows):
        row.angle_deg = list(stations.angle_deg[i])
        row.centre_mm = list(stations.centre_mm[i])
        for name in ("radius_mm", "axis", "serves", "approach", "is_reference", "is_second"):
            setattr(row, name, getattr(stations, name)[i].item())
    return rows
