"""Whether effects gain beside something slow that nobody recorded.

What wanders by itself goes with anything else that changes slowly, and touches that follow each
other say nearly the same of it: so many are no evidence (spurious regression: Granger and Newbold,
Journal of Econometrics 2 (1974) 111). An effect is more than such a resemblance if it gains beside
a Gaussian process as well, which may do whatever is slow, and is as large as it is likeliest to be.
"""

from collections.abc import Iterable, Iterator, Mapping

import numpy as np
import scipy

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.least_squares import surfaces_of, weights_of
from skiplatch.diagnosis.likelihood.laws import LATTICE, law_under
from skiplatch.diagnosis.scene.scene import Scene

SLOWNESS = (3.0, 1.0 / 3.0, 1.0 / 10.0, 1.0 / 30.0)
"""Times after which it has forgotten where it was, over that of the campaign."""
SIZES = np.append(0.0, np.geomspace(0.01, 1000.0, 26))
"""Its variance, over that of the scatter."""
SMALL = 0.1
"""Standard deviations that an effect has to shift touches by to be seen."""
TINY = 1e-9
MOST = 500
"""Touches of a stream that are looked at: those that follow each other closely say the same."""


def beyond_wandering(scene: Scene, fit: Fit) -> Mapping[str, float]:
    """Give the nats that effects gain beside something slow, by id.

    Of those whose shift is more than a level of all touches, or of either sense.
    """
    found: dict[str, float] = {}
    for i, candidate in enumerate(fit.candidates):
        nats = list(_by_stream(scene, fit, i))
        if nats:
            found[candidate.id] = sum(nats)
    return found


def _by_stream(scene: Scene, fit: Fit, number: int) -> Iterator[float]:
    rest, whole = fit.without(number).change(scene), fit.change(scene)
    for name, stream in scene.streams.items():
        if name == LATTICE or not stream.rows.any():
            continue
        before, after = (law_under(scene, stream, change) for change in (rest, whole))
        rows = np.flatnonzero(stream.rows)
        rows = rows[np.unique(np.linspace(0, len(rows) - 1, MOST).astype(np.intp))]
        chosen = np.isin(np.flatnonzero(stream.rows), rows)
        weights = weights_of(stream, after)[chosen]
        levels = np.column_stack([np.ones(len(rows)), scene.sign[rows]])
        sizes = np.column_stack([surfaces_of(scene, stream)[chosen], levels])
        still = scipy.linalg.null_space((weights[:, None] * sizes).T)
        shift = still.T @ (weights * (after.mean - before.mean)[rows])
        if np.sqrt(np.sum(shift**2) / len(rows)) < SMALL:
            continue
        off = still.T @ (weights * (stream.residuals - before.mean)[rows])
        slow = (still.T @ one @ still for one in _wanderings(scene, rows, weights))
        yield _gained(off, shift, slow)


def _wanderings(scene: Scene, rows: IndexArray, weights: FloatArray) -> Iterator[FloatArray]:
    """Give the covariances of what is slow, in standard deviations of touches; shape (m, m) each.

    It wanders with time or from touch to touch, may go with the sense of motion, and each axis may
    have its own.
    """
    axis = scene.touches.axis[rows]
    one_axis = axis[:, None] == axis
    shared = [one_axis] if one_axis.all() else [np.ones_like(one_axis), one_axis]
    signs = scene.sign[rows]
    forms = [a * b for a in (1.0, signs[:, None] * signs) for b in shared]
    for clock in (scene.touches.time_s[rows], np.arange(len(rows), dtype=float)):
        apart = np.abs(clock[:, None] - clock) / max(float(np.ptp(clock)), TINY)
        for slowness in SLOWNESS:
            wandered = np.exp(-apart / slowness) * weights[:, None] * weights
            yield from (wandered * form for form in forms)


def _gained(off: FloatArray, shift: FloatArray, covariances: Iterable[FloatArray]) -> float:
    """Give the nats by which touches are likelier with a shift, beside the likeliest wandering.

    The likelihood is that of what levels leave of them (restricted maximum likelihood).
    """
    best = _likeliest(off, shift, np.zeros(len(off)))
    for covariance in covariances:
        size = np.mean(np.diag(covariance))
        if size < TINY:
            continue  # touches at one time are on one level
        values, vectors = scipy.linalg.eigh(covariance / size)
        there, moved = (vectors.T @ one for one in (off, shift))
        best = np.maximum(best, _likeliest(there, moved, np.maximum(values, 0.0)))
    return float(best[1] - best[0])


def _likeliest(off: FloatArray, shift: FloatArray, values: FloatArray) -> FloatArray:
    """Give the most nats without a shift and with it, of all sizes of what wanders; shape (2,)."""
    variances = 1.0 + SIZES[:, None] * values
    own, both, squares = (np.sum(p / variances, axis=1) for p in (off**2, off * shift, shift**2))
    left = np.maximum([own, own - both**2 / squares], TINY)
    nats = -0.5 * (len(off) * np.log(left / len(off)) + np.sum(np.log(variances), axis=1))
    return np.asarray(nats.max(axis=1))
