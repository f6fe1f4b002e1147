"""Parameters of several effects at once, by least squares on what touches are off by.

Effects that go with each other, as a drift with the temperature and a backlash where it was never
cold, share a long and narrow ridge, along which a climb gets nowhere. Their shifts are nearly
linear in most parameters, so that Gauss and Newton's steps get there at once.
"""

import numpy as np

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.fit import Target
from skiplatch.diagnosis.likelihood.laws import LATTICE, law_under
from skiplatch.diagnosis.scene.scene import Scene

STEPS = 4
SHORTER = (1.0, 0.25)
"""Shares of a step that are tried."""
DIFFERENCE = 1e-3
"""Share of a parameter by which it is moved to see what it shifts."""
MOST_CURVED = 2.0
"""Nats a touch that a standard deviation off costs at most, of a smooth parameter."""
MOST_MOVED = 10.0
"""Times a parameter by which it may move for touches to be a standard deviation off."""
TINY = 1e-300
CALM = 3.0
"""Standard deviations beyond which a touch pulls no harder (Huber)."""


def by_least_squares(scene: Scene, target: Target, start: FloatArray) -> FloatArray:
    """Step from parameters, shape (p,), as long as that makes touches likelier; 0 stays 0."""
    best = start
    for _ in range(STEPS):
        step = _step(scene, target, best)
        tried = [best + share * step for share in SHORTER]
        better = min(tried, key=lambda values: target(values, 0.0))
        if not target(better, 0.0) < target(best, 0.0):
            break
        best = better
    return best


def _step(scene: Scene, target: Target, values: FloatArray) -> FloatArray:
    """Give what parameters are off by, shape (p,), as far as shifts tell."""
    free = np.flatnonzero(values)
    slopes, off = _linearised(scene, target, values, free)
    a_deviation = np.sqrt(len(off)) / np.maximum(np.linalg.norm(slopes, axis=0), TINY)
    told = np.flatnonzero(a_deviation < MOST_MOVED * np.abs(values[free]))
    smooth = [i for i in told if _is_smooth(target, values, free[i], a_deviation[i], len(off))]
    found, *_ = np.linalg.lstsq(slopes[:, smooth], off, rcond=None)
    step = np.zeros_like(values)
    step[free[smooth]] = found
    return step


def _linearised(
    scene: Scene, target: Target, values: FloatArray, free: IndexArray
) -> tuple[FloatArray, FloatArray]:
    """Give by how much parameters shift touches, shape (m, f), and what these are off by, (m,).

    In standard deviations, without what an unknown datum takes up.
    """
    steps = DIFFERENCE * values[free]
    models = [target.fit(_moved(values, *move)) for move in zip(free, steps, strict=True)]
    slopes, off = [np.zeros((0, len(free)))], [np.zeros(0)]
    here = target.fit(values)
    for name in sorted((here.reached & scene.streams.keys()) - {LATTICE}):
        stream = scene.streams[name]
        law, *others = (law_under(scene, stream, one.change(scene)) for one in (here, *models))
        weights = _weights(stream, law)[:, None]
        shifts = np.transpose([(other.mean - law.mean)[stream.rows] for other in others]) / steps
        surfaces = weights * _surfaces(scene, stream)
        slopes.append(_beyond(surfaces, weights * shifts))
        off.append(_beyond(surfaces, weights[:, 0] * (stream.residuals - law.mean)[stream.rows]))
    return np.vstack(slopes), np.concatenate(off)


def _is_smooth(target: Target, values: FloatArray, index: int, step: float, touches: int) -> bool:
    """Tell whether touches count for a parameter by their shifts alone, about a step from it.

    That costs half a nat for each that is a standard deviation off. Lines that they lie on, as of a
    tick, are lost for much less.
    """
    ahead, back = (target(_moved(values, index, step), 0.0) for step in (step, -step))
    return 0.5 * (ahead + back) - target(values, 0.0) < MOST_CURVED * touches


def _moved(values: FloatArray, index: int, step: float) -> FloatArray:
    moved = values.copy()
    moved[index] += step
    return moved


def _weights(stream: Stream, law: Law) -> FloatArray:
    """Weigh the touches of a stream, shape (m,): those far off, as scatter goes, pull no harder."""
    off, spread = np.abs(stream.residuals - law.mean)[stream.rows], law.spread[stream.rows]
    far = CALM * np.maximum(spread, np.median(off) if len(off) else 0.0)
    return np.asarray(1.0 / spread / np.sqrt(np.maximum(off / far, 1.0)))


def _surfaces(scene: Scene, stream: Stream) -> FloatArray:
    """Give by how much each unknown datum shifts touches; shape (m, d)."""
    if scene.datum_groups is None:
        return np.zeros((int(stream.rows.sum()), 0))
    groups = scene.datum_of(stream)
    is_of = groups[:, None] == np.unique(groups)
    return np.asarray(is_of * scene.per_datum_um(stream)[stream.rows, None])


def _beyond(surfaces: FloatArray, values: FloatArray) -> FloatArray:
    """Give what surfaces, shape (m, d), leave of values, shape (m, …), by least squares."""
    found, *_ = np.linalg.lstsq(surfaces, values, rcond=None)
    return np.asarray(values - surfaces @ found)
