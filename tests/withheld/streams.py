"""What of a touch the scorer and the baselines look at: residuals of the nominal chain.

Written apart from the diagnosis, so that neither inherits the other's errors.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from skiplatch.campaign import Kind, Nominal, Touches
from tests.withheld.chain import UM_US_PER_MM_MIN, BoolArray, FloatArray, lobes_um, travel_us

FEWEST_FEEDS_BINNED = 9
FEED_BINS = 5


class Outcomes(Protocol):
    """What was recorded or played; arrays of shape (…, n), NaN where there was nothing."""

    @property
    def latch_us(self) -> FloatArray:
        """Time stamp of the latch."""

    @property
    def report_us(self) -> FloatArray:
        """Arrival of the report."""

    @property
    def deviation_um(self) -> FloatArray:
        """Latched minus nominal position."""


@dataclass(frozen=True)
class Played:
    """Outcomes as plain arrays, shape (replicates, n)."""

    latch_us: FloatArray
    report_us: FloatArray
    deviation_um: FloatArray


@dataclass(frozen=True, eq=False)
class Expected:
    """What the nominal chain expects of n touches; arrays of shape (n,).

    Attributes:
        speed_um_us: At the contact.
        contact_us: When the nominal surface is met.
        wait_us: From there to the middle of the time in which the latch falls.
        spread_us: Standard deviation of that time.
        plc: Latched by the PLC task.
        machine: A probe touched a surface.
        resolution_um: Of the position.
        tick_us: Of the time stamps.
        report_us: Latch to report, in the middle.
        report_spread_us: Standard deviation of that.
    """

    speed_um_us: FloatArray
    contact_us: FloatArray
    wait_us: FloatArray
    spread_us: FloatArray
    plc: BoolArray
    machine: bool
    resolution_um: float
    tick_us: float
    report_us: float
    report_spread_us: float

    @classmethod
    def of(cls, nominal: Nominal, touches: Touches) -> "Expected":
        """Expect what the format's nominal chain says."""
        approach_um = touches.approach_mm * 1e3
        accel = np.full(len(touches), nominal.axis.accel_mm_s2 * 1e-9)
        feed = touches.feed_mm_min * UM_US_PER_MM_MIN
        speed = np.minimum(feed, np.sqrt(2 * accel * approach_um))
        machine = nominal.kind is Kind.MACHINE
        pretravel = np.maximum(nominal.probe.pretravel_um + _lobes(nominal, touches), 0.0) * machine
        skip, plc = nominal.skip, touches.on_plc
        width = np.where(plc, nominal.plc.scan_us, skip.jitter_us)
        least = pretravel / speed + nominal.probe.delay_us + nominal.input.filter_us
        mechanics = nominal.probe.repeatability_um / speed
        noise = mechanics**2 + nominal.bench.reference_jitter_us**2 + skip.tick_us**2 / 12
        return cls(
            speed_um_us=speed,
            contact_us=touches.time_s * 1e6 + travel_us(approach_um, feed, accel),
            wait_us=least + np.where(plc, 0.0, skip.latency_us) + width / 2,
            spread_us=np.sqrt(width**2 / 12 + noise),
            plc=plc,
            machine=machine,
            resolution_um=nominal.axis.resolution_um,
            tick_us=skip.tick_us,
            report_us=nominal.report.latency_us + nominal.report.jitter_us / 2,
            report_spread_us=float(np.hypot(nominal.report.jitter_us, skip.tick_us) / np.sqrt(12)),
        )

    @property
    def spreads(self) -> Mapping[str, FloatArray]:
        """The expected standard deviation of every stream, shape (n,)."""
        rounding = self.resolution_um / np.sqrt(12)
        return {
            "latch": self.spread_us,
            "position": np.full(len(self.speed_um_us), rounding),
            "deviation": np.hypot(self.speed_um_us * self.spread_us, rounding),
            "report": np.full(len(self.speed_um_us), self.report_spread_us),
            "grid": np.full(len(self.speed_um_us), self.tick_us / np.sqrt(12)),
        }


def _lobes(nominal: Nominal, touches: Touches) -> FloatArray:
    lobes = lobes_um(touches, nominal.probe.lobe_um, nominal.probe.lobe_phase_deg)
    return np.nan_to_num(lobes)


def residuals(
    expected: Expected, outcomes: Outcomes, begin_us: FloatArray
) -> Mapping[str, FloatArray]:
    """Give recorded or played minus expected by stream, shape (…, n).

    Args:
        expected: Of the nominal chain.
        outcomes: What is looked at.
        begin_us: What the latch is counted from, shape (…, n): the edge that the bench's
            instrument saw, or the expected contact.
    """
    latch_us = outcomes.latch_us + expected.tick_us / 2  # a stamp is rounded down
    wait = latch_us - begin_us
    way = expected.speed_um_us * wait
    return {
        "latch": wait - expected.wait_us,
        "position": outcomes.deviation_um - way,
        "deviation": outcomes.deviation_um - expected.speed_um_us * expected.wait_us,
        "report": outcomes.report_us - latch_us - expected.report_us,
    }


def begin_us(expected: Expected, touches: Touches) -> FloatArray:
    """Give what the latch is counted from, shape (n,)."""
    edge = touches.edge_us
    known = ~np.isnan(edge) if not expected.machine else np.zeros(len(edge), bool)
    return np.where(known, edge, expected.contact_us)


def cells(touches: Touches) -> list[BoolArray]:
    """Part the touches by path and feed; where every touch has a feed of its own, by bins."""
    feed = touches.feed_mm_min
    if len(np.unique(feed)) >= FEWEST_FEEDS_BINNED:
        edges = np.quantile(feed, np.linspace(0, 1, FEED_BINS + 1)[1:-1])
        kind = np.searchsorted(edges, feed)
    else:
        kind = np.unique(feed, return_inverse=True)[1]
    masks = [
        (touches.on_plc == plc) & (kind == one) for plc in (False, True) for one in np.unique(kind)
    ]
    return [mask for mask in masks if mask.any()]
