"""The document's uncertainties: scan period × feed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.campaign import InputPath, Nominal
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import LatchErrors, latch_errors
from skiplatch.latch.probing import one_touch
from skiplatch.latch.reference_figures.model import (
    FAST_MM_MIN,
    IDEAL,
    SLOW_MM_MIN,
    ReferenceFigure,
    direct_input,
    range_um,
)
from skiplatch.statistics import CONFIDENCE, Interval
from skiplatch.units import S_PER_MIN

FIT_FEEDS_MM_MIN = (30.0, 100.0, 300.0, 600.0, 1000.0, 1500.0, 2000.0, 3000.0)


@dataclass(frozen=True, slots=True)
class Case:
    """An input, a feed, and the range that the document gives for them."""

    name: str
    rig: Nominal
    path: InputPath
    feed_mm_min: float
    document_um: float


CASES = (
    Case("4 ms PLC scan", IDEAL, InputPath.PLC, FAST_MM_MIN, 200.0),
    Case("4 ms PLC scan", IDEAL, InputPath.PLC, SLOW_MM_MIN, 2.0),
    Case("0.2 ms skip input", direct_input(200.0), InputPath.SKIP, FAST_MM_MIN, 10.0),
    Case("4 µs skip input", direct_input(4.0), InputPath.SKIP, FAST_MM_MIN, 0.2),
)


@dataclass(frozen=True, slots=True)
class Proportionality:
    """A straight line through the ranges at several feeds: its slope is the reaction width."""

    feeds_mm_min: Sequence[float]
    ranges_um: Sequence[float]
    slope_ms: Interval
    intercept_um: float
    largest_residual: float
    """As a share of the range at that feed."""


def range_figures(effort: Effort) -> list[ReferenceFigure]:
    """Give the four ranges, and the standard uncertainty that follows from the first."""
    parts = effort.split(len(CASES))
    played = [
        latch_errors(one_touch(case.rig, case.path, case.feed_mm_min), part)
        for case, part in zip(CASES, parts, strict=True)
    ]
    ranges = [
        ReferenceFigure(
            name=f"range, {case.name}, {case.feed_mm_min:.0f} mm/min",
            unit="µm",
            document=case.document_um,
            simulated=range_um(errors),
        )
        for case, errors in zip(CASES, played, strict=True)
    ]
    return [*ranges, _standard_uncertainty(played[0])]


def proportionality(effort: Effort) -> Proportionality:
    """Fit a straight line to the simulated ranges of the 4 ms scan over the feed.

    The ranges have the same relative errors, so they are weighted by their inverses.
    """
    parts = effort.split(len(FIT_FEEDS_MM_MIN))
    ranges = np.array(
        [
            range_um(latch_errors(one_touch(IDEAL, InputPath.PLC, feed), part)).value
            for feed, part in zip(FIT_FEEDS_MM_MIN, parts, strict=True)
        ]
    )
    speeds_um_ms = np.array(FIT_FEEDS_MM_MIN) / S_PER_MIN  # which is also mm/s
    (slope, intercept), covariance = np.polyfit(speeds_um_ms, ranges, 1, w=1.0 / ranges, cov=True)
    error = np.sqrt(covariance[0, 0])
    low, high = scipy.stats.t.interval(CONFIDENCE, len(ranges) - 2, slope, error)
    residuals = ranges - (intercept + slope * speeds_um_ms)
    return Proportionality(
        feeds_mm_min=FIT_FEEDS_MM_MIN,
        ranges_um=ranges.tolist(),
        slope_ms=Interval(float(slope), float(low), float(high)),
        intercept_um=float(intercept),
        largest_residual=float(np.max(np.abs(residuals / ranges))),
    )


def slope_figure(line: Proportionality) -> ReferenceFigure:
    """Give the slope of that line, which the document says is the scan period."""
    return ReferenceFigure(
        name="slope of the range over the feed, 4 ms PLC scan",
        unit="ms",
        document=4.0,
        simulated=line.slope_ms,
        note=f"straight line through {len(line.feeds_mm_min)} feeds, 30 to 3000 mm/min; "
        f"largest residual {100.0 * line.largest_residual:.2g} %",
    )


def _standard_uncertainty(errors: LatchErrors) -> ReferenceFigure:
    return ReferenceFigure(
        name="standard uncertainty, 4 ms PLC scan, 3000 mm/min",
        unit="µm",
        document=200.0 / math.sqrt(12.0),
        simulated=errors.position_um.standard_deviation,
        note="not printed there: v·T/√12 of the range that is",
    )
