"""An effect as it can be fitted: what it changes, and where a search for it begins."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Nominal
from skiplatch.diagnosis.candidates.applicable import shows_elevations, shows_orders, varies
from skiplatch.diagnosis.candidates.first_axis import first_of_its_own
from skiplatch.diagnosis.candidates.positions import surfaces_show
from skiplatch.diagnosis.candidates.starts import Starts
from skiplatch.diagnosis.candidates.surrogates import Parameters
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects
from skiplatch.span import ALWAYS, Span

Refinement = Mapping[int, float | Callable[[Parameters], float]]
"""First values of parameters, by number: of those at 0 a number, of any what one makes of all."""

LEEWAY = 0.05
"""Of the scatter of a delay, by which a fit may miss its least."""

NO_SIZES = ("deg", "1")
"""Units of angles, shares and switches."""
TOLD_BY: Mapping[str, Callable[[Scene], bool]] = {
    "expansion_ppm_k": varies("position_mm"),
    "second_um": shows_orders(2.0),
    "third_um": shows_orders(3.0),
    "elevation_power": shows_elevations,
    "moves_surface": surfaces_show,
}
"""Whether touches show enough for a parameter to be told from another one."""


@cache
def _ranges_of(effect_id: str) -> tuple[FloatArray, FloatArray]:
    """Give the least and the largest of each parameter, shape (p,); of angles and shares any is.

    Those go round, or end where the physics has them end. Below 0 a size is the same one turned.
    """
    parameters = effects()[effect_id].parameters
    is_size = np.array([p.unit not in NO_SIZES for p in parameters], dtype=bool)
    low = np.array([p.low if p.low < 0.0 else -p.high for p in parameters])
    high = np.array([p.high for p in parameters])
    return np.where(is_size, low, -np.inf), np.where(is_size, high, np.inf)


@cache
def _names_of(effect_id: str) -> tuple[str, ...]:
    return tuple(parameter.name for parameter in effects()[effect_id].parameters)


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect as a surrogate.

    Attributes:
        id: As in the table of effects.
        change: What parameters, shape (p,), make of the physics.
        starts: Parameters to start a search from, given what is known to differ already. What is
            0 in a start stays 0.
        applies: Whether a campaign can show the effect at all.
    """

    id: str
    change: Callable[[Scene, Parameters], Change]
    starts: Starts
    applies: Callable[[Scene], bool] = lambda _: True
    refinements: tuple[Refinement, ...] = ()
    """What makes other forms of the effect."""
    believed_us: Callable[[Nominal], float] | None = None
    """Of a delay, the first parameter of which adds to it: what it is believed to take already."""
    like_datum: Callable[[Scene], frozenset[str]] = lambda _: frozenset()
    """Parameters that do to the touches what a datum does that may be anywhere."""
    is_rough: bool = False
    """Its likelihood is, where stamps tell: of grids that may wander each has other neighbours."""
    span: Span = ALWAYS
    """The touches at which it acts."""

    @property
    def names(self) -> tuple[str, ...]:
        """Those of the parameters, as in the table of effects."""
        return _names_of(self.id)

    def acting(self, scene: Scene, parameters: Parameters) -> Change:
        """Give what parameters, shape (p,), make of the physics of the touches at which it acts.

        A size beyond its range is the end of it, as the simulator takes it.
        """
        low, high = _ranges_of(self.id)
        # np.clip takes longer, and searches ask by the ten thousand.
        change = self.change(scene, np.minimum(np.maximum(parameters, low), high))
        return change if self.span == ALWAYS else Change(passing=((self.span, change),))

    def taken_up(self, scene: Scene) -> frozenset[int]:
        """Number the parameters that stay at 0, for the datum, or others, do what they do.

        A datum does so throughout: what begins or ends is none.
        """
        is_free = scene.datum_groups is not None and scene.datum_u_um is None
        is_anywhere = is_free and self.span == ALWAYS
        taken = first_of_its_own(scene.touches) & set(self.names)
        taken |= {n for n in TOLD_BY.keys() & set(self.names) if not TOLD_BY[n](scene)}
        if is_anywhere:
            taken |= self.like_datum(scene)
        return frozenset(map(self.names.index, taken))

    def is_possible(self, scene: Scene, parameters: Parameters) -> bool:
        """Tell whether no size is beyond its range, and nothing comes before its cause."""
        if (np.abs(parameters) > np.abs(_ranges_of(self.id)).max(axis=0)).any():
            return False
        if self.believed_us is None:
            return True
        open_us = scene.nominal.skip.tick_us + LEEWAY * float(np.abs(parameters[1:3]).sum())
        return bool(parameters[0] >= -self.believed_us(scene.nominal) - open_us)
