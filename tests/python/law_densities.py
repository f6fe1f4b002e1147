"""Densities of residuals under a law, as ``density.c`` computes them."""

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.law import SMALLEST, Law
from skiplatch.diagnosis.likelihood.physics import fill
from skiplatch.simulator.library import CData, connection, layout


def laid_out(law: Law, residuals: FloatArray, reach: float) -> tuple[CData, object]:
    """Give residuals, shape (n,), with the law of each for C, and what has to live as long.

    Args:
        law: Arrays of shape (n,), or numbers.
        residuals: Shape (n,).
        reach: Width over which a contaminated one may lie anywhere.
    """
    ffi, n = connection()[0], len(residuals)
    laws = np.empty(n, dtype=layout("sim_law_t"))
    fill(laws, law)
    extras = np.empty((len(law.extras), n), dtype=layout("sim_extra_t"))
    for row, extra in zip(extras, law.extras, strict=True):
        fill(row, extra)
    parts = (
        ffi.from_buffer("double[]", np.ascontiguousarray(residuals, dtype=np.float64)),
        ffi.from_buffer("sim_law_t[]", laws),
        ffi.from_buffer("sim_extra_t[]", extras),
        ffi.from_buffer("double[]", np.full(n, reach)),
    )
    return ffi.new("sim_residuals_t *", (*parts, n, len(extras), SMALLEST)), parts


def law_log_density(law: Law, residuals: FloatArray, reach: float) -> FloatArray:
    """Give the logarithm of the density of each residual; shape (n,)."""
    (ffi, library), found = connection(), np.empty(len(residuals))
    residuals_for_c, _kept = laid_out(law, residuals, reach)
    to = ffi.from_buffer("double[]", found, require_writable=True)
    library.sim_law_log_density(residuals_for_c, to)
    return found
