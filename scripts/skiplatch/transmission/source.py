"""Which part of a drive a periodic error of an axis comes from."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.simulator.effects import Effect
from skiplatch.tables import compact, number
from skiplatch.transmission.train import GearTrain, read_train

EFFECT = "transmission_error"


@dataclass(frozen=True, slots=True)
class Source:
    """One sine of an error along an axis, and the part it belongs to, if there is one."""

    order: float
    """Periods in a turn of the screw."""
    period_mm: float
    amplitude_um: float
    part: str | None

    @property
    def text(self) -> str:
        """Say it in a line."""
        whose = self.part or "no part of the train"
        return (
            f"{EFFECT}: {number(self.amplitude_um, 3)} µm with a period of "
            f"{compact(self.period_mm)} mm are order {compact(self.order)} of the screw: {whose}"
        )


def read_axis_train(path: Path) -> GearTrain:
    """Read the description of a train that ends in a screw.

    Raises:
        InputError: It is wrong, or has no screw.
    """
    train = read_train(path)
    if train.lead_mm is None:
        raise InputError(path, None, None, "expected [screw] lead_mm: orders are those of a screw")
    return train


def periodic_sources(found: Sequence[Effect], train: GearTrain | None) -> list[Source]:
    """Name the parts behind the transmission errors among the effects that were found."""
    if train is None:
        return []
    errors = [effect.parameters for effect in found if effect.id == EFFECT]
    sines = [
        (p[f"amplitude{suffix}_um"], p["period_mm"] / harmonic)
        for p in errors
        for harmonic, suffix in ((1, ""), (2, "2"))
        if p[f"amplitude{suffix}_um"] > 0.0
    ]
    return [_source(train, amplitude, period) for amplitude, period in sines]


def _source(train: GearTrain, amplitude_um: float, period_mm: float) -> Source:
    order, part = train.of_period(period_mm)
    return Source(order, period_mm, amplitude_um, part)
