"""What of a touch is compared: the stages of the chain as far as they were recorded."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.motion import Contact

ARCSEC_PER_DEG, UM_PER_MM, US_PER_MIN = 3600.0, 1e3, 60e6


class Recorded(Protocol):
    """What touches and simulated outcomes have in common; arrays of shape (…, n)."""

    @property
    def edge_us(self) -> FloatArray:
        """Edge at the connector, seen by the reference instrument."""

    @property
    def latch_us(self) -> FloatArray:
        """Time stamp of the latch."""

    @property
    def report_us(self) -> FloatArray:
        """Arrival of the report."""

    @property
    def deviation_um(self) -> FloatArray:
        """Latched minus nominal position."""

    @property
    def start_delay_us(self) -> FloatArray:
        """By which the move began later than conditions say."""


@dataclass(frozen=True, slots=True)
class Observable:
    """A quantity of each touch.

    Attributes:
        name: Its name in JSON and in file names.
        title: Its name for people.
        unit: Its unit.
        is_rotary: Whether it is of touches by a rotary axis, whose degrees stand for millimetres.
        values: Computes it, shape (…, n), from what was recorded and the expected contact; NaN
            where something for it was not recorded.
    """

    name: str
    title: str
    unit: str
    values: Callable[[Recorded, Contact], FloatArray]
    is_rotary: bool = False

    @property
    def way_unit(self) -> str:
        """Unit of what the axis moves."""
        return "arcsec" if self.is_rotary else "µm"

    @property
    def feed_unit(self) -> str:
        """Unit of its feed."""
        return "deg/min" if self.is_rotary else "mm/min"

    @property
    def other_unit(self) -> str:
        """Unit of a time in terms of the way, or the other way round."""
        return self.way_unit if self.unit == "µs" else "µs"

    @property
    def units_per_us(self) -> float:
        """What an axis moves in a µs at a feed of 1."""
        return (ARCSEC_PER_DEG if self.is_rotary else UM_PER_MM) / US_PER_MIN


def _latch_after_contact(recorded: Recorded, contact: Contact) -> FloatArray:
    """Where an edge was recorded, that is the better start."""
    contact_us = contact.time_us + recorded.start_delay_us
    return np.where(np.isnan(recorded.edge_us), recorded.latch_us - contact_us, np.nan)


OBSERVABLES = (
    Observable("deviation_um", "deviation", "µm", lambda r, _: r.deviation_um),
    Observable("latch_after_edge_us", "latch − edge", "µs", lambda r, _: r.latch_us - r.edge_us),
    Observable("latch_after_contact_us", "latch − expected contact", "µs", _latch_after_contact),
    Observable(
        "report_after_latch_us", "report − latch", "µs", lambda r, _: r.report_us - r.latch_us
    ),
)

_ANGLE = Observable(
    "deviation_arcsec",
    "deviation of rotary axes",
    "arcsec",
    lambda r, _: r.deviation_um * (ARCSEC_PER_DEG / UM_PER_MM),
    is_rotary=True,
)
ROTARY_OBSERVABLES = (
    _ANGLE,
    *(
        replace(o, name=f"rotary_{o.name}", title=f"{o.title} of rotary axes", is_rotary=True)
        for o in OBSERVABLES[1:]
    ),
)
ALL_OBSERVABLES = (*OBSERVABLES, *ROTARY_OBSERVABLES)
OF_LINEAR_AXES = {
    turned.name: plain.name for turned, plain in zip(ROTARY_OBSERVABLES, OBSERVABLES, strict=True)
}
"""What an observable of rotary axes is called of linear ones."""
