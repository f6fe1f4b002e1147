"""What was recorded of one stretch of the chain, as residuals with their law."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.law import Law


@dataclass(frozen=True, eq=False)
class Stream:
    """Residuals of one stretch of the chain and their nominal law; arrays of shape (n,).

    A touch in which something for it was not recorded is not in `rows`.
    """

    name: str
    unit: str
    stages: tuple[str, ...]
    residuals: FloatArray
    chain: Law
    """Of the nominal chain alone."""
    rows: BoolArray
    law: Law
    """Of the rig that is believed in: the chain with the effects that it is believed to have."""

    @property
    def is_polled(self) -> bool:
        """It holds touches on the PLC path alone."""
        return self.name.endswith("_plc")

    @cached_property
    def indices(self) -> NDArray[np.intp]:
        """Numbers of the touches in `rows`."""
        return np.flatnonzero(self.rows)

    @cached_property
    def known(self) -> FloatArray:
        """The residuals of `rows` alone."""
        return self.residuals[self.rows]

    @cached_property
    def far(self) -> float:
        """Size that a tenth of the residuals exceeds."""
        # Beliefs are tried out by the hundred: np.quantile takes ten times as long.
        place = len(self.indices) * 9 // 10
        return float(np.partition(np.abs(self.known), place)[place])

    @cached_property
    def _parts(self) -> dict[bytes, "Stream"]:
        return {}

    def part(self, rows: BoolArray) -> "Stream":
        """Give the same for some of the touches; an onset that is searched for asks often."""
        key = rows.tobytes()
        if key not in self._parts:
            self._parts[key] = replace(self, rows=self.rows & rows)
        return self._parts[key]

    def off(self, law: Law) -> float:
        """Root mean square distance of the residuals from a law's mean, without the worst."""
        off = np.abs(self.residuals - law.mean)[self.rows]
        return float(np.sqrt(np.mean(off[off <= np.quantile(off, 0.95)] ** 2)))
