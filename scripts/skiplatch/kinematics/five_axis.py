"""The simulated five-axis machine, whose every touch is latched by the firmware.

What the machine truly is stands in a `Truth`: location errors beside what is believed, and the
errors of its axes. ``host_sim/five_axis.h`` says what each of them does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from math import radians
from typing import Any

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import (
    AxisNominal,
    BenchNominal,
    InputNominal,
    InputPath,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
)
from skiplatch.kinematics.grid import Grid
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import SimulationError, connection
from skiplatch.simulator.rig import Controller, filled_rig
from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM

CData = Any

DEFAULT_RIG = Nominal(
    kind=Kind.MACHINE,
    probe=ProbeNominal(
        pretravel_um=8.0, lobe_um=0.3, lobe_phase_deg=20.0, repeatability_um=0.25, delay_us=20.0
    ),
    input=InputNominal(filter_us=5.0),
    skip=SkipNominal(latency_us=2.0, jitter_us=1.0, tick_us=0.1),
    plc=PlcNominal(scan_us=4000.0),
    axis=AxisNominal(resolution_um=0.01, accel_mm_s2=3000.0),
    report=ReportNominal(latency_us=0.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.0),
)
"""A touch-trigger probe on a machine."""

CONTROLLER = Controller(overtravel_mm=10.0, reaction_us=2000.0)
FEED_MM_MIN = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RotaryTruth:
    """How one rotary axis truly is; see ``sim_rotary_t``."""

    offset_um: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilt_arcsec: tuple[float, float, float] = (0.0, 0.0, 0.0)
    zero_arcsec: float = 0.0
    backlash_arcsec: float = 0.0
    once_arcsec: float = 0.0
    once_phase_deg: float = 0.0
    twice_arcsec: float = 0.0
    twice_phase_deg: float = 0.0
    radial_um: float = 0.0
    axial_um: float = 0.0
    repeatability_arcsec: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """How the machine truly is.

    Attributes:
        axes: The rotary axes by letter; one that is not named has no error.
        sphere_mm: Centre of the sphere with all rotary axes at zero.
        sphere_radius_mm: Its radius.
        tip_radius_mm: That of the probe's ball.
        scale_ppm: How much longer X, Y, Z are than they show.
        square_arcsec: How much the second axis of XY, XZ, YZ leans towards the first.
        tip_um: How far the tip is from where it is believed: another head, a drift.
    """

    axes: Mapping[str, RotaryTruth] = field(default_factory=dict)
    sphere_mm: tuple[float, float, float] = (120.0, 60.0, 80.0)
    sphere_radius_mm: float = 12.5
    tip_radius_mm: float = 3.0
    scale_ppm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    square_arcsec: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tip_um: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Probing:
    """How each sphere is probed; see ``sim_probing_t``."""

    feed_mm_min: float = FEED_MM_MIN
    stand_off_mm: float = 6.0
    search_mm: float = 6.0
    reference_deg: float = 0.0
    touches: int = 4
    path: InputPath = InputPath.SKIP


def machine_structure(machine: Machine, truth: Truth) -> CData:
    """Fill sim_machine_t: what is believed, and beside it what is true."""
    ffi, _ = connection()
    filled = ffi.new("sim_machine_t *")
    filled.table = _list(machine, is_head=False)
    filled.head = _list(machine, is_head=True)
    for letter, rotary in zip(LETTERS, filled.axes, strict=True):
        _fill_rotary(rotary, truth.axes.get(letter, RotaryTruth()))
        rotary.direction = [float(coordinate == letter) for coordinate in LETTERS]
    for axis in machine.axes:
        rotary = filled.axes[LETTERS.index(axis.letter)]
        rotary.direction = list(axis.direction)
        rotary.point_mm = list(axis.point_mm)
        rotary.datum_deg = axis.datum_deg
    filled.tool_mm = list(machine.tool_mm or (0.0, 0.0, 0.0))
    filled.tip_mm = list(machine.tip_shift_mm)
    if machine.grid is not None:
        _fill_grid(filled.grid, machine.grid)
    filled.tip_error_mm = [value / UM_PER_MM for value in truth.tip_um]
    filled.sphere_mm = list(truth.sphere_mm)
    filled.sphere_radius_mm = truth.sphere_radius_mm
    filled.tip_radius_mm = truth.tip_radius_mm
    filled.scale_ppm = list(truth.scale_ppm)
    filled.square_rad = [radians(value / ARCSEC_PER_DEG) for value in truth.square_arcsec]
    return filled


def _list(machine: Machine, *, is_head: bool) -> list[int]:
    listed = [LETTERS.index(a.letter) for a in machine.axes if a.in_head == is_head]
    return listed + [-1] * (len(LETTERS) - len(listed))


def _fill_grid(filled: CData, grid: Grid) -> None:
    filled.count = [len(nodes) for nodes in grid.nodes_deg]
    filled.node_deg = [list(nodes) for nodes in grid.nodes_deg]
    filled.offset_mm = [list(row) for row in grid.table_mm]


def compensation_mm(machine: Machine, angles_deg: FloatArray) -> FloatArray:
    """Give what the table of cycle 453 has at n positions of A, B, C; both shapes are (n, 3)."""
    if machine.grid is None or not machine.grid.offset_mm:
        return np.zeros_like(angles_deg)
    ffi, lib = connection()
    structure = machine_structure(machine, Truth())
    offset = ffi.new("double[3]")
    rows = []
    for angles in angles_deg.tolist():
        lib.sim_machine_compensation(structure, angles, offset)
        rows.append(list(offset))
    return np.array(rows).reshape(-1, len(LETTERS))


def _fill_rotary(rotary: CData, truth: RotaryTruth) -> None:
    rotary.offset_mm = [value / UM_PER_MM for value in truth.offset_um]
    rotary.tilt_rad = [radians(value / ARCSEC_PER_DEG) for value in truth.tilt_arcsec]
    for name in ("zero", "backlash", "once", "twice", "repeatability"):
        setattr(rotary, f"{name}_deg", getattr(truth, f"{name}_arcsec") / ARCSEC_PER_DEG)
    rotary.once_phase_deg = truth.once_phase_deg
    rotary.twice_phase_deg = truth.twice_phase_deg
    rotary.radial_mm = truth.radial_um / UM_PER_MM
    rotary.axial_mm = truth.axial_um / UM_PER_MM


def probe_points(
    machine: Machine,
    truth: Truth,
    angles_deg: FloatArray,
    *,
    seed: int,
    replicate: int = 0,
    probing: Probing | None = None,
    rig: Nominal = DEFAULT_RIG,
    switched_on: Sequence[Effect] = (),
) -> FloatArray:
    """Measure the sphere at positions of A, B, C, one after the other, by real touches.

    Args:
        machine: What is believed; the tip goes where that expects the sphere.
        truth: What is true.
        angles_deg: Shape (n, 3).
        seed: Picks the random numbers, with the replicate.
        replicate: Which of many machines that are switched on anew.
        probing: How each sphere is probed.
        rig: Probe, input, axes.
        switched_on: Effects of the table on every touch.

    Returns:
        Centres in mm, shape (n, 3), in machine coordinates.

    Raises:
        SimulationError: A touch failed, or a value is out of range.
    """
    ffi, lib = connection()
    spheres = ffi.new("sim_sphere_t[]", len(angles_deg))
    for sphere, angles in zip(spheres, angles_deg, strict=True):
        sphere.angle_deg = [float(angle) for angle in angles]
    given = probing or Probing()
    filled = ffi.new("sim_probing_t *")
    for item in fields(Probing):
        setattr(filled, item.name, getattr(given, item.name))
    filled.path = path_code(given.path)
    structure = machine_structure(machine, truth)
    switched = filled_rig(rig, CONTROLLER, switched_on, seed=seed, replicate=replicate)
    measured = lib.sim_five_axis_points(
        switched.structure,
        structure,
        structure,
        filled,
        spheres,
        len(angles_deg),
    )
    refuse(min(measured, 0))
    if measured < len(angles_deg):
        raise SimulationError(f"position {measured + 1}: no sphere where it was expected")
    return np.array([list(sphere.centre_mm) for sphere in spheres]).reshape(-1, len(LETTERS))


def refuse(code: int) -> None:
    """Say what cannot be played.

    Raises:
        SimulationError: The code is one of an error.
    """
    ffi, lib = connection()
    if code != 0:
        raise SimulationError(ffi.string(lib.sim_play_error(code)).decode())


def path_code(path: InputPath) -> int:
    """Give the simulator's code of an input path."""
    _, lib = connection()
    return int(lib.SIM_PATH_PLC if path == InputPath.PLC else lib.SIM_PATH_SKIP)
