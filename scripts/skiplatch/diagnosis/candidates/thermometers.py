"""Which of the thermometers of a campaign an effect may follow."""

from collections.abc import Callable, Sequence

import numpy as np

from skiplatch.arrays import is_varied
from skiplatch.diagnosis.candidates.starts import Starts
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.playing import thermometers_c


def shows_warmth(scene: Scene) -> bool:
    """Tell whether some temperature was recorded and varied."""
    return bool(_told_apart(scene))


def by_each_thermometer(starts_of: Callable[[float], Starts]) -> Starts:
    """Propose what follows a thermometer, by its number, for each that shows something else."""

    def starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
        return [one for k in _told_apart(scene) for one in starts_of(float(k))(scene, given)]

    return starts


def _told_apart(scene: Scene) -> list[int]:
    """Number the thermometers that moved, each as no other before it; temp_c is 0."""
    shown = thermometers_c(scene.touches)
    moved: list[int] = []
    for number, temp_c in enumerate(shown):
        is_new = not any(np.array_equal(temp_c, shown[i], equal_nan=True) for i in moved)
        if is_new and is_varied(temp_c):
            moved.append(number)
    return moved
