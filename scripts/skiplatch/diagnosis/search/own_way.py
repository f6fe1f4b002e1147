"""Whether a further effect shifts touches in a way that no other form of the others would.

No real effect has just the form that is written down: a scale may be bent, a lag not quite in
proportion. What is off then is a smooth function of the shift itself and of the sense of the
motion, and a further effect that happens to go with it would be named for it. So the discrepancy of
a model is such a function, and no scatter alone (Kennedy and O'Hagan, Journal of the Royal
Statistical Society B 63 (2001) 425), and what it takes up as well is no effect of its own. A form
is off by a share of the shift: what had to be off by more than that is no form of the effect.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import SHIFTED
from skiplatch.diagnosis.density.law import SMALLEST
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.likelihood.likelihood import (
    fitted_datum_um,
    likelihood,
    shifted_by_datum,
)
from skiplatch.diagnosis.scene.scene import Scene

POWERS = (1, 2, 3)
"""Of the shift, and of the shift times the sense, that another form may have."""
REACH = 6.0
"""Standard deviations of scatter, beyond its whole shift, that an effect reaches in any form."""


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
    surfaces, bent = _surfaces(scene, stream), _smooth(form, scene.sign[rows])
    as_formed, beyond_form = (
        0.5
        * (
            _squares(off, surfaces, weights, forms)
            - _squares(off, [*surfaces, shift], weights, forms)
        )
        for forms in ([], bent)
    )
    return as_formed, beyond_form


def gain_beyond_reach(scene: Scene, change: Change, others: Change) -> float:
    """Give the nats that a change gains over others at touches that no form of theirs comes near.

    A form is off by no more than the effect shifts touches: what lies far beyond that and the
    scatter is of another kind, however little of the campaign it is.
    """
    with_it, without = (likelihood(scene, one).streams for one in (change, others))
    data = fitted_datum_um(scene, others)
    return float(
        sum(
            (with_it[name] - without[name])[stream.rows][
                _beyond_reach(scene, stream, others, data)
            ].sum()
            for name, stream in scene.streams.items()
        )
    )


def _beyond_reach(
    scene: Scene, stream: Stream, others: Change, data: Mapping[tuple[str, ...], FloatArray]
) -> BoolArray:
    """Tell which touches of a stream's rows no form of some effects reaches; shape (m,)."""
    law = law_under(scene, stream, others)
    off = (stream.residuals - law.mean)[stream.rows] - shifted_by_datum(scene, stream, data)
    reach = np.abs(law.mean - stream.law.mean) + REACH * np.sqrt(law.variance)
    return np.asarray(np.abs(off) > reach[stream.rows])


def by_giving_way(scene: Scene, last: Change, others: Change) -> float:
    """Give the nats that a change may gain yet if other ones change in size along with it.

    Two effects that go with each other, as a scale and a backlash on one side of the zero, each do
    much of what the other one does, which then seems to be worth little on top of it.
    """
    return float(sum(_given_way(scene, s, last, others) for s in scene.streams.values()))


def _given_way(scene: Scene, stream: Stream, last: Change, others: Change) -> float:
    rows = stream.rows
    before = law_under(scene, stream, others)
    after = law_under(scene, stream, others.joined(last))
    shift, form = (after.mean - before.mean)[rows], (before.mean - stream.law.mean)[rows]
    if min(np.max(np.abs(sizes), initial=0.0) for sizes in (shift, form)) < SMALLEST:
        return 0.0
    weights = 1.0 / np.sqrt(after.variance[rows])
    surfaces = _surfaces(scene, stream)
    off = (stream.residuals - after.mean)[rows]
    stiff, free = (_squares(off, [*surfaces, *sizes], weights) for sizes in ([], [form, shift]))
    # Scatter is as large as what is left: far off, the law of the chain says nothing of it.
    more = len(off) - len(surfaces) - len((form, shift))
    return 0.5 * more * float(np.log(stiff / free)) if more > 0 and free > 0.0 else 0.0


def _surfaces(scene: Scene, stream: Stream) -> list[FloatArray]:
    """Give which way each datum moves the touches, 0 for those of others; shape (m,) each.

    None where the data are known, or move nothing.
    """
    if scene.datum_groups is None or stream.name not in SHIFTED:
        return []
    datum, senses = scene.datum_of(stream), scene.datum_senses[stream.rows]
    return [(datum == group) * senses for group in np.unique(datum)]


def _smooth(form: FloatArray, sense: FloatArray) -> list[FloatArray]:
    """Give what smooth forms of a shift, shape (m,), are made of, each as large as it is."""
    most = np.max(np.abs(form))
    if most < SMALLEST:
        return []
    powers = [most * (form / most) ** power for power in POWERS]
    return [*powers, *(sense * power for power in powers)]


def _squares(
    values: FloatArray,
    columns: Sequence[FloatArray],
    weights: FloatArray,
    forms: Sequence[FloatArray] = (),
) -> float:
    """Give the weighted sum of squares that columns, shape (m,) each, leave of values.

    Args:
        values: Shape (m,).
        columns: May count to any amount.
        weights: Of the values; shape (m,).
        forms: Columns that count to about ±1 (ridge regression: a normal prior).
    """
    matrix = np.reshape([*columns, *forms], (-1, len(values))).T * weights[:, None]
    prior = np.eye(matrix.shape[1])[len(columns) :]
    told, weighted = np.vstack([matrix, prior]), np.append(values * weights, np.zeros(len(prior)))
    fitted, *_ = np.linalg.lstsq(told, weighted, rcond=None)
    return float(np.sum((weighted - told @ fitted) ** 2))
