"""What is seen of a played touch, cut into stretches of the chain that vary independently."""

from collections.abc import Set as AbstractSet

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Kind, Nominal, Touches
from skiplatch.diagnosis.scene.grid import off_grid
from skiplatch.motion import expected_contact
from skiplatch.simulator.playing import Outcomes
from skiplatch.units import UM_US_PER_MM_S

MISSED = "missed"


def recordable(nominal: Nominal) -> tuple[str, ...]:
    """Outcome columns that a rig of this kind can record, the most direct ones first."""
    edges = ("edge_us",) if nominal.kind == Kind.BENCH else ()
    reports = ("report_us",) if nominal.arrival_us is None else ()
    return (*edges, "latch_us", "deviation_um", *reports)


def recorded(nominal: Nominal, touches: Touches) -> frozenset[str]:
    """Outcome columns in which something was recorded."""
    kept = (name for name in recordable(nominal) if not np.isnan(getattr(touches, name)).all())
    return frozenset(kept)


def channels(
    nominal: Nominal, touches: Touches, outcomes: Outcomes, columns: AbstractSet[str]
) -> dict[str, FloatArray]:
    """Give what the columns show, by stretch; arrays of shape (r, n), NaN where there is nothing.

    As in `scene`: with stamps, the length error comes apart from the time error, and the stamps
    of the PLC lie on their grid.
    """
    contact = expected_contact(nominal, touches)
    speed_um_us = contact.speed_mm_s * UM_US_PER_MM_S
    begin_us = outcomes.edge_us if "edge_us" in columns else contact.time_us
    seen = {MISSED: 1.0 - outcomes.ok}
    if "edge_us" in columns:
        seen["edge"] = outcomes.edge_us - contact.time_us
    from_us, deviation_um = begin_us, outcomes.deviation_um
    if "latch_us" in columns:
        wait_us = outcomes.latch_us - begin_us
        seen["latch"] = wait_us
        seen["grid"] = _off_the_grid(nominal, touches, outcomes.latch_us)
        from_us, deviation_um = outcomes.latch_us, deviation_um - speed_um_us * wait_us
    if "report_us" in columns:
        seen["report"] = outcomes.report_us - from_us
    if "deviation_um" in columns:
        seen["position"] = deviation_um
    return {name: np.where(outcomes.ok | (name == MISSED), x, np.nan) for name, x in seen.items()}


def _off_the_grid(nominal: Nominal, touches: Touches, latch_us: FloatArray) -> FloatArray:
    """PLC stamps less the grid of scans, whose phase each replicate's own stamps tell."""
    stamps = np.where(touches.path == InputPath.PLC, latch_us, np.nan)
    return off_grid(stamps, nominal.plc.scan_us)
