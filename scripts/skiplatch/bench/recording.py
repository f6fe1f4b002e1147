"""From what was injected and latched to the touches of a campaign."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.bench.listener import Arrival
from skiplatch.bench.plan import Plan
from skiplatch.bench.protocol import Edge
from skiplatch.campaign import Axis, InputPath, Nominal, Status, Touches
from skiplatch.motion import expected_contact
from skiplatch.units import NS_PER_S, NS_PER_US, S_PER_MIN, UM_PER_MM, US_PER_S

COUNTS = 1 << 32
LEAD_S = 1.0  # the master clock starts that long before the first touch


@dataclass(frozen=True, slots=True)
class VirtualAxis:
    """The axis of a controller on the bench: at 0 when its clock is 0, and moving ever since.

    Attributes:
        feed_mm_min: Its speed, `--feed` of skiplatch-controller.
        resolution_um: One count, `--resolution-um` of it.
    """

    feed_mm_min: float
    resolution_um: float

    def travel_um(self, position_counts: int, since_ns: int) -> float:
        """Give the way from an instant of CLOCK_MONOTONIC to a position; the counter wraps."""
        counts_per_ns = self.feed_mm_min / S_PER_MIN * UM_PER_MM / self.resolution_um / NS_PER_S
        start = since_ns * counts_per_ns
        whole = int(start)
        ahead = (position_counts - whole + COUNTS // 2) % COUNTS - COUNTS // 2
        return (ahead - (start - whole)) * self.resolution_um


@dataclass(frozen=True, slots=True)
class Played:
    """One touch that was played, or a latch without one; times are CLOCK_MONOTONIC in ns.

    Attributes:
        path: The input path that was on.
        feed_mm_min: The feed it stands for.
        planned_ns: When the edge was wanted; of a false latch, when it was latched.
        edge: The edge that was driven, if it was reported.
        arrival: The latch, if there was one.
        is_false: Latched without an edge.
    """

    path: InputPath
    feed_mm_min: float
    planned_ns: int
    edge: Edge | None
    arrival: Arrival | None
    is_false: bool = False

    @property
    def contact_ns(self) -> int:
        """When the virtual axis meets the surface."""
        return self.planned_ns if self.edge is None else self.edge.time_ns

    @property
    def status(self) -> Status:
        """What came of it."""
        if self.is_false:
            return Status.FALSE
        return Status.MISSED if self.arrival is None else Status.OK


def as_touches(
    plan: Plan, believed: Nominal, axis: VirtualAxis, played: Sequence[Played]
) -> Touches:
    """Give the touches of the campaign: each move starts so that it meets the surface at its edge.

    The master clock is CLOCK_MONOTONIC, and so is the device clock; both start anew with the
    campaign.
    """
    travel_us = np.array([plan.travel_us(touch.feed_mm_min) for touch in played])
    contact_ns = [touch.contact_ns for touch in played]
    starts_ns = [c - int(t * NS_PER_US) for c, t in zip(contact_ns, travel_us, strict=True)]
    zero_ns = min(starts_ns) - int(LEAD_S * NS_PER_S)
    contact_us = np.array([(time_ns - zero_ns) / NS_PER_US for time_ns in contact_ns])
    count = len(played)
    touches = Touches.from_columns(
        touch=np.arange(count),
        time_s=(contact_us - travel_us) / US_PER_S,
        path=np.array([touch.path for touch in played]),
        axis=np.full(count, Axis.X),
        sign=np.ones(count),
        alpha_deg=np.zeros(count),
        beta_deg=np.zeros(count),
        feed_mm_min=np.array([touch.feed_mm_min for touch in played]),
        approach_mm=np.full(count, plan.approach_mm),
        position_mm=np.zeros(count),
        edge_us=_micros([t.edge.time_ns if t.edge else None for t in played], zero_ns),
        latch_us=_micros([t.arrival.latch_ns if t.arrival else None for t in played], zero_ns),
        report_us=_micros([t.arrival.report_ns if t.arrival else None for t in played], zero_ns),
        deviation_um=np.full(count, np.nan),
        status=np.array([touch.status for touch in played]),
    )
    speeds_mm_s = expected_contact(believed, touches).speed_mm_s
    touches.deviation_um[:] = [
        _deviation_um(touch, axis, speed_mm_s, believed.axis.resolution_um)
        for touch, speed_mm_s in zip(played, speeds_mm_s, strict=True)
    ]
    return touches


def _micros(times_ns: Sequence[int | None], zero_ns: int) -> np.typing.NDArray[np.float64]:
    return np.array([np.nan if time is None else (time - zero_ns) / NS_PER_US for time in times_ns])


def _deviation_um(
    touch: Played, axis: VirtualAxis, speed_mm_s: float, resolution_um: float
) -> float:
    """Take the way of the controller's axis from edge to latch, as if at the feed of the touch."""
    if touch.arrival is None or touch.edge is None:
        return float("nan")
    way_um = axis.travel_um(touch.arrival.latch.position_counts, touch.edge.time_ns)
    scaled_um = way_um * speed_mm_s * S_PER_MIN / axis.feed_mm_min
    return float(np.round(scaled_um / resolution_um) * resolution_um)
