"""Where the search for a periodic error of the position begins: the sines that explain most."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, IndexArray, winsorised
from skiplatch.campaign import LINEAR_AXES, Axis
from skiplatch.diagnosis.candidates.candidate import Refinement
from skiplatch.diagnosis.candidates.positions import Positions, positions, surfaces_show
from skiplatch.diagnosis.candidates.starts import robust_fit, scale_beside
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.scene.periodogram import explained_by_sines
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.units import DEG_PER_TURN

FEWEST_TURNS = 0.5
FASTEST_PER_MM = 2.0
"""Fewest periods on the way, and highest frequency, of a periodic error that is looked for."""
MOST_PEAKS = 12
"""Periods that one sine explains best, at which sines are fitted."""
MOST_PERIODS = 3
"""The best of those that are proposed: with so many orders, and with one for each axis."""
MOST_ORDERS = 3
STEPS_A_PEAK, NEAR_STEPS = 15, 6
"""Steps within the width of a peak, five for the highest order, and those to either side."""
WORTH_AN_ORDER = 8.0
"""Squares, weighted, that one order more has to leave less to be proposed."""
FEWEST_ON_AXIS = 16
"""Touches of an axis that show a sine of its own."""
FAR = 100.0
"""Times that one axis alone has more of a wave than the others at first."""
WORTH_A_SWITCH = 4.0
"""Squares, weighted, that the surface's coordinate has to leave less than that of the latch."""
UNKNOWN = [1.0, 10.0, 1.0, *[0.0] * 10]

A_PART = 0.2
"""Size of a further order at first, over that of the wave, which is that of X: an axis may have
many times as much."""


def _a_part(of: int, parameters: FloatArray) -> float:
    return float(parameters[of] or A_PART * parameters[0])


FURTHER_ORDERS: Sequence[Refinement] = tuple(
    {of: partial(_a_part, of), of + 1: phase_deg}
    for of in (3, 5)
    for phase_deg in (45.0, 135.0, 225.0, 315.0)
)
"""Forms of a wave with a second order, or with a third."""

Parameters = list[float]
"""Of a transmission error, all but the last two, which tell where it counts."""
Sine = Callable[[float], tuple[float, Parameters]]
"""Fits at a frequency in 1/mm; gives what is left, squared, weighted and summed, and the fit."""


