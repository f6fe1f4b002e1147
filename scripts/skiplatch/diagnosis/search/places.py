"""Whether what goes with the place is told by the places touched, or but by how often they were.

Any error that goes with the place, as that of an axis which is not square to another one, is some
wave at a few places: one of so many periods and orders runs through all of them. Touches of one
place agree with each other then, wherever they are held out. They count as one. So is a scale of
each axis, where this was touched at two places: a line through two points says nothing.
"""

import math
from collections.abc import Iterator

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.first_axis import OF_AN_AXIS
from skiplatch.diagnosis.candidates.positions import Positions, positions
from skiplatch.diagnosis.candidates.surrogates import SWITCHES, Parameters
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.scene.grid import ACCIDENT
from skiplatch.diagnosis.scene.scene import Scene

WAVE, PERIOD = "transmission_error", "period_mm"
BY_PLACE = ("scale_error", "thermal_drift")
"""Effects that are larger the farther out an axis is."""
PLACE_MM = 0.1
"""Within which touches are of one place, as those go."""
HARDLY = 0.1
"""Of what an effect shifts touches by, that it changes at one place where it hardly does."""
PLACES_A_PERIOD = 20.0
"""Within which a wave is much the same."""
FEWEST_AGAIN = 2.0
"""Touches a place, from which on places are fewer than touches: else these tell by themselves."""


def are_told_by_places(scene: Scene, model: Fit) -> list[bool]:
    """Tell of each effect of a model whether it goes with no place, or is one that places tell."""
    told = {WAVE: _is_wave_told, **dict.fromkeys(BY_PLACE, _is_size_told)}
    return [
        candidate.id not in told or told[candidate.id](scene, model, i)
        for i, candidate in enumerate(model.candidates)
    ]


def _is_size_told(scene: Scene, model: Fit, number: int) -> bool:
    """Tell whether there are more places, less one for each unknown datum, than sizes.

    What changes at one place as well is told by more than places.
    """
    candidate, parameters = model.candidates[number], model.parameters[number]
    touches = scene.touches
    rows = candidate.span.holds(touches.touch) & ~np.isnan(touches.position_mm)
    if not rows.any():
        return True
    data = np.zeros(len(scene)) if scene.datum_groups is None else scene.datum_groups
    where = np.column_stack([data, touches.axis, touches.sign, touches.position_mm / PLACE_MM])
    places, place = np.unique(np.rint(where[rows]), axis=0, return_inverse=True)
    shift_um = np.broadcast_to(candidate.change(scene, parameters).position_um, rows.shape)[rows]
    middles_um = np.bincount(place.ravel(), shift_um) / np.bincount(place.ravel())
    if np.std(shift_um - middles_um[place.ravel()]) > HARDLY * np.std(shift_um):
        return True
    is_unknown = scene.datum_groups is not None and scene.datum_u_um is None
    taken_up = len(np.unique(places[:, 0])) if is_unknown else 0
    count = len(np.unique(places[:, [0, 1, 3]], axis=0))
    return count - taken_up > _sizes(candidate, parameters)


def _sizes(candidate: Candidate, parameters: Parameters) -> int:
    values = zip(candidate.names, parameters, strict=True)
    return sum(value != 0.0 for name, value in values if name not in SWITCHES)


def _is_wave_told(scene: Scene, model: Fit, number: int) -> bool:
    candidate, parameters = model.candidates[number], model.parameters[number]
    acts = candidate.span.holds(scene.touches.touch)
    told = positions(scene, model.without(number).change(scene)).where(acts)
    shift = candidate.change(scene, parameters).position_um
    wave_um = (scene.sign * np.broadcast_to(shift, (len(scene),)))[told.rows]
    chances = [
        _log_chance(scene, told, wave_um, rows, candidate, parameters)
        for rows in _sharing(scene, told, candidate, parameters)
    ]
    return min(chances, default=-math.inf) < math.log(ACCIDENT)


def _sharing(
    scene: Scene, told: Positions, candidate: Candidate, parameters: Parameters
) -> Iterator[BoolArray]:
    """Give the touches of axes that share a wave: all, or those of each that has one of its own."""
    axes = scene.touches.axis[told.rows]
    values = zip(candidate.names, parameters, strict=True)
    if any(value for name, value in values if name in OF_AN_AXIS):
        yield from (axes == axis for axis in np.unique(axes))
    elif len(axes):
        yield np.full(len(axes), fill_value=True)


