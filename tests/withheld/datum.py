"""A surface that is not where it is believed to be: no effect, as nobody knew its place."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from skiplatch.campaign import DatumFreedom
from tests.withheld.chain import FloatArray, Setup, State, Step, meet
from tests.withheld.conditions import log_uniform
from tests.withheld.forms import Form, adds

SIZES_UM = (1.0, 150.0)


KINDS = (DatumFreedom.CAMPAIGN, DatumFreedom.AXIS, DatumFreedom.AXIS_SENSE)


@dataclass(frozen=True, eq=False)
class Datum:
    """An offset of all deviations.

    Attributes:
        free: What has one of its own.
        moves_contact: The surface itself lies elsewhere, so that it is met later too; else its
            coordinate is wrong, and the times are right.
        offset_um: Along the approach, shape (n,).
    """

    free: DatumFreedom
    moves_contact: bool
    offset_um: FloatArray

    @property
    def form(self) -> Form:
        """Play it."""
        hooks = {Step.POSITION: adds("deviation_um", lambda _: self.offset_um)}
        if self.moves_contact:
            hooks[Step.MOVE] = self._meet_elsewhere
        values = ", ".join(f"{value:+.4g}" for value in np.unique(self.offset_um))
        return Form(f"surface off by {values} µm, of each {self.free}", hooks)

    def _meet_elsewhere(self, s: State) -> None:
        """Later or sooner, and with another speed where the axis still accelerates."""
        meet(s, s.touches.approach_mm * 1e3 + self.offset_um)

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types, for the label."""
        values = sorted({round(float(value), 3) for value in self.offset_um})
        return {"free": self.free, "moves_contact": self.moves_contact, "offsets_um": values}


def draw_datum(rng: np.random.Generator, setup: Setup) -> Datum:
    """Draw an offset of one of the kinds; of an axis and sense each has another one."""
    free = KINDS[int(rng.integers(len(KINDS)))]
    kinds = {
        DatumFreedom.CAMPAIGN: np.zeros(len(setup.touches)),
        DatumFreedom.AXIS: setup.touches.axis.astype(float),
        DatumFreedom.AXIS_SENSE: 10.0 * setup.touches.axis + setup.touches.sign,
    }
    numbers, which = np.unique(kinds[free], return_inverse=True)
    sizes = np.array([log_uniform(rng, *SIZES_UM) for _ in numbers])
    offsets = np.round(sizes * rng.choice([-1.0, 1.0], len(numbers)), 3)
    return Datum(free, bool(rng.random() < 0.5), offsets[which])
