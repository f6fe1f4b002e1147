"""What the measurements of cycles 451 and 452 say of each axis, before and after a correction.

An error is measured minus expected, both relative to the measurement at 0°, the reference.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import radians
from typing import cast

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.axis_report import Expectation, Results, expected_mm, results
from skiplatch.kinematics.correction import (
    CHECK,
    POSITIONS,
    Correction,
    Measured,
    corrections,
    keep_preset,
)
from skiplatch.kinematics.evaluation import AxisResult, Evaluation
from skiplatch.kinematics.firmware import Fit, NoFitError, fit
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.machine import LETTERS, Machine, Vector
from skiplatch.kinematics.outliers import Judged, without_outliers
from skiplatch.kinematics.points import Points
from skiplatch.kinematics.stations import Stations

SLOPE_STEP_DEG = 1e-3
ROUNDING_MM = 1e-9


def _shift_mm(believed: Machine, corrected: Machine) -> Vector:
    """Give Q147 to Q149: shift of the line of the last axis that has that coordinate."""
    found = [0.0, 0.0, 0.0]
    for before, after in zip(believed.axes, corrected.axes, strict=True):
        for i in range(3):
            if abs(before.direction[i]) < 0.5:
                found[i] = after.point_mm[i] - before.point_mm[i]
    return found[0], found[1], found[2]


def _shown_more_deg(before: Machine, after: Machine) -> FloatArray:
    """Give by how much A, B, C show more after a change of datums, where they stand; shape (3,)."""
    more_deg = np.zeros(len(LETTERS))
    for old, new in zip(before.axes, after.axes, strict=True):
        more_deg[LETTERS.index(old.letter)] = new.datum_deg - old.datum_deg
    return more_deg


def _shown(measured: Measured, machine: Machine, more_deg: FloatArray) -> Measured:
    """Give the positions as the axes show them after a change of datums."""
    points, order = measured.points, [LETTERS.index(letter) for letter in machine.letters]
    shown = replace(points, angles_deg=points.angles_deg + more_deg[order])
    return replace(measured, points=shown)


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What a correction leaves at the stations.

    Attributes:
        correction: The correction.
        expected: What was expected before and after it.
        reports: The firmware's report on each measured axis.
        q_mm: Q141 to Q149.
    """

    correction: Correction
    expected: Expectation
    reports: Mapping[str, Results]
    q_mm: Mapping[int, float]

    def worse_than(self, other: "_Seen") -> frozenset[str]:
        """Name the axes that scatter more than after another correction."""
        return frozenset(
            letter
            for letter, report in self.reports.items()
            if report.scatter_after_mm > other.reports[letter].scatter_after_mm + ROUNDING_MM
        )


def evaluate(
    machine: Machine,
    truth: Truth,
    stations: Stations,
    mode: int,
    touches: int,
    recorded: Points | None = None,
    preset_mm: Vector | None = None,
) -> Evaluation:
    """Fit the location errors and tell what each axis shows before and after the correction.

    Of a position approached from both sides the side of the reference counts; the other is for the
    backlash. With too few positions for tilts the location errors are those of the correction.

    Args:
        machine: As believed.
        truth: What the simulated machine knows of its tip and sphere.
        stations: What was measured.
        mode: Q406.
        touches: Q423.
        recorded: Positions of a real machine that count in the fit, stations or not; the place of a
            tip that the machine does not tell is then unknown. None: the stations of the simulated
            one, whose tip stands at 0 where nothing else is said.
        preset_mm: Where the sphere was at zero when the preset was set that cycle 452 keeps.

    Raises:
        NoFitError: The positions are too few.
    """
    known, points = machine, recorded
    if points is None:
        known = replace(machine, tool_mm=machine.tool_mm or (0.0, 0.0, 0.0))
        points = _points_of(machine, stations)
    letters = stations.letters()
    judged = without_outliers(known, points, touches) if letters else Judged(points, ())
    measured = Measured(judged.kept, touches, letters)
    plain = next(corrections(POSITIONS, known, measured)) if letters else _as_it_was(known, points)
    if preset_mm is not None:
        found_mm = _sphere_mm(plain.machine, truth, stations)
        plain = keep_preset(plain, _difference(found_mm, preset_mm), letters)
    see = partial(_see, _with_tip(known, measured), truth, stations, mode, measured)
    seen = see(plain)
    if mode > POSITIONS:
        seen = _no_worse_than(seen, map(see, corrections(mode, known, measured)), see)
    try:
        found = fit(known, judged.kept, touches=touches)
    except NoFitError:
        found = seen.correction.fit
    return Evaluation(
        mode,
        machine,
        replace(seen.correction.machine, tool_mm=machine.tool_mm),
        found,
        tuple(_axis(x, stations, seen.expected, report) for x, report in seen.reports.items()),
        seen.q_mm,
        seen.correction.combined,
        judged.outliers,
        seen.correction.preset_off_mm,
    )


def _sphere_mm(machine: Machine, truth: Truth, stations: Stations) -> FloatArray:
    """Give where the sphere is at zero by the references, shape (3,)."""
    first = stations.is_reference
    angles_deg, centres_mm = stations.angle_deg[first], stations.centre_mm[first]
    return np.asarray(np.mean(turned_back(machine, truth, angles_deg, centres_mm), axis=0))


def _difference(after: FloatArray, before: Vector) -> Vector:
    return cast(Vector, tuple(np.subtract(after, before).tolist()))


