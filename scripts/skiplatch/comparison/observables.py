"""What of a touch is compared: the stages of the chain as far as they were recorded."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.motion import Contact


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


@dataclass(frozen=True, slots=True)
class Observable:
    """A quantity of each touch.

    Attributes:
        name: Its name in JSON and in file names.
        title: Its name for people.
        unit: Its unit.
        values: Computes it, shape (…, n), from what was recorded and the expected contact; NaN
            where something for it was not recorded.
    """

    name: str
    title: str
    unit: str
    values: Callable[[Recorded, Contact], FloatArray]


def _latch_after_contact(recorded: Recorded, contact: Contact) -> FloatArray:
    """Where an edge was recorded, that is the better start."""
    return np.where(np.isnan(recorded.edge_us), recorded.latch_us - contact.time_us, np.nan)


OBSERVABLES = (
    Observable("deviation_um", "deviation", "µm", lambda r, _: r.deviation_um),
    Observable("latch_after_edge_us", "latch − edge", "µs", lambda r, _: r.latch_us - r.edge_us),
    Observable("latch_after_contact_us", "latch − expected contact", "µs", _latch_after_contact),
    Observable(
        "report_after_latch_us", "report − latch", "µs", lambda r, _: r.report_us - r.latch_us
    ),
)
