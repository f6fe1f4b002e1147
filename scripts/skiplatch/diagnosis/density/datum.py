"""Where the surface is: unknown by a length for each datum group, and fitted with every hypothesis.

A touch tells where the surface is only beside the others that share its datum, for a coordinate is
counted from a zero that somebody has set. What such a length takes up is therefore no effect. It
shows in two ways, each of which is free: stamps tell when the surface is met, coordinates where.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.residuals import Residuals

CodeArray = NDArray[np.intp]

BY_STAMPS = ("latch_skip", "latch_plc")
BY_COORDINATES = ("position",)
WITHOUT_STAMPS = ("deviation_skip", "deviation_plc")
FAMILIES = (BY_STAMPS, BY_COORDINATES, WITHOUT_STAMPS)
"""Observables that one length shifts together."""
SHIFTED = frozenset(name for family in FAMILIES for name in family)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The touches of one observable that a datum shifts; arrays of shape (m,).

    Attributes:
        residuals: With their laws.
        per_um: By how much a µm of datum shifts each.
        groups: Which datum each belongs to, from 0 up.
    """

    residuals: Residuals
    per_um: FloatArray
    groups: CodeArray


def at_best_datum(
    parts: Sequence[Part], count: int, u_um: float | None
) -> tuple[FloatArray, list[FloatArray]]:
    """Find the likeliest datum of each group.

    Args:
        parts: The observables that it shifts.
        count: How many groups there are, g.
        u_um: Standard uncertainty about 0; None for a datum that may be anywhere.

    Returns:
        The datum of each group, shape (g,), and the logarithms of the densities there, by part.
    """
    whole = Residuals.together([part.residuals for part in parts])
    per_um = np.concatenate([part.per_um for part in parts])
    groups = np.concatenate([part.groups for part in parts])
    found, logs = whole.at_best_datum(per_um, groups, count, u_um)
    ends = accumulate((len(part.groups) for part in parts), initial=0)
    return found, [logs[begin:end] for begin, end in pairwise(ends)]