def _log_chance(
    scene: Scene,
    told: Positions,
    wave_um: FloatArray,
    rows: BoolArray,
    candidate: Candidate,
    parameters: Parameters,
) -> float:
    """Give the logarithm of the chance that a wave of any period explains so much of the places.

    By the F test of a fit beside the data and a straight line for each axis; -inf where hardly a
    place was touched again, and 0 of what is no wave there.
    """
    if not wave_um[rows].any():
        return 0.0
    values = dict(zip(candidate.names, parameters.tolist(), strict=True))
    free = sum(v != 0.0 for n, v in values.items() if n not in OF_AN_AXIS and n not in SWITCHES)
    touches = told.rows[rows]
    where_mm, axes = scene.touches.position_mm[touches], scene.touches.axis[touches]
    cells = np.rint(where_mm / abs(values[PERIOD]) * PLACES_A_PERIOD)
    _, place = np.unique(np.column_stack([axes, cells]), axis=0, return_inverse=True)
    place = place.ravel()
    count = int(place.max()) + 1
    if len(touches) < FEWEST_AGAIN * count:
        return -math.inf
    weights = 1.0 / told.spread_um[rows] ** 2
    whole = np.bincount(place, weights)

    def at_places(values: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(place, weights * values) / whole)

    signs = scene.sign[touches]
    data = signs[:, None] * told.data[rows]
    lines = [(axes == axis) * line for axis in np.unique(axes) for line in (1.0, where_mm)]
    beside = np.column_stack([at_places(column) for column in (*data.T, *lines)])
    off_um, wave_um = signs * told.off_um[rows], wave_um[rows]
    # A place has no middle while its two senses are apart by what is theirs.
    off_um -= _of_data(off_um - wave_um, weights, place, data, np.column_stack(lines))
    off_um = _medians(off_um, weights, place)
    root = np.sqrt(whole)

    def left(errors: FloatArray) -> float:
        found, *_ = np.linalg.lstsq(beside * root[:, None], errors * root, rcond=None)
        return float(np.sum((root * (errors - beside @ found)) ** 2))

    before, after = left(off_um), left(off_um - at_places(wave_um))
    open_ones = count - int(np.linalg.matrix_rank(beside)) - free
    if open_ones < 1 or after >= before:
        return 0.0
    over = (before - after) / free / (after / open_ones)
    periods = max(1.0, float(np.ptp(where_mm)) / (scene.whole or scene).shortest_wave_mm)
    return float(scipy.stats.f.logsf(over, free, open_ones)) + math.log(periods)


def _of_data(
    values: FloatArray,
    weights: FloatArray,
    place: IndexArray,
    data: FloatArray,
    lines: FloatArray,
) -> FloatArray:
    """Give what data make of values of touches, beside straight lines; shape (m,).

    Args:
        values: Shape (m,).
        weights: Likewise.
        place: Number of that of each touch.
        data: By how much a µm of each of d data shifts them; shape (m, d).
        lines: Shape (m, l).
    """
    beside = np.column_stack([data, lines])
    _, first, alike = np.unique(
        np.column_stack([place, data]), axis=0, return_index=True, return_inverse=True
    )
    alike = alike.ravel()
    root = np.sqrt(np.bincount(alike, weights))
    middles = _medians(values, weights, alike)
    sizes, *_ = np.linalg.lstsq(beside[first] * root[:, None], middles * root, rcond=None)
    return np.asarray(data @ sizes[: data.shape[1]])


def _medians(values: FloatArray, weights: FloatArray, place: IndexArray) -> FloatArray:
    """Give the weighted median of the values of each place, whatever some of them do."""
    medians = np.empty(int(place.max()) + 1)
    for k in range(len(medians)):
        here = np.flatnonzero(place == k)
        here = here[np.argsort(values[here])]
        up_to = np.cumsum(weights[here])
        medians[k] = values[here[np.searchsorted(up_to, up_to[-1] / 2.0)]]
    return medians
