"""Cycles 451, 452 and 453 on the simulated machine, with the evaluation by ``firmware/comp``."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Nominal
from skiplatch.kinematics.five_axis import (
    CONTROLLER,
    DEFAULT_RIG,
    FEED_MM_MIN,
    Truth,
    machine_structure,
    path_code,
    refuse,
)
from skiplatch.kinematics.machine import LETTERS, Machine
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import SimulationError, connection
from skiplatch.simulator.rig import filled_rig

CData = Any
WORDS = {"FMAX": 1, "FAUTO": 2, "PREDEF": 4}
MOST_STATIONS = 256
MEASURE_KINEMATICS, COMPENSATE_PRESET, KINEMATICS_GRID = 451, 452, 453
UNKNOWN = 1
"""KINEMATICS_SETTING_UNKNOWN: the cycle has no such parameter."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """How the controller is set up; see ``sim_control_t``."""

    hirth_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tip_radius_mm: float = 3.0
    set_up_mm: float = 6.0
    probe_feed_max_mm_min: float = 3000.0
    rapid_mm_min: float = 15_000.0
    tool_feed_mm_min: float = 1000.0
    global_feed_mm_min: float = 1000.0
    global_clearance_mm: float = 2.0
    max_modification_mm: float = 1.0
    max_dev_cal_ball_mm: float = 0.1
    start_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    preset_miss_mm: tuple[float, float, float] = (0.05, -0.03, 0.02)
    start_above_mm: float = 10.0
    touch_feed_mm_min: float = FEED_MM_MIN
    search_mm: float = 6.0
    strobe_rot_ax_pos: int = -1
    has_kinematics_opt: bool = True
    has_kinematics_comp: bool = True
    has_advanced_functions_2: bool = True
    is_tcpm_on: bool = False
    is_turning: bool = False
    track: bool = False
    path: InputPath = InputPath.SKIP


@dataclass(frozen=True, slots=True)
class Stations:
    """The measurements of one cycle, n of them.

    Attributes:
        angle_deg: What A, B, C were told, shape (n, 3).
        centre_mm: The sphere's centre, shape (n, 3).
        radius_mm: Its radius, shape (n,).
        axis: Index of the axis that was being measured, shape (n,).
        serves: Bits of the axes whose measurement it is, shape (n,).
        approach: 1 or -1 for the sense in which the axis came, 0 as it comes, shape (n,).
        is_reference: The axis stood at 0°, shape (n,).
        is_second: It is the second of two approaches to one position, shape (n,).
    """

    angle_deg: FloatArray
    centre_mm: FloatArray
    radius_mm: FloatArray
    axis: NDArray[np.int64]
    serves: NDArray[np.int64]
    approach: NDArray[np.int64]
    is_reference: NDArray[np.bool_]
    is_second: NDArray[np.bool_]

    def of(self, letter: str) -> NDArray[np.bool_]:
        """Tell which measurements are those of an axis; shape (n,)."""
        return np.asarray((self.serves >> LETTERS.index(letter)) & 1 == 1)

    def letters(self) -> frozenset[str]:
        """Name the axes that were measured."""
        return frozenset(letter for letter in LETTERS if np.any(self.of(letter)))

    def has_second(self, letter: str) -> bool:
        """Tell whether an axis was approached from both sides."""
        return bool(np.any(self.is_second & (self.axis == LETTERS.index(letter))))


@dataclass(frozen=True, slots=True)
class Report:
    """What came of a cycle; see ``sim_451_report_t``."""

    preset_mm: tuple[float, ...]
    change_mm: float
    duration_s: float
    touches: int
    error: int
    parameter: int
    touch_error: int
    cancelled_rotation: int
    presets: int
    is_tilted: int
    tilt_deg: tuple[float, ...]


class CycleRefusedError(Exception):
    """The firmware refused a parameter, or ended the cycle.

    Attributes:
        parameter: Number of the Q parameter at fault, 0 for none.
        limits: What the cycle admits, where the value is not.
    """

    def __init__(self, parameter: int, message: str, limits: "Setting | None" = None) -> None:
        super().__init__(message)
        self.parameter = parameter
        self.limits = limits


@dataclass(slots=True)
class Play:
    """One cycle on one machine; `opened` gives it."""

    _handle: CData
    _cycle: int
    _asked: int = field(default=0)

    def set(self, number: int, value: float | str) -> None:
        """Give Q<number> a number or a word.

        Raises:
            CycleRefusedError: The cycle does not admit it.
        """
        ffi, lib = connection()
        word = WORDS.get(value, 0) if isinstance(value, str) else 0
        code = lib.sim_451_set(
            self._handle, number, 0.0 if isinstance(value, str) else float(value), word
        )
        if code != 0:
            phrase = ffi.string(lib.sim_451_phrase(code)).decode()
            limits = None if code == UNKNOWN else setting(number, self._cycle)
            raise CycleRefusedError(number, f"Q{number} {phrase}", limits)

    def begin(self) -> bool:
        """Start and run until the measurements wait for their evaluation; False if it failed."""
        _, lib = connection()
        self._asked = lib.sim_451_run(self._handle)
        return bool(self._asked == lib.SIM_451_EVALUATE)

    def begin_measured(self, stations: Stations) -> bool:
        """Start with what was measured elsewhere; False if the cycle refused it."""
        _, lib = connection()
        self._asked = lib.sim_451_run_measured(self._handle, _rows(stations), len(stations.axis))
        return bool(self._asked == lib.SIM_451_EVALUATE)

    def answer(self, change_mm: float = 0.0, *, is_possible: bool = True) -> None:
        """Answer what the cycle came back for, and run on."""
        _, lib = connection()
        self._asked = lib.sim_451_answer(self._handle, change_mm, int(is_possible))

    @property
    def asks(self) -> str:
        """What the cycle came back for: evaluate, acknowledge, apply, clear, done or failed."""
        return ("evaluate", "acknowledge", "apply", "done", "failed", "clear")[self._asked]

    def conclude(
        self, change_mm: float, corrected: Machine, truth: Truth, *, acknowledged: bool
    ) -> list[str]:
        """Answer an evaluation, and carry out what it leads to; give warnings, a sentence each.

        Args:
            change_mm: The greatest change that the evaluation would make.
            corrected: What is believed where the cycle applies it.
            truth: What the simulated machine knows of its tip.
            acknowledged: The operator presses NC start where a change exceeds maxModification.

        Raises:
            CycleRefusedError: The cycle ended with an error.
        """
        warnings: list[str] = []
        self.answer(change_mm)
        while self.asks in ("acknowledge", "apply"):
            if self.asks == "acknowledge":
                change_mm = self.report().change_mm
                warnings.append(f"Warning: a change of {change_mm:.4f} mm exceeds maxModification.")
                self.answer(is_possible=acknowledged)
            else:
                self.believe(corrected, truth)
                self.answer()
        if self.asks != "done":
            self.raise_failure()
        return warnings

    def believe(self, machine: Machine, truth: Truth) -> None:
        """Let the controller believe something else of its axes."""
        _, lib = connection()
        lib.sim_451_believe(self._handle, machine_structure(machine, truth))

    def stations(self) -> Stations:
        """Give what was measured so far."""
        ffi, lib = connection()
        rows = ffi.new("sim_station_t[]", MOST_STATIONS)
        measured = rows[0 : lib.sim_451_stations(self._handle, rows, MOST_STATIONS)]
        return Stations(
            np.array([list(row.angle_deg) for row in measured]).reshape(-1, 3),
            np.array([list(row.centre_mm) for row in measured]).reshape(-1, 3),
            np.array([row.radius_mm for row in measured]),
            np.array([row.axis for row in measured], dtype=np.int64),
            np.array([row.serves for row in measured], dtype=np.int64),
            np.array([row.approach for row in measured], dtype=np.int64),
            np.array([row.is_reference != 0 for row in measured], dtype=np.bool_),
            np.array([row.is_second != 0 for row in measured], dtype=np.bool_),
        )

    def report(self) -> Report:
        """Give what the cycle did."""
        ffi, lib = connection()
        filled = ffi.new("sim_451_report_t *")
        lib.sim_451_report(self._handle, filled)
        values = {f.name: getattr(filled, f.name) for f in fields(Report)}
        for name in ("preset_mm", "tilt_deg"):
            values[name] = tuple(getattr(filled, name))
        return Report(**values)

    def raise_failure(self) -> None:
        """Say why the cycle failed.

        Raises:
            CycleRefusedError: Always.
        """
        ffi, lib = connection()
        report = self.report()
        phrase = ffi.string(lib.sim_451_fault_phrase(report.error)).decode()
        named = f"Q{report.parameter}: " if report.parameter else ""
        raise CycleRefusedError(report.parameter, f"{named}{phrase}")


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter of the cycle as the firmware's table has it."""

    name: str
    low: float
    high: float
    initial: float


