"""Whether a campaign can show an effect at all."""

from collections.abc import Callable

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects

MICROSECONDS, POSITION = "µs", "position"
FEWEST_AZIMUTHS = 7
"""Directions, to a degree, that show three lobes in a turn: two each and one more (Nyquist)."""
FEWEST_TOLD_APART = 4
"""The same where something else tells them from backlash: both senses of two axes."""
FALLEN = 0.1
"""Share of the lobes by which they have to differ with the elevation."""


def acts(effect_id: str, scene: Scene) -> bool:
    """Tell whether an effect can act: where an axis rests there is no touch and no delay."""
    if not scene.nominal.datum.is_at_rest:
        return True
    effect = effects()[effect_id]
    return effect.stage == POSITION and all(p.unit != MICROSECONDS for p in effect.parameters)


def on_machine(scene: Scene) -> bool:
    """Tell whether a probe touches: edges that are injected come by no probe and no link."""
    return scene.is_machine


def has_clock(scene: Scene) -> bool:
    """Tell whether stamps are those of the latch's clock, if there are any."""
    return scene.nominal.arrival_us is None


def varies(column: str) -> Callable[[Scene], bool]:
    """Tell whether a condition was recorded and varied: else nothing can be seen to go with it."""
    return lambda scene: is_varied(getattr(scene.touches, column))


def is_varied(values: FloatArray) -> bool:
    """Tell whether some values differ; NaN is none."""
    known = values[~np.isnan(values)]
    return bool(len(known) and np.ptp(known) > 0.0)


def shows_waves(scene: Scene) -> bool:
    """Tell whether there are positions enough to tell a wave along the axis."""
    return bool(np.isfinite(scene.shortest_wave_mm))


def shows_lobes(scene: Scene) -> bool:
    """Tell lobes from backlash: the two senses of two axes show no three of anything in a turn.

    But lobes make a trigger late, and fall with the elevation. Backlash does neither.
    """
    touches = scene.touches
    falls = np.cos(np.radians(np.nan_to_num(touches.beta_deg)))
    sides = ~np.isnan(touches.alpha_deg) & (falls > FALLEN)
    if not scene.is_machine or not sides.any():
        return False
    is_told_apart = scene.has_stamps.any() or np.ptp(falls[sides]) > FALLEN
    fewest = FEWEST_TOLD_APART if is_told_apart else FEWEST_AZIMUTHS
    return len(np.unique(np.round(touches.alpha_deg[sides]))) >= fewest
