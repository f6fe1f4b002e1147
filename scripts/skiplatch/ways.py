"""In which units people are told what an axis moves: degrees of A, B and C stand for mm."""

from enum import Enum
from typing import Self

from skiplatch.campaign import Axis, InputPath, Touches
from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM

LENGTH, ARCSEC = "µm", "arcsec"
ARCSEC_PER_UM = ARCSEC_PER_DEG / UM_PER_MM
"""Of a rotary axis: a µm stands for 0.001°."""
IN_DEGREES = {"µm": "mdeg", "mm": "deg", "mm/min": "deg/min", "µm/K": "mdeg/K"}
"""Units in which a number of a linear axis is the same number of a rotary one."""


class Ways(Enum):
    """What the axes of a campaign do."""

    LINEAR = "linear"
    ROTARY = "rotary"
    MIXED = "mixed"

    @classmethod
    def of(cls, touches: Touches) -> Self:
        """Tell it by the touches."""
        if not touches.turns.any():
            return cls(cls.LINEAR)
        return cls(cls.ROTARY if touches.turns.all() else cls.MIXED)

    @classmethod
    def of_paths(cls, touches: Touches) -> dict[str, Self]:
        """Tell it of each input path that has touches, by "skip" and "plc"."""
        rows = {path.name.lower(): touches.path == path for path in InputPath}
        return {name: cls.of(touches.select(here)) for name, here in rows.items() if here.any()}

    @classmethod
    def of_datum(cls, name: str) -> Self | None:
        """Tell it by the name of a datum, if that begins with an axis: ``A-.surface_um``."""
        if name[:1] not in Axis.__members__:
            return None
        return cls(cls.ROTARY if Axis[name[0]] >= Axis.A else cls.LINEAR)

    def told(self, size: float, unit: str) -> tuple[float, str]:
        """Give a size for people; what is no length stays as it is."""
        if unit != LENGTH or self is Ways.LINEAR:
            return size, unit
        if self is Ways.ROTARY:
            return size * ARCSEC_PER_UM, ARCSEC
        return size, self.unit_of_number(unit)

    def unit_of_number(self, unit: str) -> str:
        """Give the unit of a number that stays as it is: that of a parameter, whose name has one.

        Of linear and rotary axes together it may be of either.
        """
        turned = IN_DEGREES.get(unit, unit)
        if self is Ways.LINEAR or turned == unit:
            return unit
        return turned if self is Ways.ROTARY else f"{unit} or {turned}"

    def relabelled(self, words: str) -> str:
        """Give words in which a length is said by a number that stays as it is."""
        return words.replace(f" {LENGTH} ", f" {self.unit_of_number(LENGTH)} ")

    def observable_name(self, observable: str) -> str:
        """Give the name of an observable, which ends in its unit."""
        is_turned = self is Ways.ROTARY and observable.endswith("_um")
        return observable.removesuffix("_um") + "_arcsec" if is_turned else observable
