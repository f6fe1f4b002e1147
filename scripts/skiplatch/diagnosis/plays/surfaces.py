"""Where surfaces are, and what coordinates read, as touches tell it: the datum of a rig."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Nominal, Touches
from skiplatch.campaign.datum_names import datum_names, datum_senses
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import BY_COORDINATES, BY_STAMPS, WITHOUT_STAMPS
from skiplatch.diagnosis.likelihood.likelihood import fitted_datum_um
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.units import UM_PER_MM

SHORTEST_MM = 1e-3
"""Way to the surface that is left to a touch whose surface is nearer than it was made from."""


@dataclass(frozen=True, slots=True)
class FittedDatum:
    """How far the surface is from where it is believed to be, by the name of the datum.

    Attributes:
        surface_um: By which the surface is met later.
        coordinate_um: By which all deviations read high besides.
    """

    surface_um: Mapping[str, float] = field(default_factory=dict)
    coordinate_um: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene, change: Change) -> "FittedDatum":
        """Fit it to a scene under a change of the physics."""
        if scene.datum_names is None:
            return cls()
        names = np.unique(scene.datum_names).tolist()
        found = fitted_datum_um(scene, change)

        def by_name(family: tuple[str, ...]) -> dict[str, float]:
            values = found.get(family)
            return {} if values is None else dict(zip(names, values.tolist(), strict=True))

        coordinate_um = by_name(BY_COORDINATES)
        if BY_STAMPS in found:
            return cls(by_name(BY_STAMPS), coordinate_um)
        both_um = by_name(WITHOUT_STAMPS)
        if not coordinate_um:
            return cls({}, both_um)
        return cls({name: um - coordinate_um[name] for name, um in both_um.items()}, coordinate_um)

    def beyond(self, surface: "FittedDatum") -> "FittedDatum":
        """Give it with a surface whose place it was fitted beside, without any of its own."""
        rest = {
            name: um - surface.surface_um.get(name, 0.0) for name, um in self.coordinate_um.items()
        }
        return FittedDatum(surface.surface_um, rest) if surface.surface_um else self

    def sizes_um(self, nominal: Nominal, touches: Touches) -> tuple[FloatArray, FloatArray]:
        """Give both for touches, along their approach; shape (n,) each."""
        names = datum_names(nominal, touches)
        if names is None:
            return np.zeros(len(touches)), np.zeros(len(touches))
        senses = datum_senses(nominal, touches)
        surface, coordinate = (
            senses * np.array([known.get(name, 0.0) for name in names.tolist()], dtype=float)
            for known in (self.surface_um, self.coordinate_um)
        )
        return surface, coordinate


def within_reach(touches: Touches, surface_um: FloatArray) -> FloatArray:
    """Give by how much surfaces lie farther, none nearer than the axis sets out; shape (n,)."""
    return np.maximum(surface_um, (SHORTEST_MM - touches.approach_mm) * UM_PER_MM)


def met_at(touches: Touches, surface_um: FloatArray) -> Touches:
    """Give n touches with the way that the axis goes to surfaces that lie so much farther."""
    farther_mm = within_reach(touches, surface_um) / UM_PER_MM
    return replace(touches, approach_mm=touches.approach_mm + farther_mm)
