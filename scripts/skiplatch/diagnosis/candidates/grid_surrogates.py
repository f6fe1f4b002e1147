"""What is coarser than believed: the ticks of a clock, the steps of a position."""

import numpy as np

from skiplatch.diagnosis.candidates.surrogates import HALF_WAY, Parameters, as_share
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.units import UM_PER_MM


def coarse_ticks(scene: Scene, p: Parameters) -> Change:
    """The stamps have coarser ticks."""
    if scene.nominal.arrival_us is not None:
        return _positions_of_ticks(scene, p)
    # Of two clocks that share no grid, both round down, one after the other.
    again = 0.5 * scene.nominal.skip.tick_us if p[1] else 0.0
    later = p[1] + 0.5 * abs(p[0]) * as_share(p[2]) - again
    with_it_us = np.where(scene.plc, 0.0, later)  # the position of the stamp
    return Change(coarse_us=abs(p[0]), stamp_us=later, position_us=with_it_us, tick_line_us=p[1])


def _positions_of_ticks(scene: Scene, p: Parameters) -> Change:
    """Give what coarse ticks do where no stamp of theirs was recorded."""
    width_us = np.where(scene.plc, 0.0, abs(p[0]))
    later_us = np.where(scene.plc, 0.0, p[1]) - width_us * (1.0 - as_share(p[2]) / 2.0)
    return Change(position_us=later_us, position_box_us=width_us)


def coarse_positions(scene: Scene, p: Parameters) -> Change:
    """The positions have coarser steps, of the distance or of the axis coordinate."""
    step_um = abs(p[0])
    if p[1] <= HALF_WAY:
        return Change(coarse_um=step_um)
    if not p[2]:
        return NOTHING  # steps that nobody sees are scatter, and any scatter would do
    line_um = scene.sign * (p[2] * step_um - scene.touches.position_mm * UM_PER_MM)
    return Change(coarse_um=step_um, line_um=line_um)
