"""What was recorded of the position: beside a stamp, or without one and with all that came before.

A position without a stamp has the wait for a scan in it on the PLC path. That is a box as wide as
what the axis goes in a scan, and narrow where it is slow: by its law each touch tells what it can.
Of a surface that moves, and is met later, the stamps tell where it is in place of the positions.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import (
    ARRIVAL,
    BY_COORDINATES,
    BY_STAMPS,
    WITHOUT_STAMPS,
)
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.scene.scene import Scene


@dataclass(frozen=True, eq=False)
class Positions:
    """How far touches went beyond what is expected; arrays of shape (m,)."""

    rows: IndexArray
    """Numbers of the touches."""
    off_um: FloatArray
    """Beyond the mean of the law."""
    spread_um: FloatArray
    """Standard deviation of the law."""
    data: FloatArray
    """By how much a µm of each of d data shifts them; shape (m, d)."""

    def where(self, wanted: BoolArray) -> Self:
        """Keep some of the touches, told by a mask of shape (n,) of all of them."""
        kept = wanted[self.rows]
        return replace(
            self,
            rows=self.rows[kept],
            off_um=self.off_um[kept],
            spread_um=self.spread_um[kept],
            data=self.data[kept],
        )


def surfaces_show(scene: Scene) -> bool:
    """Tell whether it shows when surfaces are met, beside where."""
    return scene.is_machine and bool((scene.has_stamps | scene.has_arrivals).any())


def positions(scene: Scene, given: Change, *, of_surfaces: bool = False) -> Positions:
    """Take the touches of which a position was recorded, in order, on top of what is given.

    Or, of surfaces, what stamps tell of these.
    """
    off_um, spread_um = np.full(len(scene), np.nan), np.full(len(scene), np.nan)
    data: list[FloatArray] = []
    for family in (BY_STAMPS if of_surfaces else BY_COORDINATES, WITHOUT_STAMPS):
        datum = np.full(len(scene), -1)
        for stream in (scene.streams[n] for n in family if n in scene.streams and n != ARRIVAL):
            law, there = law_under(scene, stream, given), stream.rows
            um = scene.speed[there] if stream.unit == "µs" else 1.0
            off_um[there] = um * (stream.residuals - law.mean)[there]
            spread_um[there] = um * law.spread[there]
            datum[there] = scene.datum_of(stream)
        data += [
            np.where(datum == k, scene.datum_senses, 0.0) for k in np.unique(datum[datum >= 0])
        ]
    rows = np.flatnonzero(~np.isnan(off_um))
    columns = np.column_stack(data)[rows] if data else np.zeros((0, 0))
    return Positions(rows, off_um[rows], spread_um[rows], columns)
