"""Whether a campaign can show an effect at all."""

from collections.abc import Callable

import numpy as np

from skiplatch.arrays import is_varied
from skiplatch.diagnosis.scene.nominal_chain import FALLEN, LOBES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects
from skiplatch.units import DEG_PER_TURN

MICROSECONDS, POSITION = "µs", "position"
FEWEST_AZIMUTHS = 4
"""Directions, to a degree, that show lobes beside a datum for each axis: both senses of two."""


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
    """Tell whether there are lobes to be seen.

    The two senses of two axes show no three of anything in a turn: there they are told from
    backlash by stamps, or by how they fall with the elevation, or not at all. Directions that
    nobody recorded show none.
    """
    sides = scene.is_sideways
    azimuths = np.unique(np.round(scene.touches.alpha_deg[sides]))
    is_seen = scene.is_machine and "alpha_deg" not in scene.stood_in
    return is_seen and len(azimuths) >= FEWEST_AZIMUTHS


def shows_elevations(scene: Scene) -> bool:
    """Tell whether lobes may be seen to fall with the elevation."""
    there = scene.cos_beta[scene.is_sideways]
    return bool(len(there) and np.ptp(there) > FALLEN)


def shows_orders(times: float) -> Callable[[Scene], bool]:
    """Tell whether azimuths show so many times three lobes, and take them for no others."""
    period_deg = DEG_PER_TURN / LOBES / times
    return lambda scene: (scene.whole or scene).shortest_lobe_deg <= period_deg
