"""From edges, latches and reports of a board in its emulator to a campaign folder."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.campaign import Axis, InputPath, Status, Touches


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


def as_touches(recorded: Sequence[Recorded]) -> Touches:
    """Give the rows of the campaign.

    An axis that runs past its surfaces, one after another, has no start of a move: there is none.
    """
    count = len(recorded)
    latch_us = np.array([touch.latch_us for touch in recorded])
    return Touches.from_columns(
        touch=np.arange(count),
        path=np.array([touch.path for touch in recorded]),
        axis=np.full(count, Axis.X),
        sign=np.ones(count),
        alpha_deg=np.zeros(count),
        beta_deg=np.zeros(count),
        feed_mm_min=np.array([touch.feed_mm_min for touch in recorded]),
        position_mm=np.zeros(count),
        edge_us=np.array([touch.edge_us for touch in recorded]),
        latch_us=latch_us,
        report_us=np.array([touch.report_us for touch in recorded]),
        deviation_um=np.array([touch.deviation_um for touch in recorded]),
        status=np.where(np.isnan(latch_us), Status.MISSED, Status.OK),
    )
