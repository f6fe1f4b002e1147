"""How the place of the surface is unknown: ``[datum]`` of nominal.toml."""

from dataclasses import dataclass
from enum import StrEnum

from skiplatch.campaign.constraints import LENGTH_UM
from skiplatch.campaign.kind import Kind


class DatumFreedom(StrEnum):
    """What shares one unknown place of the surface, with tip radius and constant pretravel."""

    NONE = "none"
    """Nothing: the place is known."""
    CAMPAIGN = "campaign"
    """All touches."""
    AXIS = "axis"
    """The touches of one axis."""
    AXIS_SENSE = "axis_sense"
    """The touches of one axis in one sense."""
    SESSION = "session"
    """The touches of one axis in one session."""
    ZERO = "zero"
    """The positions of one axis: an instrument with a zero of its own read them, at rest. What it
    reads high is far in the positive sense and near in the negative."""


@dataclass(frozen=True, slots=True)
class Datum:
    """How the place of the surface is unknown.

    Attributes:
        free: What shares one unknown place.
        u_um: Its standard uncertainty; None where it is wholly unknown.
    """

    free: DatumFreedom
    u_um: float | None = None

    def __post_init__(self) -> None:
        if self.u_um is not None and not 0.0 <= self.u_um <= LENGTH_UM.high:
            raise ValueError(f"datum.u_um: expected a number >= 0, got {self.u_um}")

    @property
    def is_at_rest(self) -> bool:
        """An instrument read where an axis stands: there was no touch, and no time to err by."""
        return self.free is DatumFreedom.ZERO

    @classmethod
    def of_kind(cls, kind: Kind) -> "Datum":
        """Give what is believed where nothing is said of it."""
        return cls(DatumFreedom.AXIS if kind is Kind.MACHINE else DatumFreedom.NONE)
