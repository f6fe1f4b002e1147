"""What ``firmware/comp`` expects at the stations, and reports on each axis."""

from dataclasses import dataclass, fields

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.five_axis import (
    Truth,
    machine_structure,
)
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.kinematics.stations import Stations, station_rows
from skiplatch.simulator.library import SimulationError, connection


def expected_mm(
    machine: Machine, truth: Truth, sphere_mm: FloatArray, angles_deg: FloatArray
) -> FloatArray:
    """Give what a sphere should read at n positions, by ``firmware/comp``; shape (n, 3).

    Args:
        machine: As believed.
        truth: What the simulated machine knows of its tip.
        sphere_mm: Where the sphere is at zero, shape (3,), or (n, 3) for n spheres.
        angles_deg: Shape (n, 3).
    """
    ffi, lib = connection()
    structure = machine_structure(machine, truth)
    reading = ffi.new("double[3]")
    rows = []
    for sphere, angles in zip(
        np.broadcast_to(sphere_mm, angles_deg.shape).tolist(), angles_deg.tolist(), strict=True
    ):
        lib.sim_machine_expect(structure, sphere, angles, reading)
        rows.append(list(reading))
    return np.array(rows).reshape(-1, 3)


@dataclass(frozen=True, slots=True, eq=False)
class Expectation:
    """What the firmware's report compares n stations with; see ``kinematics_expectation_t``.

    Attributes:
        before_mm: Where the sphere was expected with the kinematics as they were, shape (n, 3).
        after_mm: The same with the optimised kinematics, shape (n, 3).
        slope_mm: How that moves while the station's axis turns, mm/rad, shape (n, 3).
        offset_mm: Q147 to Q149.
        is_optimised: Q406 is not 0.
    """

    before_mm: FloatArray
    after_mm: FloatArray
    slope_mm: FloatArray
    offset_mm: tuple[float, float, float]
    is_optimised: bool


@dataclass(frozen=True, slots=True)
class Results:
    """What the firmware reports of one axis; see ``kinematics_axis_report_t``."""

    positions: int
    has_backlash: int
    radius_mm: float
    scatter_before_mm: float
    scatter_after_mm: float
    greatest_before_mm: float
    greatest_after_mm: float
    positioning_deg: float
    positioning_scatter_deg: float
    backlash_deg: float


def results(
    stations: Stations, expected: Expectation
) -> tuple[dict[str, Results], dict[int, float]]:
    """Give the firmware's report on each measured axis, and Q141 to Q149 in mm."""
    ffi, lib = connection()
    tables = [
        ffi.from_buffer("double[][3]", np.ascontiguousarray(table, dtype=np.float64))
        for table in (expected.before_mm, expected.after_mm, expected.slope_mm)
    ]
    filled = ffi.new("sim_expectation_t *")
    filled.before_mm, filled.after_mm, filled.slope_mm = tables
    filled.offset_mm = list(expected.offset_mm)
    filled.is_optimised = expected.is_optimised
    axes, q_mm = ffi.new("sim_axis_result_t[3]"), ffi.new("double[9]")
    if (
        lib.sim_measure_kinematics_results(
            station_rows(stations), len(stations.axis), filled, axes, q_mm
        )
        != 0
    ):
        raise SimulationError("more stations than a cycle has")
    found = {
        letter: Results(**{f.name: getattr(axis, f.name) for f in fields(Results)})
        for letter, axis in zip(LETTERS, axes, strict=True)
        if axis.positions
    }
    return found, dict(zip(range(141, 150), q_mm, strict=True))
