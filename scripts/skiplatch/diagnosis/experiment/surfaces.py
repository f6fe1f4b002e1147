"""Surfaces that a campaign touched, and others that an experiment would want."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Touches
from skiplatch.campaign.session_names import surface_in

WHERE = ("axis", "sign", "alpha_deg", "beta_deg", "position_mm", "rotary_deg")
NOWHERE = -1e30
"""In place of what was not recorded: NaN is not equal to itself."""
SAME_SURFACE_MM = 0.5
LEAST_APPROACH_MM = 0.01
NARROW_POSITIONS_MM = 1.0


def touched(recorded: Touches, reach_mm: tuple[float, float]) -> NDArray[np.intp]:
    """Give a row of each surface that was touched within reach, in a fixed order.

    Where none lies within reach, the reach is wrong: they were touched. All of them then count.
    None was touched where no move latched.
    """
    latched = np.flatnonzero(~(recorded.missed | recorded.false))
    some = latched if latched.size else np.arange(len(recorded))
    rows = some[np.unique(_where(recorded)[some], axis=0, return_index=True)[1]]
    at_mm, sign = recorded.position_mm[rows], recorded.sign[rows]
    inside = ~(room_before_mm(at_mm, sign, reach_mm) < LEAST_APPROACH_MM)
    inside &= ~((at_mm < reach_mm[0]) | (at_mm > reach_mm[1]))
    return np.asarray(rows[inside] if inside.any() else rows)


def by_places(touches: Touches) -> Touches:
    """Give the touches in sessions of their places, as far as the campaign says them."""
    names, numbers = _placed(touches)
    return replace(touches, session=numbers, session_names=names)


def _placed(touches: Touches) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Give the surfaces whose places are known, and the number of each touch's; shape (n,)."""
    surface_of = [surface_in(name) for name in touches.session_names]
    names = tuple(dict.fromkeys(surface_of))
    return names, np.array([names.index(name) for name in surface_of])[touches.session]


def room_before_mm(
    position_mm: FloatArray, sign: FloatArray, reach_mm: tuple[float, float]
) -> FloatArray:
    """Give how far before each surface the reach of the axis begins; NaN where none is known."""
    before_mm = np.where(sign < 0.0, reach_mm[1] - position_mm, position_mm - reach_mm[0])
    return np.asarray(before_mm)


def longest_approach_mm(recorded: Touches, surfaces: Touches) -> FloatArray:
    """Give the longest approach to each surface along its axis in its sense; shape (n,).

    A sense in which nothing was touched has no limit.
    """
    longest = np.full(len(surfaces), np.inf)
    for axis, sign in _senses(surfaces) & _senses(recorded):
        alike = (recorded.axis == axis) & (recorded.sign == sign)
        rows = (surfaces.axis == axis) & (surfaces.sign == sign)
        longest[rows] = recorded.approach_mm[alike].max()
    return longest


def are_varied(recorded: Touches) -> bool:
    """Tell whether surfaces of every kind were touched: both senses, places far apart."""
    senses = {(axis, sign) for axis, sign in _senses(recorded) if axis != Axis.Z}
    both = all((axis, -sign) in senses for axis, sign in senses)
    known = recorded.position_mm[~np.isnan(recorded.position_mm)]
    return both and (not known.size or bool(np.ptp(known) >= NARROW_POSITIONS_MM))


def asked_for(plan: Touches, recorded: Touches) -> str:
    """Name what the surfaces of a plan have that no touched one has; empty for nothing."""
    said = []
    if senses := sorted(_senses(plan) - _senses(recorded)):
        names = (f"{Axis(int(axis)).name}{'+' if sign > 0.0 else '−'}" for axis, sign in senses)
        said.append(f"in the sense {' and '.join(names)}")
    if (at_mm := _far_from(plan.position_mm, recorded.position_mm)).size:
        said.append(f"at places from {at_mm.min():g} to {at_mm.max():g} mm")
    known = set(recorded.rotary_deg[~np.isnan(recorded.rotary_deg)].tolist())
    if angles := sorted(set(plan.rotary_deg[~np.isnan(plan.rotary_deg)].tolist()) - known):
        said.append(f"with the table at {', '.join(f'{angle:g}°' for angle in angles)}")
    return ", ".join(said)


def _where(touches: Touches) -> FloatArray:
    columns = touches.columns()
    cells = np.column_stack(
        [*(np.asarray(columns[name], dtype=float) for name in WHERE), _placed(touches)[1]]
    )
    return np.asarray(np.nan_to_num(cells, nan=NOWHERE))


def _senses(touches: Touches) -> set[tuple[float, float]]:
    known = (touches.axis >= 0) & ~np.isnan(touches.sign)
    return set(zip(touches.axis[known].tolist(), touches.sign[known].tolist(), strict=True))


def _far_from(position_mm: FloatArray, known_mm: FloatArray) -> FloatArray:
    """Give the positions that are none of the known ones."""
    known_mm = np.unique(known_mm[~np.isnan(known_mm)])
    if not known_mm.size:
        return np.zeros(0)
    after = np.minimum(np.searchsorted(known_mm, position_mm), len(known_mm) - 1)
    nearest = [np.abs(position_mm - known_mm[i]) for i in (after, np.maximum(after - 1, 0))]
    return np.asarray(position_mm[np.minimum(*nearest) > SAME_SURFACE_MM])
