"""Residuals laid out for the densities that ``density.c`` computes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.simulator.library import CData, connection, layout


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """Residuals laid out for C with the law of each; see ``law.h``.

    Attributes:
        values: Shape (n,).
        laws: Shape (n,).
        extras: Shape (e, n).
        reach: Width over which a contaminated one may lie anywhere; shape (n,).
        resolution: Scatter below which nothing is resolved.
    """

    values: FloatArray
    laws: NDArray[np.void]
    extras: NDArray[np.void]
    reach: FloatArray
    resolution: float

    @classmethod
    def of(
        cls,
        values: FloatArray,
        law: object,
        extras: Sequence[object],
        reach: float,
        resolution: float,
    ) -> Self:
        """Lay them out.

        Args:
            values: Shape (n,).
            law: Has an attribute for each field of sim_law_t: arrays of shape (n,), or numbers.
            extras: The same, each for the fields of sim_extra_t.
            reach: Width over which a contaminated one may lie anywhere.
            resolution: Scatter below which nothing is resolved.
        """
        n = len(values)
        laws = np.empty(n, dtype=layout("sim_law_t"))
        fill(laws, law)
        more = np.empty((len(extras), n), dtype=layout("sim_extra_t"))
        for row, extra in zip(more, extras, strict=True):
            fill(row, extra)
        return cls(
            np.ascontiguousarray(values, dtype=np.float64),
            laws,
            more,
            np.full(n, reach),
            resolution,
        )

    def for_c(self) -> tuple[CData, object]:
        """Give the structure for C, and what has to live as long."""
        ffi, _ = connection()
        parts = (
            ffi.from_buffer("double[]", self.values),
            ffi.from_buffer("sim_law_t[]", self.laws),
            ffi.from_buffer("sim_extra_t[]", self.extras),
            ffi.from_buffer("double[]", self.reach),
        )
        counts = (len(self.values), len(self.extras), self.resolution)
        return ffi.new("sim_residuals_t *", (*parts, *counts)), parts

    def log_densities(self) -> FloatArray:
        """Logarithm of the density of each; shape (n,)."""
        (ffi, library), found = connection(), np.empty(len(self.values))
        laid_out, _kept = self.for_c()
        library.sim_law_log_density(
            laid_out, ffi.from_buffer("double[]", found, require_writable=True)
        )
        return found


def fill(rows: NDArray[np.void], source: object) -> None:
    """Give structures the values of the attributes that are named like their fields."""
    for name in rows.dtype.fields or ():
        rows[name] = getattr(source, name)
