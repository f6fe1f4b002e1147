"""Where the search begins for what is linear in its sizes: by least squares on all that shows it.

What has a size of its own for each direction, as lobes and a centre have, leaves a climb from a
guess on the wrong side of a hill; the sizes themselves are told by the touches at once.
"""

from collections.abc import Callable, Sequence

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.positions import surfaces_show
from skiplatch.diagnosis.candidates.starts import Starts, robust_fit, scale_beside
from skiplatch.diagnosis.candidates.surrogates import Parameters
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import BY_COORDINATES, BY_STAMPS, WITHOUT_STAMPS
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.scene.nominal_chain import LOBES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.units import DEG_PER_TURN

Effect = Callable[[Scene, Parameters], Change]
TELLING = (*BY_COORDINATES, *WITHOUT_STAMPS, *BY_STAMPS)
"""Streams that show a length, each touch as sharply as its law says."""
FEWEST = 16
"""Touches that show sizes."""
POWERS = (0.0, 1.0, -0.5)
"""Of the elevation, beyond the calibrated one."""
SETTINGS = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
"""Whether a table is set on its believed centre, and turns the other way."""


def lobes(change: Effect) -> Starts:
    """Propose lobes of the best size and direction; and the same with further orders."""

    def starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
        quarter_deg = DEG_PER_TURN / 4.0 / LOBES
        seen: list[list[float]] = []
        for power in POWERS:
            single = [[1.0, azimuth, 0.0, 0.0, power] for azimuth in (0.0, quarter_deg)]
            double = [[0.0, azimuth, 1.0, 0.0, power] for azimuth in (0.0, quarter_deg / 2.0)]
            first, second = (sizes(scene, given, change, units) for units in (single, double))
            if first is None or second is None:
                return [[2.0, k * quarter_deg, 0.0, 0.0, 0.0] for k in range(4)]
            first_deg, second_deg = _towards_deg(first), _towards_deg(second) / 2.0
            seen.append([float(np.hypot(*first)), first_deg, 0.0, 0.0, power])
            # Lobes of twice as many point there and a quarter of a turn on; those of one need not.
            for azimuth in (first_deg, second_deg, second_deg + quarter_deg):
                units = [[one[0], azimuth, *one[1:], power] for one in np.eye(3).tolist()]
                if (found := sizes(scene, given, change, units)) is not None:
                    seen.append([float(found[0]), azimuth, *found[1:].tolist(), power])
        return seen

    return starts


def _towards_deg(parts: FloatArray) -> float:
    """Give the direction of a lobe by its sizes along 0 and a quarter of a turn on; never 0."""
    return float(np.rad2deg(np.arctan2(parts[1], parts[0]))) / LOBES or DEG_PER_TURN


def centres(change: Effect) -> Starts:
    """Propose the centre about which the table turns, however it was set and turns."""

    def starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
        seen = []
        moves = (0.0, 1.0) if surfaces_show(scene) else (0.0,)
        settings = [(*setting, moved) for moved in moves for setting in SETTINGS]
        for setting in settings:
            units = [[1.0, 0.0, *setting], [0.0, 1.0, *setting]]
            if (found := sizes(scene, given, change, units)) is not None:
                seen.append([*found.tolist(), *setting])
        usual = [[x, y, *s] for x, y in ((5.0, 0.5), (0.5, -5.0)) for s in settings]
        return seen or usual

    return starts


def sizes(
    scene: Scene, given: Change, change: Effect, units: Sequence[Sequence[float]]
) -> FloatArray | None:
    """Fit multiples of changes, shape (u,), to all streams that they show in.

    Beside a datum of each group of touches, whatever some touches do.

    Args:
        scene: The touches.
        given: What differs already.
        change: What parameters make of the physics, in proportion to those that `units` tell.
        units: Parameters of one unit of each.

    Returns:
        The multiples, or None of too few touches, or of units that do nothing.
    """
    changes = [change(scene, np.array(unit)) for unit in units]
    parts = [
        _columns(scene, scene.streams[name], given, changes)
        for name in TELLING
        if name in scene.streams and scene.streams[name].rows.any()
    ]
    parts = [part for part in parts if part[:, : len(units)].any()]
    if sum(map(len, parts)) < FEWEST:
        return None
    whole = np.vstack(parts)
    values, columns = whole[:, -1], whole[:, :-1]
    if not columns[:, : len(units)].any(axis=0).all():
        return None
    shown = list(columns[:, columns.any(axis=0)].T)
    return robust_fit(shown, values, scale_beside(shown, values))[0][: len(units)]


def _columns(scene: Scene, stream: Stream, given: Change, changes: Sequence[Change]) -> FloatArray:
    """Give what changes do to the rows of a stream, what a datum does, and what the rows are off.

    All over the spread; shape (rows, u + g + 1).
    """
    rows, base = stream.indices, law_under(scene, stream, given)
    does = [law_under(scene, stream, given.joined(one)).mean - base.mean for one in changes]
    groups = scene.datum_of(stream)[:, None] == np.arange(scene.datum_count)
    datum = scene.per_datum_um(stream)[rows, None] * groups
    off = stream.residuals[rows] - base.mean[rows]
    table = np.column_stack([*(np.asarray(one)[rows] for one in does), datum, off])
    return np.asarray(table / base.spread[rows, None])
