"""What a gear train is made of, as far as it says which orders belong to which shaft.

A description in TOML lists the stages from the input to the output::

    [[stage]]
    driver_teeth = 1        # starts of a worm
    driven_teeth = 37
    name = "worm and wheel" # optional

    [[stage]]
    driver_teeth = 10
    driven_teeth = 11

    [screw]                 # if the output drives one; its travel is what lines2 counts
    lead_mm = 10.0
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from skiplatch.campaign.column_kinds import LabelColumn
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, quoted

MOST_HARMONIC = 4
MESH = "mesh of "
NEAR = 5e-4
"""An order belongs to a part that is as near as that share of it, or as `NEAR_ABSOLUTE`."""
AXIS_NEAR = 0.02
"""The same of a period along an axis, which touches tell less sharply."""
NEAR_ABSOLUTE = 2e-3
KEYS = {"driver_teeth", "driven_teeth", "name"}
_NAME = LabelColumn(meaning="of a stage")


@dataclass(frozen=True, slots=True)
class Stage:
    """Two gears, or a worm and its wheel."""

    driver_teeth: int
    driven_teeth: int
    name: str


@dataclass(frozen=True, slots=True)
class Part:
    """Something that turns or meshes `order` times in an output turn."""

    order: float
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class GearTrain:
    """Stages from the input to the output, and the screw behind them."""

    stages: Sequence[Stage]
    lead_mm: float | None = None
    path: Path | None = None

    @property
    def ratio(self) -> Fraction:
        """Turns of the input in a turn of the output."""
        ratio = Fraction(1)
        for stage in self.stages:
            ratio *= Fraction(stage.driven_teeth, stage.driver_teeth)
        return ratio

    def refuse_other_ratio(self, ratio: Fraction) -> None:
        """Raise InputError unless the teeth make that ratio."""
        if self.ratio != ratio:
            message = f"the teeth make a ratio of {self.ratio}, --ratio says {ratio}"
            raise InputError(self.path or "train", None, None, message)

    @property
    def parts(self) -> list[Part]:
        """Shafts and meshes, and the screw; the output shaft first."""
        parts, speed, count = [], Fraction(1), len(self.stages)
        turning = "screw" if self.lead_mm is not None else f"shaft {count + 1} (output)"
        parts.append(Part(1.0, turning))
        for number, stage in reversed(list(enumerate(self.stages, 1))):
            parts.append(Part(float(speed * stage.driven_teeth), MESH + stage.name))
            speed *= Fraction(stage.driven_teeth, stage.driver_teeth)
            end = " (input)" if number == 1 else ""
            parts.append(Part(float(speed), f"shaft {number}{end}"))
        return parts

    @property
    def mesh_order(self) -> float | None:
        """Teeth that the last stage passes in an output turn."""
        return float(self.stages[-1].driven_teeth) if self.stages else None

    def of_period(self, period_mm: float) -> tuple[float, str | None]:
        """Give the order of an error along the axis, and the part it belongs to.

        Raises:
            InputError: The description has no screw.
        """
        if self.lead_mm is None:
            message = "an axis needs [screw] lead_mm to have orders"
            raise InputError(self.path or "train", None, None, message)
        order = self.lead_mm / period_mm
        return order, self.named(order, AXIS_NEAR)

    def named(self, order: float, near_share: float = NEAR) -> str | None:
        """Say which parts an order belongs to; None where there is none.

        It may be that of a part, a harmonic, or a mesh and a shaft beside it (a side band).
        """
        near = max(near_share * order, NEAR_ABSOLUTE)
        for harmonic in range(1, MOST_HARMONIC + 1):
            names = [p.name for p in self.parts if abs(order - harmonic * p.order) <= near]
            if names:
                joined = " and ".join(names)
                return joined if harmonic == 1 else f"{joined}, harmonic {harmonic}"
        for mesh, shaft in self._side_bands():
            for sign, word in ((1, "+"), (-1, "−")):
                if abs(order - mesh.order - sign * shaft.order) <= near:
                    return f"{mesh.name} {word} {shaft.name}"
        return None

    def _side_bands(self) -> list[tuple[Part, Part]]:
        meshes = [part for part in self.parts if part.name.startswith(MESH)]
        shafts = [part for part in self.parts if not part.name.startswith(MESH)]
        return [(mesh, shaft) for mesh in meshes for shaft in shafts]


def read_train(path: Path) -> GearTrain:
    """Read a description.

    Raises:
        InputError: It cannot be read, or something in it is wrong.
    """
    table = parse_toml(path, read_toml_text(path))
    stages = table.get("stage", [])
    if not isinstance(stages, list) or set(table) - {"stage", "screw"}:
        raise InputError(path, None, None, "expected the tables [[stage]] and [screw] alone")
    read = [_stage(path, number, stage) for number, stage in enumerate(stages, 1)]
    return GearTrain(read, _lead(path, table.get("screw")), path)


def _stage(path: Path, number: int, table: object) -> Stage:
    if not isinstance(table, Mapping) or set(table) - KEYS:
        raise InputError(path, None, None, f"stage {number}: expected {', '.join(sorted(KEYS))}")
    teeth = [table.get(key) for key in ("driver_teeth", "driven_teeth")]
    for value in teeth:
        if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= 10_000:
            message = f"expected teeth from 1 to 10000, found {quoted(str(value))}"
            raise InputError(path, None, None, f"stage {number}: {message}")
    name = table.get("name", f"stage {number}")
    if not isinstance(name, str) or not name.strip() or not _NAME.admits(np.array([name])).all():
        message = f"stage {number}: expected a name, {_NAME.expected}, found {quoted(str(name))}"
        raise InputError(path, None, None, message)
    return Stage(table["driver_teeth"], table["driven_teeth"], name)


def _lead(path: Path, table: object) -> float | None:
    if table is None:
        return None
    lead = table.get("lead_mm") if isinstance(table, Mapping) else None
    if isinstance(lead, bool) or not isinstance(lead, int | float) or not 0.0 < lead < 1e4:
        raise InputError(path, None, None, "screw: expected lead_mm above 0")
    return float(lead)
