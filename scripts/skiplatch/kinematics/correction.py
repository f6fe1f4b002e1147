"""What each mode of cycle 451 may change in a description, and the best that it can be so."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from sys import float_info
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from skiplatch.kinematics.firmware import Fit, TooFewError, fit, names_of
from skiplatch.kinematics.machine import LETTERS, Machine, RotaryAxis, Vector
from skiplatch.kinematics.points import Points

CHECK, POSITIONS, ANGLES, ORIGIN = range(4)
"""The modes of Q406."""
SIGNIFICANT = 2.0
"""Standard uncertainties that an angle has to exceed to be corrected."""
UM_PER_MM = 1000.0
ARCSEC_PER_DEG = 3600.0
STRAIGHT_RAD = 0.0175
"""1°: an axis that leans less is not meant to."""


def _free_in(mode: int, machine: Machine) -> frozenset[str]:
    """Name the location errors that a mode corrects; of a check those that it shows as possible.

    Offsets always; from `ANGLES` on tilts too. `ORIGIN` takes the zero of an axis for the tilt,
    about that axis, of the next one that it carries: no position tells the two apart.
    """
    names = [names_of(axis.letter) for axis in machine.axes]
    offsets = {name for own in names for name in own[:2]}
    if mode < ANGLES:
        return frozenset(offsets)
    free = offsets | {name for own in names for name in own[2:4]}
    if mode == ORIGIN:
        for carrier, carried in _carried(machine):
            free -= {f"{carrier}O{carried}"}
            free |= {f"{carrier}O{carrier}"}
    return frozenset(free)


def _carried(machine: Machine) -> list[tuple[str, str]]:
    """Give each axis that carries another one, and that."""
    return [
        (carrier.letter, carried.letter)
        for carrier, carried in pairwise(machine.axes)
        if carrier.in_head == carried.in_head
    ]


def corrected_as(
    mode: int, machine: Machine, points: Points, touches: int | None
) -> tuple[Machine, Fit]:
    """Correct a description as a mode says, of a check as `POSITIONS` would; with its fit.

    `ORIGIN` also takes back tilts that were corrected before, if the zeros are found instead.

    Raises:
        NoFitError: The positions are too few for offsets alone, or fit no such machine.
    """
    if mode == ORIGIN:
        straight = _straightened(machine)
        found = _correcting_fit(mode, straight, points, touches)
        if all(f"{carrier}O{carrier}" in found.parameters for carrier, _ in _carried(machine)):
            return _correct(straight, found), found
    found = _correcting_fit(mode, machine, points, touches)
    return _correct(machine, found), found


def _straightened(machine: Machine) -> Machine:
    """Take back the tilt of each carried axis about the one that carries it.

    An axis within `STRAIGHT_RAD` of its coordinate is meant to be parallel to it.
    """
    carriers = {carried: carrier for carrier, carried in _carried(machine)}

    def straight(axis: RotaryAxis) -> RotaryAxis:
        (leans,) = set(LETTERS) - {axis.letter, carriers[axis.letter]}
        direction = np.array(axis.direction)
        if abs(direction[LETTERS.index(leans)]) > STRAIGHT_RAD:
            return axis
        direction[LETTERS.index(leans)] = 0.0
        return replace(axis, direction=_unit(direction))

    axes = tuple(straight(a) if a.letter in carriers else a for a in machine.axes)
    return replace(machine, axes=axes)


def _unit(direction: NDArray[np.float64]) -> Vector:
    return cast(Vector, tuple((direction / np.linalg.norm(direction)).tolist()))


def _correcting_fit(mode: int, machine: Machine, points: Points, touches: int | None) -> Fit:
    """Fit what a mode corrects, with all else held: the least squares that the mode can reach.

    An angle that cannot be told from nothing may be wild where the positions determine it only
    just: it is held, and the rest is fitted anew. So are all where there are too few positions.
    """
    free = _free_in(mode, machine)
    while True:
        try:
            found = fit(machine, points, free=free, touches=touches)
        except TooFewError:
            if mode < ANGLES:
                raise
            return _correcting_fit(POSITIONS, machine, points, touches)
        weakest = _weakest_angle(found)
        if weakest is None:
            return found
        free -= {weakest}


def _weakest_angle(found: Fit) -> str | None:
    """Give the angle that differs least from nothing, if it does not differ enough."""
    ratios = {
        name: abs(estimate.value) / max(estimate.uncertainty, float_info.min)
        for name, estimate in found.parameters.items()
        if estimate.unit == "arcsec"
    }
    weakest = min(ratios, key=lambda name: ratios[name], default=None)
    return None if weakest is None or ratios[weakest] > SIGNIFICANT else weakest


def _correct(machine: Machine, found: Fit) -> Machine:
    """Put the determined location errors into the description; the others are left alone."""
    amounts = {name: estimate.value for name, estimate in found.parameters.items()}
    return replace(machine, axes=tuple(_corrected(axis, amounts) for axis in machine.axes))


def _corrected(axis: RotaryAxis, amounts: Mapping[str, float]) -> RotaryAxis:
    own = LETTERS.index(axis.letter)
    shift_um = [amounts.get(f"{name}O{axis.letter}", 0.0) for name in "XYZ"]
    turn_deg = np.array([amounts.get(f"{x}O{axis.letter}", 0.0) for x in LETTERS]) / ARCSEC_PER_DEG
    zero_deg, turn_deg[own] = float(turn_deg[own]), 0.0
    direction = Rotation.from_rotvec(turn_deg, degrees=True).apply(axis.direction)
    return replace(
        axis,
        point_mm=cast(
            Vector, tuple(np.add(axis.point_mm, np.divide(shift_um, UM_PER_MM)).tolist())
        ),
        direction=_unit(direction),
        datum_deg=axis.datum_deg + zero_deg,
    )
