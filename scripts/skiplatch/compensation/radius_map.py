"""Trigger radii over directions, and the controller's table of speeds made of them.

Nothing is computed here: see ``firmware/comp/pretravel_map.h``, ``pretravel_grid.h`` and
``pretravel_lookup.h``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skiplatch.arrays import FloatArray
from skiplatch.compensation.firmware import as_doubles, doubles, refuse, together
from skiplatch.simulator.library import CData, connection, layout


class Map:
    """Trigger radii over directions, ordered by β and then α; arrays of shape (count,)."""

    def __init__(self, cells: NDArray[np.void]) -> None:
        self._cells = cells
        self.alpha_deg: FloatArray = cells["alpha_deg"].copy()
        self.beta_deg: FloatArray = cells["beta_deg"].copy()
        self.radius_um: FloatArray = cells["radius_um"].copy()
        """Mean of the repeats."""
        self.scatter_um: FloatArray = cells["scatter_um"].copy()
        """Standard deviation of the repeats; NaN of a single one."""
        self.runs: NDArray[np.uint32] = cells["runs"].copy()

    def __len__(self) -> int:
        return len(self._cells)

    @classmethod
    def from_readings(
        cls, alpha_deg: ArrayLike, beta_deg: ArrayLike, radius_um: ArrayLike
    ) -> "Map":
        """Sort n readings, in any order, into directions with mean and scatter.

        Raises:
            PretravelError: NOT_FINITE or DIRECTION, with the reading's index.
        """
        ffi, library = connection()
        alpha, beta, radius = together(alpha_deg, beta_deg, radius_um)
        cells = np.zeros(len(alpha), dtype=layout("pretravel_cell_t"))
        count = ffi.new("uint32_t *")
        code = library.pretravel_map_build(
            doubles(alpha),
            doubles(beta),
            doubles(radius),
            len(alpha),
            ffi.from_buffer("pretravel_cell_t[]", cells, require_writable=True),
            len(cells),
            count,
        )
        refuse(code, int(count[0]))
        return cls(cells[: count[0]].copy())

    def check(self) -> None:
        """Refuse a map with gaps or too few directions.

        Raises:
            PretravelError: FEW_DIRECTIONS, or GAP with where it is.
        """
        ffi, library = connection()
        gap = ffi.new("pretravel_gap_t *")
        refuse(library.pretravel_map_check(self._rows(), len(self), gap), gap=gap)

    def at(self, values: ArrayLike, alpha_deg: ArrayLike, beta_deg: ArrayLike) -> FloatArray:
        """Values of any directions, interpolated from one value a cell; map without gaps."""
        _, library = connection()
        held = as_doubles(values)
        alpha, beta = together(alpha_deg, beta_deg)
        rows, given = self._rows(), doubles(held)
        at = library.pretravel_map_at
        return np.array(
            [at(rows, given, len(self), a, b) for a, b in zip(alpha, beta, strict=True)]
        )

    def lookup(
        self, speed_mm_min: ArrayLike, *, divisions: int, unit_mm_min: float | None = None
    ) -> "Lookup":
        """Lay speeds, one a cell, out for the controller; map without gaps.

        Args:
            speed_mm_min: Shape (count,).
            divisions: M: 2, 4, 8, 16 or 32; the table has 2·M² + 2·M + 1 vertices.
            unit_mm_min: What a looked-up speed is counted in; the finest if it is not given.

        Raises:
            PretravelError: DIVISIONS, LIMIT or SCALE.
        """
        ffi, library = connection()
        speeds = as_doubles(speed_mm_min)
        unit = Lookup.finest_unit_mm_min(speeds) if unit_mm_min is None else unit_mm_min
        vertices = np.zeros(library.pretravel_grid_size(divisions), dtype=np.uint8)
        code = library.pretravel_grid_build(
            self._rows(),
            doubles(speeds),
            len(self),
            divisions,
            unit * library.PRETRAVEL_LOOKUP_PARTS,
            ffi.from_buffer("uint8_t[]", vertices, require_writable=True),
        )
        refuse(code)
        return Lookup(vertices, divisions, unit)

    def _rows(self) -> CData:
        ffi, _ = connection()
        return ffi.from_buffer("pretravel_cell_t[]", self._cells)


@dataclass(frozen=True, slots=True, eq=False)
class Lookup:
    """The controller's table."""

    vertices: NDArray[np.uint8]
    """Speeds in 128 units, row by row; see ``pretravel_lookup.h``."""
    divisions: int
    unit_mm_min: float
    """What a looked-up speed is counted in."""

    @staticmethod
    def finest_unit_mm_min(speed_mm_min: ArrayLike) -> float:
        """Smallest unit in which all of these speeds, shape (count,), fit into a table."""
        _, library = connection()
        units = library.PRETRAVEL_VERTEX_MAX * library.PRETRAVEL_LOOKUP_PARTS
        return float(np.max(as_doubles(speed_mm_min))) / float(units)

    def speed_mm_min(self, directions: ArrayLike) -> FloatArray:
        """Speeds as the controller finds them, in fixed point; 0 below the equator.

        Args:
            directions: Vectors of 16-bit integers, shape (n, 3).
        """
        ffi, library = connection()
        held = ffi.from_buffer("uint8_t[]", self.vertices)
        pole = held + len(self.vertices) // 2
        table = ffi.new("pretravel_lookup_t *", (pole, self.divisions))
        find = library.pretravel_lookup
        vectors = np.asarray(directions, dtype=np.int16)
        return self.unit_mm_min * np.array([find(table, *vector) for vector in vectors.tolist()])