def _as_it_was(machine: Machine, points: Points) -> Correction:
    """Change no axis: the sphere alone was measured, with every axis at 0."""
    sphere_mm = np.add(np.mean(points.positions_mm, axis=0), machine.tip_shift_mm)
    place = cast(Vector, tuple(sphere_mm.tolist()))
    alone = Fit({}, (), (), 0.0, place, machine.tool_mm or place, len(place), len(place), 0)
    return Correction(machine, alone)


def _no_worse_than(
    plain: _Seen, tried: Iterable[_Seen], see: Callable[[Correction], _Seen]
) -> _Seen:
    """Give the first correction of angles that leaves no more at any axis than positions alone.

    Least squares weigh all positions together, the scatter goes from each axis's reference: an axis
    may scatter more by a part of the noise. It is then corrected as in `plain`, and if that does
    not do, fewer angles are.
    """
    for one in tried:
        worse = one.worse_than(plain)
        if not worse:
            return one
        axes = tuple(
            old if old.letter in worse else new
            for old, new in zip(
                plain.correction.machine.axes, one.correction.machine.axes, strict=True
            )
        )
        corrected = replace(one.correction.machine, axes=axes)
        mixed = see(replace(one.correction, machine=corrected))
        if not mixed.worse_than(plain):
            return mixed
    return plain


def _points_of(machine: Machine, stations: Stations) -> Points:
    first = ~stations.is_second
    order = [LETTERS.index(letter) for letter in machine.letters]
    return Points(stations.angle_deg[first][:, order], stations.centre_mm[first])


def has_unknown_tip(machine: Machine) -> bool:
    """Tell whether a head turns a tip that nobody has told the place of."""
    return machine.tool_mm is None and any(axis.in_head for axis in machine.axes)


def _with_tip(machine: Machine, measured: Measured) -> Machine:
    """Place a tip that nobody has told where the machine's axes have it."""
    if not has_unknown_tip(machine):
        return machine
    return replace(machine, tool_mm=fit(machine, measured.points, free=()).tip_mm)


def _see(
    machine: Machine,
    truth: Truth,
    stations: Stations,
    mode: int,
    measured: Measured,
    correction: Correction,
) -> _Seen:
    more_deg = _shown_more_deg(machine, correction.machine)
    corrected = _with_tip(correction.machine, _shown(measured, machine, more_deg))
    corrected_stations = replace(stations, angle_deg=stations.angle_deg + more_deg)
    expected = Expectation(
        before_mm=_expected(machine, truth, stations),
        after_mm=_expected(corrected, truth, corrected_stations),
        slope_mm=_slopes(corrected, truth, corrected_stations),
        offset_mm=correction.preset_off_mm or _shift_mm(machine, corrected),
        is_optimised=mode != CHECK,
    )
    return _Seen(correction, expected, *results(stations, expected))


def _axis(letter: str, stations: Stations, expected: Expectation, report: Results) -> AxisResult:
    own = stations.of(letter) & ~stations.is_reference & ~stations.is_second
    return AxisResult(
        letter,
        stations.angle_deg[own, LETTERS.index(letter)],
        (stations.centre_mm - expected.before_mm)[own],
        (stations.centre_mm - expected.after_mm)[own],
        report,
    )


def _expected(machine: Machine, truth: Truth, stations: Stations) -> FloatArray:
    """Give where the sphere is expected when it stands where the reference was measured, (n, 3)."""
    expected = stations.centre_mm.copy()
    for axis in range(len(LETTERS)):
        own = stations.of(LETTERS[axis])
        if np.any(own):
            first = np.flatnonzero(own & stations.is_reference)[:1]
            sphere_mm = turned_back(
                machine, truth, stations.angle_deg[first], stations.centre_mm[first]
            )
            others = own & ~stations.is_reference
            angles_deg = stations.angle_deg[others]
            expected[others] = expected_mm(machine, truth, sphere_mm, angles_deg)
    return expected


def turned_back(
    machine: Machine, truth: Truth, angles_deg: FloatArray, centres_mm: FloatArray
) -> FloatArray:
    """Give where n spheres are at zero; what is read is linear in that. All shapes are (n, 3)."""
    spheres_mm = np.vstack([np.zeros(3), np.eye(3)])
    count = len(angles_deg)
    read = expected_mm(
        machine, truth, np.tile(spheres_mm, (count, 1)), np.repeat(angles_deg, 4, axis=0)
    ).reshape(count, 4, 3)
    origins, images = read[:, 0], read[:, 1:] - read[:, :1]
    right = (centres_mm - origins)[:, :, np.newaxis]
    return np.asarray(np.linalg.solve(images.transpose(0, 2, 1), right)[:, :, 0])


def _slopes(machine: Machine, truth: Truth, stations: Stations) -> FloatArray:
    """Give how the expected reading moves while the station's axis turns, mm/rad; shape (n, 3)."""
    angles_deg = stations.angle_deg
    spheres_mm = turned_back(machine, truth, angles_deg, stations.centre_mm)
    steps_deg = SLOPE_STEP_DEG * np.eye(3)[stations.axis]
    ahead = expected_mm(machine, truth, spheres_mm, angles_deg + steps_deg)
    behind = expected_mm(machine, truth, spheres_mm, angles_deg - steps_deg)
    return (ahead - behind) / radians(2.0 * SLOPE_STEP_DEG)
