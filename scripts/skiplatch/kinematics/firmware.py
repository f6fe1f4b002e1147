"""The firmware's fit of location errors, ``firmware/comp/kinematics.h``, in Python's terms."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.five_axis import compensation_mm
from skiplatch.kinematics.machine import LETTERS, Machine, Vector
from skiplatch.kinematics.points import Points
from skiplatch.simulator.library import CData, connection

AXES_MAX = 3
SHARE_MIN = 1e-9


class NoFitError(Exception):
    """The points do not determine a fit."""


class TooFewError(NoFitError):
    """There are no more coordinates than unknowns."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A location error, or a combination of some.

    Attributes:
        value: Actual minus believed.
        uncertainty: Standard uncertainty; ± 3 of it hold 99.73 %.
        unit: ``µm`` or ``arcsec``.
    """

    value: float
    uncertainty: float
    unit: str


@dataclass(frozen=True, slots=True)
class Undetermined:
    """A change of location errors that shows at no position.

    Attributes:
        own: The one that changes by 1.
        amounts: How much each changes that is named, in µm or arcsec.
        against: What else changes with it: ``sphere``, ``tip`` or both.
    """

    own: str
    amounts: Mapping[str, float]
    against: tuple[str, ...]

    @property
    def is_zero(self) -> bool:
        """Tell whether it is of an axis's zero, such as ``COC``."""
        return self.own[0] == self.own[-1]

    @property
    def name(self) -> str:
        """Such as ``YOA`` or ``AOA-AOC``."""
        return combination(self.amounts)


@dataclass(frozen=True, slots=True)
class Combination:
    """A sum of location errors that is determined while they are not.

    Attributes:
        amounts: The factor of each, in the unit of the estimate per its own.
        estimate: What the sum is.
    """

    amounts: Mapping[str, float]
    estimate: Estimate

    @property
    def name(self) -> str:
        """Such as ``YOC-YOA``; parts below a thousandth are not written."""
        return combination({n: a for n, a in self.amounts.items() if abs(a) > 1e-3})


@dataclass(frozen=True, slots=True)
class Fit:
    """What the points tell.

    Attributes:
        parameters: Determined location errors, by name.
        combinations: Sums of others that are determined.
        undetermined: What the positions leave open.
        residual_um: Standard deviation of one coordinate, across the tool; 0 where nothing was
            fitted.
        sphere_mm: The sphere with every axis at 0, as fitted.
        tip_mm: The tip with every axis at 0; as fitted where it was not known.
        unknowns: Location errors, coordinates of the sphere and, with a head axis, of the tip.
        rank: How many of them the positions determine.
        freedom: Coordinates measured minus rank.
    """

    parameters: Mapping[str, Estimate]
    combinations: tuple[Combination, ...]
    undetermined: tuple[Undetermined, ...]
    residual_um: float
    sphere_mm: tuple[float, float, float]
    tip_mm: tuple[float, float, float]
    unknowns: int
    rank: int
    freedom: int

    @property
    def estimates(self) -> list[tuple[str, Estimate]]:
        """The location errors that are determined, and sums of others that are."""
        return [*self.parameters.items(), *((c.name, c.estimate) for c in self.combinations)]


def combination(amounts: Mapping[str, float]) -> str:
    """Write a sum of location errors, such as ``YOA-YOC`` or ``YOC+0.5*ZOA``."""
    text = ""
    for name, amount in amounts.items():
        factor = "" if abs(abs(amount) - 1.0) < 5e-4 else f"{abs(amount):.4g}*"
        sign = "-" if amount < 0.0 else "+" if text else ""
        text += f"{sign}{factor}{name}"
    return text


def names_of(letter: str) -> tuple[str, ...]:
    """Name the parameters of an axis in the firmware's order: two offsets, two tilts, the zero."""
    others = [i for i, own in enumerate(LETTERS) if own != letter]
    offsets = (f"{'XYZ'[i]}O{letter}" for i in others)
    tilts = (f"{LETTERS[i]}O{letter}" for i in others)
    return (*offsets, *tilts, f"{letter}O{letter}")


def fit(
    machine: Machine,
    points: Points,
    *,
    free: Collection[str] | None = None,
    touches: int | None = None,
) -> Fit:
    """Fit location errors to n points.

    Args:
        machine: As believed.
        points: Where the sphere was found.
        free: What is to be fitted; the rest is as believed. None for all but the zeros.
        touches: Each centre comes from so many touches around the sphere and one on its pole, so
            that it scatters more along the tool. None: it scatters alike in all directions.

    Raises:
        NoFitError: There are too few points, or they do not fit the machine.
    """
    ffi, library = connection()
    result = ffi.new("kinematics_result_t *")
    rows = point_rows(machine, points)
    given = ffi.from_buffer("kinematics_point_t[]", rows)
    filled = _machine(ffi, machine)
    if free is not None:
        for axis, place in zip(machine.axes, filled.axes, strict=False):
            *lines, zero = names_of(axis.letter)
            place.is_held = [name not in free for name in lines]
            place.zero_is_free = zero in free
    if touches is not None:  # a coordinate of a circle's centre has 2/n of a touch's variance
        filled.axial_scatter = math.sqrt(touches / 2.0)
    code = library.sim_kinematics_fit(filled, given, len(points), result)
    _refuse(library, code, len(points))
    return _fit(ffi, library, machine, result)


