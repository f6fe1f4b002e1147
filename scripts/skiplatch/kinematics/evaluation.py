"""What cycles 451 and 452 find: errors of each axis, location errors, corrected kinematics."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.axis_report import Results
from skiplatch.kinematics.firmware import Fit
from skiplatch.kinematics.machine import Machine, Vector
from skiplatch.kinematics.outliers import Outlier
from skiplatch.units import ARCSEC_PER_DEG


@dataclass(frozen=True, slots=True, eq=False)
class AxisResult:
    """One measured axis; n is the number of positions besides the reference.

    Attributes:
        letter: The axis.
        angle_deg: Its positions, shape (n,).
        before_mm: Errors with the kinematics as they were, shape (n, 3).
        after_mm: Errors with the corrected kinematics, shape (n, 3).
        results: What the firmware reports of it.
    """

    letter: str
    angle_deg: FloatArray
    before_mm: FloatArray
    after_mm: FloatArray
    results: Results

    @property
    def radius_mm(self) -> float:
        """Radius of the circle on which the sphere or the tip went."""
        return self.results.radius_mm

    @property
    def backlash_arcsec(self) -> float | None:
        """Mean over the positions; None when not measured or not computed."""
        found = self.results
        return found.backlash_deg * ARCSEC_PER_DEG if found.has_backlash else None

    @property
    def positioning_arcsec(self) -> float:
        """Mean positioning error relative to 0°, corrected kinematics."""
        return self.results.positioning_deg * ARCSEC_PER_DEG

    @property
    def positioning_scatter_arcsec(self) -> float:
        """Its standard deviation; 0 with a single position."""
        return self.results.positioning_scatter_deg * ARCSEC_PER_DEG

    @property
    def scatter_before_mm(self) -> float:
        """Root mean square of the errors in space; with one position its error."""
        return self.results.scatter_before_mm

    @property
    def scatter_after_mm(self) -> float:
        """The same with the corrected kinematics."""
        return self.results.scatter_after_mm

    @property
    def greatest_before_mm(self) -> float:
        """Greatest error in space."""
        return self.results.greatest_before_mm

    @property
    def greatest_after_mm(self) -> float:
        """The same with the corrected kinematics."""
        return self.results.greatest_after_mm


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """What a cycle found.

    Attributes:
        mode: Q406.
        believed: The kinematics as they were.
        corrected: As they are, or in mode 0 would be, corrected.
        fit: The firmware's fit of the location errors.
        axes: Each measured axis.
        q_mm: Q141 to Q149.
        combined: Sums of location errors that were corrected though their parts are not known.
        outliers: Positions that the fit left out.
        preset_off_mm: How far the sphere was off the preset that cycle 452 keeps; None in 451.
    """

    mode: int
    believed: Machine
    corrected: Machine
    fit: Fit
    axes: tuple[AxisResult, ...]
    q_mm: Mapping[int, float]
    combined: tuple[str, ...] = ()
    outliers: tuple[Outlier, ...] = ()
    preset_off_mm: Vector | None = None

    @property
    def change_mm(self) -> float:
        """The largest change of the location of an axis, or of the tip."""
        before, after = (
            [*(axis.point_mm for axis in machine.axes), machine.tip_shift_mm]
            for machine in (self.believed, self.corrected)
        )
        return float(np.max(np.linalg.norm(np.subtract(after, before), axis=1)))

    def q_parameters(self) -> dict[int, float]:
        """Give Q141 to Q149 in mm."""
        return dict(self.q_mm)