def transmissions(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose the periods that explain most: at each, the best sine by least squares.

    Of what is read where it was latched, or where the surface should be; or of where surfaces are.
    """
    read = positions(scene, given)
    found = [_sines(scene, read, place) for place in (scene.latched_mm, scene.touches.position_mm)]
    seen: list[Parameters] = []
    if all(found):
        latched, at_surface = (min(left for left, _ in starts) for starts in found)
        is_at_surface = at_surface < latched - WORTH_A_SWITCH
        seen += [[*start, float(is_at_surface), 0.0] for _, start in found[is_at_surface]]
    if surfaces_show(scene):
        met = positions(scene, given, of_surfaces=True)
        seen += [[*start, 0.0, 1.0] for _, start in _sines(scene, met, scene.touches.position_mm)]
    return seen or [UNKNOWN]


def _sines(scene: Scene, seen: Positions, place: FloatArray) -> list[tuple[float, Parameters]]:
    """Give the best sines of what touches are off along places, shape (n,), and what they leave."""
    seen = seen.where(~np.isnan(scene.latched_mm))
    rows = seen.rows
    if not len(rows):
        return []
    on_axes = [scene.touches.axis[rows] == axis for axis in LINEAR_AXES]
    # A touch that goes too far is to either side of its position, by its sense.
    data = scene.sign[rows, None] * seen.data
    error_um = _beside_datum(scene.sign[rows] * seen.off_um, data, seen.spread_um)
    # Between places that lie evenly, a faster wave looks like a slower one.
    fastest = min(FASTEST_PER_MM, 1.0 / (scene.whole or scene).shortest_wave_mm)
    weights = 1.0 / seen.spread_um**2
    return _Seen(place[rows], winsorised(error_um), weights, data, on_axes, fastest).starts()


def _beside_datum(error: FloatArray, data: FloatArray, spread: FloatArray) -> FloatArray:
    """Take from errors, shape (n,), what columns of data, shape (n, d), and a constant explain."""
    columns = np.column_stack([data, np.ones(len(error))]) / spread[:, None]
    scores = error / spread
    sizes, _ = robust_fit(list(columns.T), scores, scale_beside(list(columns.T), scores))
    return np.asarray(error - data @ sizes[:-1])


@dataclass(frozen=True, eq=False)
class _Seen:
    """Errors in µm at positions in mm; arrays of shape (n,)."""

    position: FloatArray
    error: FloatArray
    weights: FloatArray
    data: FloatArray
    """What a µm of each datum adds to the errors, shape (n, d): sines are fitted beside them."""
    on_axes: Sequence[BoolArray]
    """Which are of X, of Y and of Z."""
    fastest_per_mm: float

    @cached_property
    def axes(self) -> list[int]:
        """Those with errors enough for a sine of their own."""
        return [k for k, rows in enumerate(self.on_axes) if rows.sum() >= FEWEST_ON_AXIS]

    def starts(self) -> list[tuple[float, Parameters]]:
        """Give the best sines for all axes together, and for each axis, with what they leave."""
        frequencies, explained = self._explained(self.weights)
        peaks = _peaks(frequencies, explained)
        found = [self._best(peaks, partial(self._orders, orders=1))]
        for orders in range(2, MOST_ORDERS + 1):
            more = self._best(peaks, partial(self._orders, orders=orders))
            if more and more[0][0] < found[-1][0][0] - WORTH_AN_ORDER:
                found.append(more)
        if len(self.axes) > 1:
            parts = [self._explained(self.weights * self.on_axes[k])[1] for k in self.axes]
            found.append(self._best(_peaks(frequencies, np.sum(parts, axis=0)), self._by_axis))
            least = min(best[0][0] for best in found if best)
            alone = [
                self._best(_peaks(frequencies, part), partial(self._alone, axis=k))
                for k, part in zip(self.axes, parts, strict=True)
            ]
            found += [best[:1] for best in alone if best and best[0][0] < least - WORTH_AN_ORDER]
        return [fitted for best in found for fitted in best]

    def _best(self, peaks: Sequence[float], sine: Sine) -> list[tuple[float, Parameters]]:
        """Fit at peaks, and about the best: one sine peaks elsewhere than several orders do."""
        if not peaks:
            return []
        near = np.arange(-NEAR_STEPS, NEAR_STEPS + 1) / (STEPS_A_PEAK * np.ptp(self.position))
        best = sorted((sine(per_mm)[0], per_mm) for per_mm in peaks)[:MOST_PERIODS]
        return sorted(
            min(sine(per_mm + off) for off in near if per_mm + off > 0.0) for _, per_mm in best
        )

    def _explained(self, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give frequencies in 1/mm, and the weighted squares that a sine of each explains."""
        frequencies, shares = explained_by_sines(
            self.position, self.error, weights, FEWEST_TURNS, self.fastest_per_mm
        )
        mean = np.average(self.error, weights=weights)
        return frequencies, shares * float(weights @ (self.error - mean) ** 2)

    def _orders(self, per_mm: float, orders: int) -> tuple[float, Parameters]:
        """Fit the first orders of a frequency."""
        turn = 2.0 * np.pi * per_mm * self.position
        waves = [
            wave for k in range(1, orders + 1) for wave in (np.sin(k * turn), np.cos(k * turn))
        ]
        left, found = self._least([*waves, np.ones(len(turn))])
        sizes, phases_deg = _polar(found[: 2 * orders].reshape(orders, 2))
        higher = np.zeros((MOST_ORDERS - 1, 2))
        higher[: orders - 1] = np.column_stack([sizes, phases_deg])[1:]
        first = [sizes[0], 1.0 / per_mm, phases_deg[0]]
        return left, [*first, *higher.ravel().tolist(), 0.0, 0.0, 0.0, 0.0]

    def _by_axis(self, per_mm: float) -> tuple[float, Parameters]:
        """Fit the first order of a frequency on each axis."""
        turn = 2.0 * np.pi * per_mm * self.position
        waves = (np.sin(turn), np.cos(turn), np.ones(len(turn)))
        left, found = self._least([self.on_axes[k] * wave for k in self.axes for wave in waves])
        sizes, phases_deg = _polar(found.reshape(len(self.axes), 3)[:, :2])
        more, ahead_deg = [0.0] * len(LINEAR_AXES), [0.0] * len(LINEAR_AXES)
        for k, size, phase_deg in zip(self.axes, sizes, phases_deg, strict=True):
            more[k] = size / sizes[0] - 1.0
            ahead_deg[k] = (phase_deg - phases_deg[0]) % DEG_PER_TURN
        first = [sizes[0], 1.0 / per_mm, phases_deg[0], *[0.0] * 2 * (MOST_ORDERS - 1)]
        return left, [*first, *more[Axis.Y :], *ahead_deg[Axis.Y :]]

    def _alone(self, per_mm: float, axis: int) -> tuple[float, Parameters]:
        """Fit all orders of a frequency on one axis; the others have next to none of it."""
        turn = 2.0 * np.pi * per_mm * self.position
        orders = range(1, MOST_ORDERS + 1)
        waves = [wave for k in orders for wave in (np.sin(k * turn), np.cos(k * turn))]
        on_axis = [np.where(self.on_axes[axis], wave, 0.0) for wave in waves]
        middles = [np.where(rows, 1.0, 0.0) for rows in self.on_axes]
        left, found = self._least([*on_axis, *middles])
        sizes, phases_deg = _polar(found[: len(waves)].reshape(MOST_ORDERS, 2))
        over_x = np.where(np.arange(len(LINEAR_AXES)) == axis, 1.0, 1.0 / FAR)
        sizes_of_x = np.asarray(sizes) * over_x[Axis.X]
        wave = np.column_stack([sizes_of_x, phases_deg]).ravel().tolist()
        first = [wave[0], 1.0 / per_mm, *wave[1:]]
        return left, [*first, *(over_x[Axis.Y :] / over_x[Axis.X] - 1.0).tolist(), 0.0, 0.0]

    def _least(self, columns: Sequence[FloatArray]) -> tuple[float, FloatArray]:
        """Fit multiples of the columns by least squares; give what they leave, and them."""
        design, root = np.column_stack([*columns, self.data]), np.sqrt(self.weights)
        found, *_ = np.linalg.lstsq(design * root[:, None], self.error * root, rcond=None)
        left = float(self.weights @ (self.error - design @ found) ** 2)
        return left, np.asarray(found[: len(columns)])


def _peaks(frequencies: FloatArray, explained: FloatArray) -> list[float]:
    """Give the frequencies in 1/mm that explain more than those beside them, the most first."""
    tried = sorted(_tops(np.pad(explained, 1)) - 1, key=lambda i: -explained[i])[:MOST_PEAKS]
    return [float(frequencies[i]) for i in tried]


def _tops(values: FloatArray) -> IndexArray:
    """Number the values above those on both sides, of equal ones that in their middle.

    As scipy.signal.find_peaks does, which takes much longer to load.
    """
    begins = np.flatnonzero(np.diff(values, prepend=np.nan))
    ends, level = np.append(begins[1:], len(values)) - 1, values[begins]
    is_top = (level[1:-1] > level[:-2]) & (level[1:-1] > level[2:])
    return np.asarray((begins[1:-1][is_top] + ends[1:-1][is_top]) // 2)


def _polar(parts: FloatArray) -> tuple[list[float], list[float]]:
    """Give sizes and phases in degrees of multiples of sine and cosine, shape (m, 2)."""
    sizes = np.maximum(np.hypot(*parts.T), np.finfo(float).tiny)
    return sizes.tolist(), np.rad2deg(np.arctan2(parts[:, 1], parts[:, 0])).tolist()
