"""From edges, latches and reports of a board in its emulator to a campaign folder."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import Axis, InputPath, Nominal, Status, Touches
from skiplatch.motion import US_PER_S, expected_contact

APPROACH_MM = 5.0
LEAD_S = 5.0  # the master clock of the campaign runs that long before the emulator starts


@dataclass(frozen=True, slots=True)
class Recorded:
    """One injected edge and what came of it; times are µs since the emulator started.

    Attributes:
        path: The input path that was on.
        feed_mm_min: The speed of the axis.
        edge_us: When the edge came.
        latch_us: The firmware's stamp, or NaN.
        report_us: When the last byte of the record had come, or NaN.
        deviation_um: The way of the axis from the edge to the latched position, or NaN.
    """

    path: InputPath
    feed_mm_min: float
    edge_us: float
    latch_us: float
    report_us: float
    deviation_um: float


def as_touches(believed: Nominal, recorded: Sequence[Recorded]) -> Touches:
    """Give the rows of the campaign: each move starts so that it meets the surface at its edge."""
    count = len(recorded)
    zero_us = LEAD_S * US_PER_S
    edge_us = zero_us + np.array([touch.edge_us for touch in recorded])
    latch_us = zero_us + np.array([touch.latch_us for touch in recorded])
    touches = Touches.from_columns(
        touch=np.arange(count),
        time_s=edge_us / US_PER_S,
        path=np.array([touch.path for touch in recorded]),
        axis=np.full(count, Axis.X),
        sign=np.ones(count),
        alpha_deg=np.zeros(count),
        beta_deg=np.zeros(count),
        feed_mm_min=np.array([touch.feed_mm_min for touch in recorded]),
        approach_mm=np.full(count, APPROACH_MM),
        position_mm=np.zeros(count),
        edge_us=edge_us,
        latch_us=latch_us,
        report_us=zero_us + np.array([touch.report_us for touch in recorded]),
        deviation_um=np.array([touch.deviation_um for touch in recorded]),
        status=np.where(np.isnan(latch_us), Status.MISSED, Status.OK),
    )
    return _met_at(believed, touches)


def _met_at(believed: Nominal, touches: Touches) -> Touches:
    """Start each move so that it meets the surface at its edge.

    A campaign tells starts to the µs; what the edge is off then, the approach makes up, to the nm.
    """
    travel_us = expected_contact(believed, touches).time_us - touches.edge_us
    starts_s = np.round((touches.edge_us - travel_us) / US_PER_S, 6)
    started = replace(touches, time_s=starts_s)
    contact = expected_contact(believed, started)
    more_mm = contact.speed_mm_s * (touches.edge_us - contact.time_us) / US_PER_S
    return replace(started, approach_mm=touches.approach_mm + more_mm)
