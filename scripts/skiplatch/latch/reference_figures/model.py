"""What the reference document's figures are held against, and the rig they are simulated on."""

from dataclasses import dataclass, replace

from skiplatch.campaign import AxisNominal, InputNominal, Nominal, PlcNominal, SkipNominal
from skiplatch.latch.errors import LatchErrors
from skiplatch.latch.probing import DEFAULT_RIG
from skiplatch.statistics import CONFIDENCE, Interval, uniform_width

# The document's 4 ms scan on an otherwise ideal rig: no delay, and times and lengths so fine that
# rounding stays below the last printed place.
IDEAL = replace(
    DEFAULT_RIG,
    input=InputNominal(filter_us=0.0),
    skip=SkipNominal(latency_us=0.0, jitter_us=0.0, tick_us=0.001),
    plc=PlcNominal(scan_us=4000.0),
    axis=AxisNominal(resolution_um=0.0001, accel_mm_s2=3000.0),
)
FAST_MM_MIN = 3000.0
SLOW_MM_MIN = 30.0
DOUBT = 3.0  # times the interval


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceFigure:
    """A figure of the document beside the simulated one, in `unit`."""

    name: str
    unit: str
    document: float
    last_place: float = 0.0
    """By how much the document may have rounded the figure or cut it off."""
    simulated: Interval
    note: str = ""

    @property
    def difference(self) -> float:
        """Simulated minus document."""
        return self.simulated.value - self.document

    @property
    def agrees(self) -> bool:
        """Whether chance and the document's own rounding explain the difference.

        A difference of three times the interval of 95 % comes about by chance less often than
        once in a thousand simulations.
        """
        found = self.simulated
        below = DOUBT * (found.value - found.low) + self.last_place
        above = DOUBT * (found.high - found.value) + self.last_place
        return -above <= self.difference <= below


@dataclass(frozen=True, slots=True)
class Remark:
    """A simulated figure that the document does not have, but should be read with."""

    name: str
    unit: str
    simulated: Interval
    note: str


def certain(value: float) -> Interval:
    """Give a figure that chance has no part in."""
    return Interval(value, value, value)


def direct_input(width_us: float) -> Nominal:
    """Give a rig whose skip input reacts at any time within the width, all equally likely."""
    return replace(IDEAL, skip=replace(IDEAL.skip, jitter_us=width_us))


def range_um(errors: LatchErrors, confidence: float = CONFIDENCE) -> Interval:
    """Estimate the full range of the position on the ideal rig."""
    seen = errors.position_um
    width = uniform_width(seen.range.value, seen.count, confidence)
    rounding = IDEAL.axis.resolution_um
    return Interval(width.value, width.low - rounding, width.high + rounding)
