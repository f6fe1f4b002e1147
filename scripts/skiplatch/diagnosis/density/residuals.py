"""Residuals laid out for the densities that ``density.c`` computes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.simulator.library import CData, connection, layout

LEAST_U = 1e-12
"""Standard uncertainty of a length that is known."""


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
        _fill(laws, law)
        more = np.empty((len(extras), n), dtype=layout("sim_extra_t"))
        for row, extra in zip(more, extras, strict=True):
            _fill(row, extra)
        return cls(
            np.ascontiguousarray(values, dtype=np.float64),
            laws,
            more,
            np.full(n, reach),
            resolution,
        )

    @classmethod
    def together(cls, several: Sequence[Self]) -> Self:
        """Put residuals end to end; who has fewer extras has some of no share."""
        if len(several) == 1:
            return several[0]
        ends = np.cumsum([0, *(len(one.values) for one in several)])
        laws = np.empty(ends[-1], several[0].laws.dtype)
        extras = np.zeros(
            (max(len(one.extras) for one in several), ends[-1]), layout("sim_extra_t")
        )
        for begin, end, one in zip(ends[:-1], ends[1:], several, strict=True):
            laws[begin:end] = one.laws
            extras[: len(one.extras), begin:end] = one.extras
        return cls(
            np.concatenate([one.values for one in several]),
            laws,
            extras,
            np.concatenate([one.reach for one in several]),
            several[0].resolution,
        )

    def _laid_out(self) -> tuple[CData, object]:
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
        laid_out, _kept = self._laid_out()
        library.sim_law_log_density(
            laid_out, ffi.from_buffer("double[]", found, require_writable=True)
        )
        return found

    def at_best_datum(
        self, per_length: FloatArray, groups: NDArray[np.intp], count: int, u: float | None
    ) -> tuple[FloatArray, FloatArray]:
        """Find the length that each group of residuals is off by; see ``sim_law_at_best_datum``.

        Args:
            per_length: By how much a unit of it moves each residual, > 0; shape (n,).
            groups: Number of the group of each, from 0 up; shape (n,).
            count: How many groups there are, g.
            u: Standard uncertainty about 0; None if it may be anything.

        Returns:
            The lengths, shape (g,), and the logarithms of the densities there, shape (n,).
        """
        ffi, library = connection()
        # Where no length is likely at all, none is written.
        found, logs = np.zeros(count), np.full(len(self.values), -np.inf)
        kept = (
            ffi.from_buffer("double[]", np.ascontiguousarray(per_length, dtype=np.float64)),
            ffi.from_buffer("uint32_t[]", np.ascontiguousarray(groups, dtype=np.uint32)),
        )
        laid_out, _alive = self._laid_out()
        code = library.sim_law_at_best_datum(
            laid_out,
            ffi.new("sim_datum_t *", (*kept, count, 0.0 if u is None else max(u, LEAST_U))),
            ffi.from_buffer("double[]", found, require_writable=True),
            ffi.from_buffer("double[]", logs, require_writable=True),
        )
        if code:
            raise MemoryError
        return found, logs


def _fill(rows: NDArray[np.void], source: object) -> None:
    """Give structures the values of the attributes that are named like their fields."""
    for name in rows.dtype.fields or ():
        rows[name] = getattr(source, name)
