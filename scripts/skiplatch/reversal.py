"""The reversal error of an axis at rest: what positions that were met in both senses differ by."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Touches
from skiplatch.statistics import Interval
from skiplatch.surface_fit import by_t


@dataclass(frozen=True, slots=True)
class Reversal:
    """Coordinates met in the positive sense less those met in the negative, as ISO 230-2 has it.

    Attributes:
        mean: Over the positions; the interval is of what their touches scatter by.
        widest: The largest by its size.
        at: The position of that in mm, of rotary axes in deg.
        positions: How many there are.
    """

    mean: Interval
    widest: float
    at: float
    positions: int


def reversal_of(
    touches: Touches,
    y: FloatArray,
    surface: NDArray[np.intp],
    regular: BoolArray,
    sigma: float,
    freedom: int,
) -> Reversal | None:
    """Work it out; None where no position was met in both senses.

    Args:
        touches: Read at rest; n of them.
        y: Their deviations along the approach; shape (n,).
        surface: The number of the position and sense of each; shape (n,).
        regular: Those that enter; shape (n,).
        sigma: What they scatter by.
        freedom: Degrees of freedom of that.
    """
    place = touches.position_deg if np.isnan(touches.position_mm).all() else touches.position_mm
    middles: dict[tuple[int, int, float], dict[float, tuple[float, int]]] = {}
    for number in np.unique(surface[regular]):
        rows = regular & (surface == number)
        first = int(np.flatnonzero(rows)[0])
        position = (int(touches.session[first]), int(touches.axis[first]), float(place[first]))
        here = middles.setdefault(position, {})
        here[float(touches.sign[first])] = float(y[rows].mean()), int(rows.sum())
    both = {position: here for position, here in middles.items() if {1.0, -1.0} <= here.keys()}
    if not both:
        return None
    # Deviations count along the approach: that of the negative sense is minus its coordinate's.
    each = {position: here[1.0][0] + here[-1.0][0] for position, here in both.items()}
    variance = sum(1.0 / count for here in both.values() for _, count in here.values())
    error = sigma * float(np.sqrt(variance)) / len(both)
    widest = max(each, key=lambda position: abs(each[position]))
    mean = by_t(float(np.mean(list(each.values()))), error, freedom)
    return Reversal(mean, each[widest], widest[-1], len(both))
