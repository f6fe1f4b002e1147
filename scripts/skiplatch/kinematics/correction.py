"""What cycles 451 and 452 may change in a description, and the best that it can be so."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from sys import float_info
from typing import cast

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.kinematics.firmware import Estimate, Fit, NoFitError, fit, names_of
from skiplatch.kinematics.machine import LETTERS, Machine, RotaryAxis, Vector
from skiplatch.kinematics.points import Points
from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM

CHECK, POSITIONS, ANGLES, ORIGIN = range(4)
"""The modes of Q406."""
SIGNIFICANT = 2.0
"""Standard uncertainties that an angle has to exceed to be corrected."""
STRAIGHT_RAD = 0.0175
"""1°: an axis that leans less is not meant to."""


@dataclass(frozen=True, slots=True)
class Measured:
    """What a correction is made of.

    Attributes:
        points: Where the sphere was found.
        touches: Q423, or None where a centre scatters alike in all directions.
        letters: The axes that were measured; the others are left as they are.
    """

    points: Points
    touches: int | None
    letters: Collection[str]


def _free_in(mode: int, machine: Machine, letters: Collection[str]) -> frozenset[str]:
    """Name the location errors that a mode corrects; of a check those that it shows as possible.

    Offsets always; from `ANGLES` on tilts too. `ORIGIN` takes the zero of an axis for the tilt,
    about that axis, of the next one that it carries: no position tells the two apart.
    """
    names = [names_of(axis.letter) for axis in machine.axes if axis.letter in letters]
    offsets = {name for own in names for name in own[:2]}
    if mode < ANGLES:
        return frozenset(offsets)
    free = offsets | {name for own in names for name in own[2:4]}
    if mode == ORIGIN:
        for carrier, carried in _carried(machine, letters):
            free -= {f"{carrier}O{carried}"}
            free |= {f"{carrier}O{carrier}"}
    return frozenset(free)


def _carried(machine: Machine, letters: Collection[str]) -> list[tuple[str, str]]:
    """Give each axis that carries another one, and that, where both were measured."""
    return [
        (carrier.letter, carried.letter)
        for carrier, carried in pairwise(machine.axes)
        if carrier.in_head == carried.in_head and {carrier.letter, carried.letter} <= set(letters)
    ]


@dataclass(frozen=True, slots=True)
class Correction:
    """A corrected description, and the fit that it follows from.

    Attributes:
        machine: As corrected.
        fit: What the mode corrects, and what it could not tell apart.
        preset_off_mm: How far the sphere was off the preset that cycle 452 keeps; None in 451.
    """

    machine: Machine
    fit: Fit
    preset_off_mm: Vector | None = None

    @property
    def combined(self) -> tuple[str, ...]:
        """Name the sums that are corrected though their parts are not known."""
        return tuple(c.name for c in self.fit.combinations)


def keep_preset(correction: Correction, off_mm: Vector, letters: Collection[str]) -> Correction:
    """Move what has moved until the sphere stands in the preset again (cycle 452).

    What a machine shows is where its tip is, so nothing that it reads tells a table that has moved
    from a tip that has moved the other way. The tip moves here, and with it the head from the first
    of its axes that was measured, or the whole head. A table stays where it was: what was fitted to
    its axes is put back by as much as all readings are off. Axes that were not measured stood at 0.

    Args:
        correction: Of the positions of the axes.
        off_mm: How far from the preset the sphere was found by that, with every axis at 0.
        letters: The axes that were measured.
    """
    machine = correction.machine
    head = [axis.letter for axis in machine.axes if axis.in_head]
    first = next((place for place, letter in enumerate(head) if letter in letters), 0)
    moved = {*head[first:], *(a.letter for a in machine.axes if a.letter in letters)}
    axes = tuple(_moved_back(a, off_mm) if a.letter in moved else a for a in machine.axes)
    shifted = replace(machine, axes=axes, tip_shift_mm=_minus(machine.tip_shift_mm, off_mm))
    return replace(correction, machine=shifted, preset_off_mm=off_mm)


def _moved_back(axis: RotaryAxis, off_mm: Vector) -> RotaryAxis:
    """Move an axis; that of a table not along its own line, where nothing was fitted."""
    along_mm = 0.0 if axis.in_head else float(np.dot(off_mm, axis.direction))
    across_mm = _vector(np.subtract(off_mm, np.multiply(along_mm, axis.direction)))
    return replace(axis, point_mm=_minus(axis.point_mm, across_mm))


def _minus(point_mm: Vector, off_mm: Vector) -> Vector:
    return _vector(np.subtract(point_mm, off_mm))


def _vector(values: NDArray[np.float64]) -> Vector:
    return cast(Vector, tuple(values.tolist()))


def corrections(mode: int, machine: Machine, measured: Measured) -> Iterator[Correction]:
    """Correct a description as a mode says, of a check as `POSITIONS` would; most angles first.

    Every further correction holds one more angle, the weakest; the last one corrects offsets alone.
    `ORIGIN` also takes back tilts that were corrected before, if the zeros are found instead.

    Raises:
        NoFitError: The positions are too few for offsets alone, or fit no such machine.
    """
    if mode == ORIGIN:
        carried = _carried(machine, measured.letters)
        straight = _straightened(machine, carried)
        for found in _fits(mode, straight, measured):
            if all(f"{carrier}O{carrier}" in found.parameters for carrier, _ in carried):
                yield Correction(apply_fit(straight, found), found)
    for found in _fits(mode, machine, measured):
        yield Correction(apply_fit(machine, found), found)


def _straightened(machine: Machine, pairs: Sequence[tuple[str, str]]) -> Machine:
    """Take back the tilt of each carried axis about the one that carries it.

    An axis within `STRAIGHT_RAD` of its coordinate is meant to be parallel to it.
    """
    carriers = {carried: carrier for carrier, carried in pairs}

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
    return _vector(direction / np.linalg.norm(direction))


def _fits(mode: int, machine: Machine, measured: Measured) -> Iterator[Fit]:
    """Fit what a mode corrects, with all else held, from the most angles to none.

    An angle that cannot be told from nothing may be wild where the positions determine it only
    just: it is held, and the rest is fitted anew. So are all where there are too few positions, or
    where no machine nearby fits with them.
    """
    points, touches, letters = measured.points, measured.touches, measured.letters
    free = _free_in(mode, machine, letters)
    while any(_is_angle(name) for name in free):
        try:
            found = fit(machine, points, free=free, touches=touches)
        except NoFitError:
            break
        weakest = _weakest_angle(found)
        if weakest is None:
            break
        name, ratio = weakest
        if ratio > SIGNIFICANT:
            yield found
        free -= {name}
    yield fit(machine, points, free=_free_in(POSITIONS, machine, letters), touches=touches)


def _is_angle(name: str) -> bool:
    return name[0] in LETTERS


def _weakest_angle(found: Fit) -> tuple[str, float] | None:
    """Give the angle that differs least from nothing, in its standard uncertainties."""
    ratios = {
        name: abs(estimate.value) / max(estimate.uncertainty, float_info.min)
        for name, estimate in _amounts(found).items()
        if _is_angle(name)
    }
    weakest = min(ratios, key=lambda name: ratios[name], default=None)
    return None if weakest is None else (weakest, ratios[weakest])


def _amounts(found: Fit) -> dict[str, Estimate]:
    """Give what is known; a sum that is known whole goes to the first of its parts."""
    sums = {next(iter(c.amounts)): c.estimate for c in found.combinations}
    return {**found.parameters, **sums}


def _least(found: Fit) -> dict[str, float]:
    """Give the smallest location errors that show so: tilts as small as can be, then offsets."""
    amounts = {name: estimate.value for name, estimate in _amounts(found).items()}
    names = sorted({*amounts, *(n for u in found.undetermined for n in u.amounts)})
    values = np.array([amounts.get(name, 0.0) for name in names])
    for of_angles in (True, False):
        alike = np.array([_is_angle(name) == of_angles for name in names], dtype=bool)
        unseen = [
            [u.amounts.get(name, 0.0) for name in names]
            for u in found.undetermined
            if not u.is_zero and _is_angle(u.own) == of_angles
        ]
        if unseen:
            ways = np.array(unseen).T
            values -= ways @ np.linalg.lstsq(ways[alike], values[alike], rcond=None)[0]
    return dict(zip(names, values.tolist(), strict=True))


def apply_fit(machine: Machine, found: Fit) -> Machine:
    """Put what was found into the description; what shows at no position is left alone."""
    amounts = _least(found)
    return replace(machine, axes=tuple(_corrected(axis, amounts) for axis in machine.axes))


def _corrected(axis: RotaryAxis, amounts: Mapping[str, float]) -> RotaryAxis:
    own = LETTERS.index(axis.letter)
    shift_um = [amounts.get(f"{name}O{axis.letter}", 0.0) for name in "XYZ"]
    turn_deg = np.array([amounts.get(f"{x}O{axis.letter}", 0.0) for x in LETTERS]) / ARCSEC_PER_DEG
    zero_deg, turn_deg[own] = float(turn_deg[own]), 0.0
    direction = scipy.spatial.transform.Rotation.from_rotvec(turn_deg, degrees=True).apply(
        axis.direction
    )
    return replace(
        axis,
        point_mm=_vector(np.add(axis.point_mm, np.divide(shift_um, UM_PER_MM))),
        direction=_unit(direction),
        datum_deg=axis.datum_deg + zero_deg,
    )
