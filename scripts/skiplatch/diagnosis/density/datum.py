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

from skiplatch.arrays import FloatArray, median
from skiplatch.diagnosis.density.residuals import Residuals

CodeArray = NDArray[np.intp]

BY_STAMPS = ("latch_skip", "latch_plc")
BY_COORDINATES = ("position",)
WITHOUT_STAMPS = ("deviation_skip", "deviation_plc")
FAMILIES = (BY_STAMPS, BY_COORDINATES, WITHOUT_STAMPS)
"""Observables that one length shifts together."""
SHIFTED = frozenset(name for family in FAMILIES for name in family)
CALM = 2.0
"""Standard deviations beyond which a touch pulls a first guess no further."""
TINY = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The touches of one observable that a datum shifts; arrays of shape (m,).

    Attributes:
        residuals: With their laws.
        off: By how much each is off the middle of its law.
        variance: Of the law.
        per_um: By how much a µm of datum shifts each.
        groups: Which datum each belongs to, from 0 up.
    """

    residuals: Residuals
    off: FloatArray
    variance: FloatArray
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
    per_um = np.concatenate([part.per_um for part in parts])
    groups = np.concatenate([part.groups for part in parts])
    off_um = np.concatenate([part.off for part in parts]) / per_um
    width_um = np.sqrt(np.concatenate([part.variance for part in parts])) / per_um
    weights = width_um**-2.0
    told = np.bincount(groups, weights, count)
    weight = told + (0.0 if u_um is None else max(u_um, TINY) ** -2.0)
    guess = np.zeros(count)
    for group in range(count):
        here = np.flatnonzero(groups == group)
        if len(here):
            widths_um = width_um[here]
            guess[group] = median(off_um[here[widths_um <= median(widths_um)]])
    calm = np.clip((off_um - guess[groups]) / width_um, -CALM, CALM) * width_um
    pull = np.bincount(groups, calm * weights, count)
    guess = (guess + pull / np.maximum(told, TINY)) * told / np.maximum(weight, TINY)
    whole = Residuals.together([part.residuals for part in parts])
    steps = np.maximum(weight, TINY) ** -0.5
    found, logs = whole.at_best_datum(per_um, groups, guess, steps, u_um)
    ends = accumulate((len(part.off) for part in parts), initial=0)
    return found, [logs[begin:end] for begin, end in pairwise(ends)]
