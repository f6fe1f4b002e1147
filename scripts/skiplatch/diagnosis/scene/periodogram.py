"""How much of an error sines of many frequencies explain, over positions that lie anywhere."""

import numpy as np
import scipy

from skiplatch.arrays import FloatArray

FREQUENCIES_A_PEAK = 5.0
"""Within the width of a peak, which is one over the span."""
FINE = (32, FREQUENCIES_A_PEAK)
"""Cells of the shortest wave, on which the positions are put, and frequencies within a peak."""
COARSE = (4, 3.0)
"""The same of very many waves: they see 0.9 of the amplitude."""
SMALLEST = 1e-9
FEWEST_VALUES = 8
"""Distinct values that tell a wave: it has amplitude, phase, period and mean."""
DISTINCT_DIGITS = 2
ALIKE = 0.5
"""Share of a wave's variance from which on another one, at the values that there are, is its
alias."""
CELLS_OF_WINDOW = 8
MOST_BETWEEN = 16.0
"""Waves between two values, on an average, that are looked for."""


def shortest_wave(values: FloatArray) -> float:
    """Give the shortest wave that values, shape (n,), tell from all longer ones.

    Two frequencies look alike where the spectral window of the values is high at what they are
    apart: of even values that is twice their spacing, of values that lie anywhere far less (Eyer
    and Bartholdi, Astronomy and Astrophysics Supplement 135 (1999) 1).

    Returns:
        In the unit of the values; infinite for too few.
    """
    distinct = np.unique(np.round(values[~np.isnan(values)], DISTINCT_DIGITS))
    if len(distinct) < FEWEST_VALUES:
        return np.inf
    span = float(np.ptp(distinct))
    fastest = MOST_BETWEEN * len(distinct) / span
    cell = 1.0 / (CELLS_OF_WINDOW * 2.0 * fastest)
    length = scipy.fft.next_fast_len(int(np.ceil(FREQUENCIES_A_PEAK * span / cell)) + 1, real=True)
    where = np.rint((distinct - distinct[0]) / cell).astype(np.intp)
    window = np.abs(scipy.fft.rfft(np.bincount(where, minlength=length)) / len(distinct)) ** 2
    is_alike = window[: int(2.0 * fastest * length * cell) + 1] > ALIKE
    if is_alike.all():
        return np.inf
    # Frequencies nearer than the width of a peak are one.
    first = int(np.argmin(is_alike))
    aliases = np.flatnonzero(is_alike[first:])
    return 2.0 * length * cell / (first + int(aliases[0])) if len(aliases) else 1.0 / fastest


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
    length = scipy.fft.next_fast_len(int(np.ceil(finer * span / cell)) + 1, real=True)
    where = np.rint((position - position.min()) / cell).astype(np.intp)
    weights = weights / weights.sum()
    error = error - weights @ error

    def transformed(values: FloatArray) -> FloatArray:
        return np.asarray(scipy.fft.rfft(np.bincount(where, values, length)))

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
