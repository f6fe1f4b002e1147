"""The GUM budget of a compensated probe: standard uncertainties, to first order (JCGM 100)."""

import math
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.compensation.compensate import Compensation
from skiplatch.compensation.probe_map import ProbeMap
from skiplatch.units import S_PER_MIN

COVERAGE = 2.0  # k
UM_MIN_PER_MM_MS = 1.0 / S_PER_MIN  # µm = mm/min · ms / 60
UNIFORM = math.sqrt(3.0)  # half width over standard deviation
LINEAR_RMS = math.sqrt(120.0)  # of ½·w″·x·(h − x) over a step h, beside its w″·h²


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """What the user knows and the data cannot tell.

    Attributes:
        repeatability_um: Standard deviation of one touch; None to take it from the repeats.
        resolution_um: Step of the latched position.
        feed_error: Largest relative error of the machine's feed, 0.01 for 1 %.
    """

    repeatability_um: float | None = None
    resolution_um: float = 0.0
    feed_error: float = 0.0


@dataclass(frozen=True, slots=True)
class Part:
    """One row of the budget.

    Attributes:
        name: The source.
        kind: "A" from repeats, "B" from anything else.
        distribution: The one it is given.
        uncertainty: Standard, in `unit`.
        unit: Of that.
        sensitivity: µm for one `unit`.
        freedom: Degrees of freedom; infinite where it is known.
    """

    name: str
    kind: str
    distribution: str
    uncertainty: float
    unit: str
    sensitivity: float
    freedom: float = math.inf

    @property
    def contribution_um(self) -> float:
        """Standard uncertainty of the result that comes from this."""
        return abs(self.sensitivity) * self.uncertainty


@dataclass(frozen=True, slots=True, eq=False)
class Budget:
    """Trigger radius of one touch at the table's feed, beside the radius all shall have.

    Attributes:
        parts: The rows.
        combined_um: Root of the sum of squares.
        freedom: Effective degrees of freedom (Welch and Satterthwaite).
    """

    parts: list[Part]
    combined_um: float
    freedom: float

    @property
    def expanded_um(self) -> float:
        """For k = 2."""
        return COVERAGE * self.combined_um


def resolution_um(inputs: Inputs) -> float:
    """Standard uncertainty by the step of the position."""
    return 0.5 * inputs.resolution_um / UNIFORM


def budget_of(done: Compensation, inputs: Inputs, *, measured: bool) -> Budget:
    """Give the rows and their sum of squares; `measured`: the repeatability is from the repeats."""
    sigma_um = inputs.repeatability_um or 0.0
    runs = done.probe_map.runs
    freedom = float(done.probe_map.freedom) if measured and runs > 1 else math.inf
    kind = "A" if measured else "B"
    change_mm_min = _rms(done.feed_mm_min - done.before_mm_min)
    travel_um = _rms(done.feed_mm_min) * done.delay.tau_ms * UM_MIN_PER_MM_MS
    delay = done.delay
    tau_freedom = math.inf if delay.freedom is None else float(delay.freedom)
    parts = [
        Part("repeatability of one touch", kind, "normal", sigma_um, "µm", 1.0, freedom),
        Part(
            f"the map, a mean of {runs}",
            kind,
            "normal",
            math.hypot(sigma_um, resolution_um(inputs)),
            "µm",
            1.0 / math.sqrt(runs),
            freedom,
        ),
        Part(
            "delay tau",
            "B" if delay.fit is None else "A",
            "normal",
            delay.uncertainty_ms,
            "ms",
            change_mm_min * UM_MIN_PER_MM_MS,
            tau_freedom,
        ),
        Part(
            "feed of the machine",
            "B",
            "uniform",
            100 * inputs.feed_error / UNIFORM,
            "%",
            travel_um / 100.0,
        ),
        Part("resolution of the position", "B", "uniform", resolution_um(inputs), "µm", 1.0),
        Part(
            "between two directions of the map",
            "B",
            "normal",
            interpolation_um(done.probe_map, sigma_um),
            "µm",
            1.0,
        ),
    ]
    combined_um = math.sqrt(sum(part.contribution_um**2 for part in parts))
    return Budget(parts, combined_um, _effective_freedom(parts, combined_um))


def _effective_freedom(parts: list[Part], combined_um: float) -> float:
    weight = sum(part.contribution_um**4 / part.freedom for part in parts)
    return combined_um**4 / weight if weight > 0.0 else math.inf


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def interpolation_um(probe_map: ProbeMap, sigma_um: float) -> float:
    """Estimate by how much the radius between two azimuths leaves the straight line.

    From second differences along the rings, less what their noise amounts to.
    """
    bends: list[FloatArray] = []
    cells = probe_map.cells
    for beta in np.unique(cells.beta_deg):
        ring = probe_map.mean_um[cells.beta_deg == beta]
        if len(ring) > 1:
            bends.append(np.roll(ring, 1) - 2.0 * ring + np.roll(ring, -1))
    noise = 6.0 * sigma_um**2 / probe_map.runs
    mean_square = float(np.mean(np.concatenate(bends) ** 2)) - noise
    return math.sqrt(max(mean_square, 0.0)) / LINEAR_RMS
