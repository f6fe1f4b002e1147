"""Whether a campaign can show an effect at all."""

from collections.abc import Callable

import numpy as np

from skiplatch.arrays import is_varied
from skiplatch.diagnosis.scene.nominal_chain import FALLEN, LOBES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects
from skiplatch.units import DEG_PER_TURN

MICROSECONDS, POSITION = "µs", "position"
FEWEST_AZIMUTHS = 7
"""Directions, to a degree, that show three lobes in a turn: two each and one more (Nyquist)."""
FEWEST_TOLD_APART = 4
"""The same where something else tells them from backlash: both senses of two axes."""


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


def shows_waves(scene: Scene) -> bool:
    """Tell whether there are positions enough to tell a wave along the axis."""
    return bool(np.isfinite(scene.shortest_wave_mm))


def shows_lobes(scene: Scene) -> bool:
    """Tell lobes from backlash: the two senses of two axes show no three of anything in a turn.

    But lobes make a trigger late, and fall with the elevation. Backlash does neither.
    """
    sides = scene.is_sideways
    if not scene.is_machine or not sides.any():
        return False
    is_told_apart = scene.has_stamps.any() or shows_elevations(scene)
    fewest = FEWEST_TOLD_APART if is_told_apart else FEWEST_AZIMUTHS
    return len(np.unique(np.round(scene.touches.alpha_deg[sides]))) >= fewest


def shows_elevations(scene: Scene) -> bool:
    """Tell whether lobes may be seen to fall with the elevation."""
    there = scene.cos_beta[scene.is_sideways]
    return bool(len(there) and np.ptp(there) > FALLEN)


def shows_orders(times: float) -> Callable[[Scene], bool]:
    """Tell whether azimuths show so many times three lobes, and take them for no others."""
    period_deg = DEG_PER_TURN / LOBES / times
    return lambda scene: (scene.whole or scene).shortest_lobe_deg <= period_deg
