"""How much of an error sines of many frequencies explain, over positions that lie anywhere."""

import numpy as np
from scipy import fft

from skiplatch.arrays import FloatArray

FINE = (32, 5.0)
"""Cells of the shortest wave, on which the positions are put, and frequencies within the width of
a peak, which is one over the span."""
COARSE = (4, 3.0)
"""The same of very many waves: they see 0.9 of the amplitude."""
SMALLEST = 1e-9


def explained_by_sines(
    position: FloatArray,
    error: FloatArray,
    weights: FloatArray,
    turns: float,
    fastest: float,
    *,
    is_coarse: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Give frequencies, and the share of the weighted variance that the best sine of each explains.

    This is the generalised Lomb-Scargle periodogram (Zechmeister and Kürster 2009, equations 4 to
    15), whose sums come from transforms over cells of position (Press and Rybicki 1989). Where few
    positions come again and again, their spectrum has aliases: least squares tells them apart.

    Args:
        position: Shape (n,), in any unit.
        error: Shape (n,).
        weights: Of the errors, positive, shape (n,).
        turns: Periods over the span of the positions, at the lowest frequency.
        fastest: Highest frequency, in periods a unit of position.
        is_coarse: On few cells, as very many waves ask for.

    Returns:
        Rising frequencies, and the shares from 0 to 1; shape (m,).
    """
    span = float(np.ptp(position)) or 1.0
    cells, finer = COARSE if is_coarse else FINE
    cell = 1.0 / (cells * fastest)
    length = fft.next_fast_len(int(np.ceil(finer * span / cell)) + 1, real=True)
    where = np.rint((position - position.min()) / cell).astype(np.intp)
    weights = weights / weights.sum()
    error = error - weights @ error

    def transformed(values: FloatArray) -> FloatArray:
        return np.asarray(fft.rfft(np.bincount(where, values, length)))

    steps = np.arange(int(np.ceil(length * cell * turns / span)), int(length * cell * fastest) + 1)
    windows, errors = transformed(weights), transformed(weights * error)
    c, s = windows[steps].real, windows[steps].imag
    double = windows[2 * steps]
    yc, ys = errors[steps].real, errors[steps].imag
    cc = (1.0 + double.real) / 2.0 - c * c
    ss = (1.0 - double.real) / 2.0 - s * s
    cs = double.imag / 2.0 - c * s
    determinant = np.maximum(cc * ss - cs * cs, SMALLEST)
    reduced = (ss * yc * yc + cc * ys * ys - 2.0 * cs * yc * ys) / determinant
    shares = reduced / max(float(weights @ error**2), SMALLEST)
    return steps / (length * cell), np.clip(shares, 0.0, 1.0)
