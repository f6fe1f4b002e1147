"""Whether a further effect shifts touches in a way that no other form of the others would.

No real effect has just the form that is written down: a scale may be bent, a lag not quite in
proportion. What is off then is a smooth function of the shift itself and of the sense of the
motion, and a further effect that happens to go with it would be named for it. So the discrepancy of
a model is such a function, and no scatter alone (Kennedy and O'Hagan, Journal of the Royal
Statistical Society B 63 (2001) 425), and what it takes up as well is no effect of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import SMALLEST
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.scene.scene import Scene

POWERS = (1, 2, 3)
"""Of the shift, and of the shift times the sense, that another form may have."""


@dataclass(frozen=True, slots=True)
class OwnWay:
    """What a shift gains in nats, by least squares.

    Attributes:
        as_formed: Beside the others as they are fitted.
        beyond_form: Beside the others in any smooth form.
    """

    as_formed: float
    beyond_form: float

    @property
    def taken_by_form(self) -> float:
        """What another form of the others would gain as well."""
        return self.as_formed - self.beyond_form


def own_way(scene: Scene, last: Change, others: Change) -> OwnWay:
    """Weigh the shift of a change against smooth forms of other ones, in all streams."""
    gains = [_gains(scene, stream, last, others) for stream in scene.streams.values()]
    as_formed, beyond_form = np.sum(gains, axis=0)
    return OwnWay(float(as_formed), float(beyond_form))


def _gains(scene: Scene, stream: Stream, last: Change, others: Change) -> tuple[float, float]:
    rows = stream.rows
    before = law_under(scene, stream, others)
    after = law_under(scene, stream, others.joined(last))
    shift, form = (after.mean - before.mean)[rows], (before.mean - stream.law.mean)[rows]
    if np.max(np.abs(shift), initial=0.0) < SMALLEST:
        return 0.0, 0.0
    off = (stream.residuals - before.mean)[rows]
    weights = 1.0 / np.sqrt(after.variance[rows])
    datum = scene.datum_of(stream)
    surfaces = [(datum == group).astype(float) for group in np.unique(datum)]
    bent = [*surfaces, *_smooth(form, scene.sign[rows])]
    as_formed, beyond_form = (
        0.5 * (_squares(off, columns, weights) - _squares(off, [*columns, shift], weights))
        for columns in (surfaces, bent)
    )
    return as_formed, beyond_form


def _smooth(form: FloatArray, sense: FloatArray) -> list[FloatArray]:
    """Give what smooth forms of a shift, shape (m,), are made of; nothing of none."""
    most = np.max(np.abs(form))
    if most < SMALLEST:
        return []
    powers = [(form / most) ** power for power in POWERS]
    return [*powers, *(sense * power for power in powers)]


def _squares(values: FloatArray, columns: Sequence[FloatArray], weights: FloatArray) -> float:
    """Give the weighted sum of squares that columns, shape (m,) each, leave of values."""
    matrix = np.column_stack(columns) * weights[:, None]
    weighted = values * weights
    fitted, *_ = np.linalg.lstsq(matrix, weighted, rcond=None)
    return float(np.sum((weighted - matrix @ fitted) ** 2))
