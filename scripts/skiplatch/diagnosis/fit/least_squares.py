"""Several numbers at once, by least squares on what touches are off by.

Effects that go with each other, as a drift with the temperature and a backlash where it was never
cold, share a long and narrow ridge, along which a climb gets nowhere; so do an effect and a belief.
Their shifts are nearly linear in most parameters, so that Gauss and Newton's steps get there at
once.
"""

from collections.abc import Set as AbstractSet
from typing import Protocol

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
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


class Ridge(Protocol):
    """Numbers, shape (p,), and how likely touches are by them."""

    @property
    def reached(self) -> AbstractSet[str]:
        """Names of the streams that they can reach."""

    def believed(self, values: FloatArray) -> BoolArray:
        """Tell which are standard uncertainties from what is believed; shape (p,)."""

    def __call__(self, values: FloatArray) -> float:
        """Give minus the log-likelihood, with what beliefs are unlikely by, in nats."""

    def at(self, values: FloatArray) -> tuple[Scene, Change]:
        """Give the touches, under the beliefs that they make, and what they change."""


def by_least_squares(ridge: Ridge, start: FloatArray) -> FloatArray:
    """Step from numbers, shape (p,), as long as that makes touches likelier."""
    best = start
    for _ in range(STEPS):
        step = _step(ridge, best)
        tried = [best + share * step for share in SHORTER]
        better = min(tried, key=ridge)
        if not ridge(better) < ridge(best):
            break
        best = better
    return best


def _step(ridge: Ridge, values: FloatArray) -> FloatArray:
    """Give what numbers are off by, shape (p,), as far as touches and what is believed tell."""
    believed = ridge.believed(values)
    # A belief moves no farther than so far: seen from there, it goes back.
    scale = np.where(believed, np.where(values > 0.0, -1.0, 1.0), values)
    free = np.flatnonzero(scale)
    slopes, off = _linearised(ridge, values, free, DIFFERENCE * scale[free])
    a_deviation = np.sqrt(len(off)) / np.maximum(np.linalg.norm(slopes, axis=0), TINY)
    told = np.flatnonzero(a_deviation < MOST_MOVED * np.abs(scale[free]))
    smooth = [i for i in told if _is_smooth(ridge, values, free[i], a_deviation[i], len(off))]
    prior = np.eye(len(free))[believed[free]][:, smooth]
    found, *_ = np.linalg.lstsq(
        np.vstack([slopes[:, smooth], prior]), np.append(off, -values[believed]), rcond=None
    )
    step = np.zeros_like(values)
    step[free[smooth]] = found
    return step


def _linearised(
    ridge: Ridge, values: FloatArray, free: IndexArray, steps: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Give by how much numbers shift touches, shape (m, f), and what these are off by, (m,).

    In standard deviations, without what an unknown datum takes up.
    """
    scene, change = ridge.at(values)
    moved = [ridge.at(_moved(values, *move)) for move in zip(free, steps, strict=True)]
    slopes, off = [np.zeros((0, len(free)))], [np.zeros(0)]
    for name in sorted((ridge.reached & scene.streams.keys()) - {LATTICE}):
        stream = scene.streams[name]
        law = law_under(scene, stream, change)
        weights = weights_of(stream, law)[:, None]
        here = _off(scene, name, change)
        shifts = np.transpose([here - _off(there, name, other) for there, other in moved]) / steps
        surfaces = weights * surfaces_of(scene, stream)
        slopes.append(_beyond(surfaces, weights * shifts))
        off.append(_beyond(surfaces, weights[:, 0] * here))
    return np.vstack(slopes), np.concatenate(off)


def _off(scene: Scene, name: str, change: Change) -> FloatArray:
    """Give what a stream's touches are off by, shape (m,)."""
    stream = scene.streams[name]
    return (stream.residuals - law_under(scene, stream, change).mean)[stream.rows]


def _is_smooth(ridge: Ridge, values: FloatArray, index: int, step: float, touches: int) -> bool:
    """Tell whether touches count for a parameter by their shifts alone, about a step from it.

    That costs half a nat for each that is a standard deviation off. Lines that they lie on, as of a
    tick, are lost for much less.
    """
    ahead, back = (ridge(_moved(values, index, step)) for step in (step, -step))
    return 0.5 * (ahead + back) - ridge(values) < MOST_CURVED * touches


def _moved(values: FloatArray, index: int, step: float) -> FloatArray:
    moved = values.copy()
    moved[index] += step
    return moved


def weights_of(stream: Stream, law: Law) -> FloatArray:
    """Weigh the touches of a stream, shape (m,): those far off, as scatter goes, pull no harder."""
    off, spread = np.abs(stream.residuals - law.mean)[stream.rows], law.spread[stream.rows]
    far = CALM * np.maximum(spread, np.median(off) if len(off) else 0.0)
    return np.asarray(1.0 / spread / np.sqrt(np.maximum(off / far, 1.0)))


def surfaces_of(scene: Scene, stream: Stream) -> FloatArray:
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