def setting(number: int, cycle: int = MEASURE_KINEMATICS) -> Setting | None:
    """Describe Q<number> of a cycle; None if it has no such parameter."""
    ffi, lib = connection()
    low, high, initial = (ffi.new("double *") for _ in range(3))
    name = lib.sim_451_limits(cycle, number, low, high, initial)
    return Setting(ffi.string(name).decode(), low[0], high[0], initial[0]) if name else None


@contextmanager
def opened(
    machine: Machine,
    truth: Truth,
    control: Control,
    parameters: Mapping[int, float | str],
    *,
    believed: Machine | None = None,
    seed: int,
    replicate: int = 0,
    rig: Nominal = DEFAULT_RIG,
    switched_on: Sequence[Effect] = (),
    cycle: int = MEASURE_KINEMATICS,
    preset_mm: Sequence[float] | None = None,
) -> Iterator[Play]:
    """Switch a machine on, with the parameters of a cycle set.

    Args:
        machine: The description that the truth stands beside.
        truth: How the machine truly is.
        control: How the controller is set up.
        parameters: Numbers and words by the number of the Q parameter.
        believed: What the controller believes, None for `machine`.
        seed: Picks the random numbers, with the replicate.
        replicate: Which of many runs.
        rig: Probe, input, axes.
        switched_on: Effects of the table on every touch.
        cycle: 451, 452 or 453.
        preset_mm: Where the sphere was at zero when the preset was set that cycle 452 keeps; None:
            the operator has just set one.

    Raises:
        CycleRefusedError: A parameter is not admitted.
        SimulationError: A value of the rig is out of range.
    """
    ffi, lib = connection()
    structure = machine_structure(machine, truth)
    place = ffi.new("sim_451_t **")
    switched = filled_rig(rig, CONTROLLER, switched_on, seed=seed, replicate=replicate)
    code = lib.sim_451_open(
        switched.structure,
        structure,
        machine_structure(believed or machine, truth),
        _control(control),
        place,
    )
    refuse(code)
    handle = place[0]
    try:
        play = Play(handle, cycle)
        if cycle == KINEMATICS_GRID:
            lib.sim_451_measure_grid(handle)
        elif preset_mm is not None:
            lib.sim_451_keep_preset(handle, list(preset_mm))
        for number, value in parameters.items():
            play.set(number, value)
        yield play
    finally:
        lib.sim_451_close(handle)


def _control(control: Control) -> CData:
    ffi, _ = connection()
    filled = ffi.new("sim_control_t *")
    for item in fields(Control):
        value = getattr(control, item.name)
        setattr(filled, item.name, list(value) if isinstance(value, tuple) else value)
    filled.path = path_code(control.path)
    return filled


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
    if lib.sim_451_results(_rows(stations), len(stations.axis), filled, axes, q_mm) != 0:
        raise SimulationError("more stations than a cycle has")
    found = {
        letter: Results(**{f.name: getattr(axis, f.name) for f in fields(Results)})
        for letter, axis in zip(LETTERS, axes, strict=True)
        if axis.positions
    }
    return found, dict(zip(range(141, 150), q_mm, strict=True))


def _rows(stations: Stations) -> CData:
    ffi, _ = connection()
    rows = ffi.new("sim_station_t[]", len(stations.axis))
    for i, row in enumerate(rows):
        row.angle_deg = list(stations.angle_deg[i])
        row.centre_mm = list(stations.centre_mm[i])
        for name in ("radius_mm", "axis", "serves", "approach", "is_reference", "is_second"):
            setattr(row, name, getattr(stations, name)[i].item())
    return rows
