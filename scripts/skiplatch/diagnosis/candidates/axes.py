"""Where the search for errors that each axis has of its own begins: by least squares on each.

Of two axes that err to opposite sides, what they have in common shows nothing to begin with.
"""

from collections.abc import Callable, Sequence

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import LINEAR_AXES, Touches
from skiplatch.diagnosis.candidates.candidate import Refinement
from skiplatch.diagnosis.candidates.first_axis import MOST_OVER, OF_AN_AXIS, RATIOS
from skiplatch.diagnosis.candidates.positions import Positions, positions, surfaces_show
from skiplatch.diagnosis.candidates.starts import Starts, robust_fit, scale_beside
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect

FEWEST_ON_AXIS = 5
"""Touches, of an axis or of all, that show an error: a size, a datum, and three that agree."""
A_NEWS = 4.0
"""Nats that each further axis has to gain for it to be proposed, by the scatter that there is."""


def idle(touches: Touches, effect: Effect) -> frozenset[str]:
    """Name the parameters by which no touch differs: of an axis that is not there, or the only one.

    What is not 0 counts: it is played.
    """
    moved = set(touches.axis.tolist())
    return frozenset(
        name
        for name, axis in OF_AN_AXIS.items()
        if effect.parameters.get(name, 1.0) == 0.0 and (axis not in moved or len(moved) == 1)
    )


def like_datum(scene: Scene) -> frozenset[str]:
    """Name the parameters of a backlash that move all touches of a datum alike.

    So does what an axis has more than X, where each datum of it is met by that axis in one sense.
    """
    if scene.datum_groups is None:
        return frozenset()
    moves = np.column_stack([scene.datum_groups, scene.touches.axis, scene.sign]).astype(int)
    groups, axes, _ = np.unique(moves, axis=0).T
    shared = set(axes[np.bincount(groups)[groups] > 1].tolist())
    alone = {name for name in RATIOS if OF_AN_AXIS[name] not in shared}
    return frozenset({"positive_um", *alone})


def each_axis(
    change: Callable[[Scene, FloatArray], Change],
    shapes: Sequence[Sequence[float]],
    sizes: Sequence[float],
    linear: int,
    y_excess_ratio: int,
    moves_surface: int | None = None,
) -> Starts:
    """Propose an error of the position by what the touches show of it, and by each axis' touches.

    Args:
        change: What parameters make of the physics.
        shapes: Parameters of an error of size 1 that all axes have in common.
        sizes: That are proposed anyway, of either sign.
        linear: So many parameters, the first ones, multiply the error.
        y_excess_ratio: Number of the parameter y_excess_ratio, which z_excess_ratio follows.
        moves_surface: That of the one by which the surface moves instead, if there is one.
    """

    def sized(shape: Sequence[float], size: float) -> list[float]:
        return [*(size * value for value in shape[:linear]), *shape[linear:]]

    usual = [
        sized(shape, sign * size) for shape in shapes for size in sizes for sign in (1.0, -1.0)
    ]

    def starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
        seen: list[list[float]] = []
        for moves in {False, moves_surface is not None and surfaces_show(scene)}:
            told = positions(scene, given, of_surfaces=moves)
            for shape in shapes:
                unit = change(scene, np.array(shape))
                unit_um = unit.position_um + scene.speed * unit.position_us
                for first, *over in _seen_sizes(scene, told, np.broadcast_to(unit_um, len(scene))):
                    own = sized(shape, first)
                    if moves_surface is not None:
                        own[moves_surface] = float(moves)
                    own[y_excess_ratio : y_excess_ratio + 2] = over
                    seen.append(own)
        return [*seen, *usual]

    return starts


def axes_of_their_own(y_excess_ratio: int) -> tuple[Refinement, ...]:
    """Refine an error by what Y and Z have more than X.

    Args:
        y_excess_ratio: Number of that parameter, which z_excess_ratio follows.
    """
    y, z = y_excess_ratio, y_excess_ratio + 1
    return ({y: 0.1}, {y: -0.5}, {z: -0.9}, {y: 0.1, z: -0.9})


def _seen_sizes(scene: Scene, told: Positions, unit_um: FloatArray) -> list[list[float]]:
    """Fit multiples of an error, shape (n,): that of the first axis, and what Y and Z have more.

    One that all axes have in common; another of each axis, if they are not much the same. None of
    too few touches.
    """
    rows = told.rows
    scores, units = told.off_um / told.spread_um, unit_um[rows] / told.spread_um
    if np.count_nonzero(units) < FEWEST_ON_AXIS:
        return []
    data = list((told.data / told.spread_um[:, None]).T)
    on_axes = [scene.touches.axis[rows] == axis for axis in LINEAR_AXES]
    seen = [k for k, on_axis in enumerate(on_axes) if np.any(units[on_axis])]
    parts = [units * on_axes[k] for k in seen]
    scale = scale_beside([*parts, *data], scores)
    common, cost = robust_fit([units, *data], scores, scale)
    same = [float(common[0]), 0.0, 0.0]
    if len(seen) < 2 or min(on_axes[k].sum() for k in seen) < FEWEST_ON_AXIS:
        return [same]
    parted, lower = robust_fit([*parts, *data], scores, scale)
    if cost - lower < A_NEWS * (len(seen) - 1):
        return [same]
    sizes = np.full(len(LINEAR_AXES), common[0])
    sizes[seen] = parted[: len(seen)]
    least = np.abs(sizes).max() / MOST_OVER
    own = sizes[seen[0]]
    first = float(own if abs(own) > least else np.copysign(least, own))
    sizes[[k for k in range(len(sizes)) if k not in seen]] = first  # nothing tells of those
    return [same, [first, *(sizes[1:] / first - 1.0).tolist()]]