def recommend(machine: Machine, points: Points, most: int) -> tuple[Points, Fit]:
    """Give further positions that determine what is undetermined, and what would then be left.

    Args:
        machine: The machine; positions keep to its travel.
        points: At least one point.
        most: Positions recommended at most.

    Raises:
        NoFitError: There is no point.
    """
    ffi, library = connection()
    travel = ffi.new("kinematics_travel_t *")
    for j, axis in enumerate(machine.axes):
        travel.low_deg[j], travel.high_deg[j] = axis.travel_deg
    rows = point_rows(machine, points)
    more = np.zeros((most, AXES_MAX + 3))
    after = ffi.new("kinematics_result_t *")
    found = library.sim_kinematics_recommend(
        _machine(ffi, machine),
        ffi.from_buffer("kinematics_point_t[]", rows),
        len(points),
        travel,
        most,
        ffi.from_buffer("kinematics_point_t[]", more, require_writable=True),
        after,
    )
    _refuse(library, min(found, 0), len(points))
    angles_deg = more[:found, : len(machine.axes)]
    positions_mm = more[:found, AXES_MAX:] - machine.tip_shift_mm
    new = Points(angles_deg, positions_mm + _compensated_mm(machine, angles_deg))
    return new, _fit(ffi, library, machine, after)


def _machine(ffi: CData, machine: Machine) -> CData:
    given = ffi.new("kinematics_machine_t *")
    given.axes_count = len(machine.axes)
    for place, axis in zip(given.axes, machine.axes, strict=False):
        place.letter = ord(axis.letter)
        place.is_head = axis.in_head
        place.direction = axis.direction
        place.point_mm = axis.point_mm
    if machine.tool_mm is not None:
        given.tool_is_known = 1
        given.tool_mm = list(np.add(machine.tool_mm, machine.tip_shift_mm))
    return given


def point_rows(machine: Machine, points: Points) -> NDArray[np.float64]:
    """Lay the points out as kinematics_point_t: shape (n, AXES_MAX + 3).

    The firmware's coordinates are where the tip is; readings are so since the tip last moved, and
    but for what the table of cycle 453 adds to them.
    """
    rows = np.zeros((len(points), AXES_MAX + 3))
    rows[:, : points.angles_deg.shape[1]] = points.angles_deg
    added_mm = _compensated_mm(machine, points.angles_deg)
    rows[:, AXES_MAX:] = points.positions_mm + np.array(machine.tip_shift_mm) - added_mm
    return rows


def _compensated_mm(machine: Machine, angles_deg: FloatArray) -> FloatArray:
    """Give what the table of cycle 453 has at n positions of the machine's axes; shape (n, 3)."""
    shown_deg = np.zeros((len(angles_deg), len(LETTERS)))
    shown_deg[:, [LETTERS.index(letter) for letter in machine.letters]] = angles_deg
    return compensation_mm(machine, shown_deg)


def _refuse(library: CData, code: int, count: int) -> None:
    if code == library.KINEMATICS_ERR_TOO_FEW:
        positions = "position" if count == 1 else "positions"
        raise TooFewError(f"{count} {positions}: too few to tell location errors from scatter")
    if code == library.KINEMATICS_ERR_NO_FIT:
        raise NoFitError("the points fit no machine within 1 m and 30° of the one described")
    if code != library.KINEMATICS_OK:
        raise NoFitError("a value of the machine or of the points is out of range")


def _fit(ffi: CData, library: CData, machine: Machine, result: CData) -> Fit:
    names = [ffi.string(p.name).decode() for p in result.parameters[0 : result.parameters_count]]
    blind = result.blind[0 : result.blind_count]
    undetermined = tuple(_undetermined(b, names) for b in blind)
    parameters: dict[str, Estimate] = {}
    combinations: list[Combination] = []
    for i, name in enumerate(names):
        given = result.parameters[i]
        estimate = Estimate(given.value, given.uncertainty, "arcsec" if given.is_angle else "µm")
        if given.state == library.KINEMATICS_DETERMINED:
            parameters[name] = estimate
        elif given.state == library.KINEMATICS_COMBINED:
            mixed = {
                change.own: -b.per_unit[i]
                for change, b in zip(undetermined, blind, strict=True)
                if not change.is_zero and abs(b.per_unit[i]) > SHARE_MIN
            }
            combinations.append(Combination({name: 1.0, **mixed}, estimate))
    return Fit(
        parameters,
        tuple(combinations),
        undetermined,
        result.residual_um,
        tuple(result.sphere_mm),
        cast(Vector, tuple(np.subtract(list(result.tip_mm), machine.tip_shift_mm).tolist())),
        result.unknowns,
        result.rank,
        result.freedom,
    )


def _undetermined(blind: CData, names: list[str]) -> Undetermined:
    own = names[blind.parameter]
    amounts = {own: 1.0}
    for i, name in enumerate(names):
        if blind.named[i]:
            amounts[name] = blind.per_unit[i]
    against = (("sphere", blind.with_sphere), ("tip", blind.with_tip))
    return Undetermined(own, amounts, tuple(what for what, seen in against if seen))
