"""Effects that shift the grid of the scans, fitted while the believed period goes along.

An uncertain period and a clock that is off shift the stamps of scans alike: so each is found only
beside the other, and the effect is told apart from them first.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.belief_fit import beside_grid
from skiplatch.diagnosis.fit.beliefs import SCAN_PERIOD, uncertain
from skiplatch.diagnosis.fit.climb import climb
from skiplatch.diagnosis.fit.fit import Fit, fits_by_form, starts_of
from skiplatch.diagnosis.likelihood.laws import LATTICE
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.scored import PLAIN, gain_of, worth

FIRST_STEP = 0.02
"""Of the climb along the grid, as a share of the parameters."""


def fits_along_grid(scene: Scene, candidates: Iterable[Candidate]) -> Iterator[Fit]:
    """Fit each that gains plainly apart from the grid of the scans, in its best form along it."""
    apart = scene.select(~scene.plc)
    is_uncertain = SCAN_PERIOD in {belief.key for belief in uncertain(scene.nominal)}
    if not is_uncertain or not len(apart) or LATTICE not in scene.streams:
        return
    for one in candidates:
        starts = starts_of(apart, one, NOTHING)
        if not starts or not _shifts_grid(scene, one, starts[0]):
            continue
        forms = [form for form, _ in fits_by_form(apart, [one], starts)]
        told = [form for form in forms if gain_of(apart, form, NOTHING) > PLAIN]
        along = sorted((_along_grid(scene, form) for form in told), key=lambda form: form[1])
        yield from (form for form, _ in along[:1])


def _shifts_grid(scene: Scene, one: Candidate, start: Sequence[float]) -> bool:
    """Tell whether an effect shifts the stamps of scans, each by another time."""
    shift = np.broadcast_to(one.acting(scene, np.array(start)).stamp_us, (len(scene),))
    return bool(np.ptp(shift[scene.plc]) > 0.0)


def _along_grid(scene: Scene, one: Fit) -> tuple[Fit, float]:
    """Fit it, the period each time as the stamps tell it; and give minus the nats beyond chance."""
    (effect,), (begun,) = one.candidates, one.parameters

    def minus(parameters: FloatArray, _widening: float) -> float:
        return -beside_grid(scene, effect.acting(scene, parameters))

    found = climb(minus, begun, widening=0.0, step=FIRST_STEP)
    return replace(one, parameters=(found,)), minus(found, 0.0) + worth(one.size)
