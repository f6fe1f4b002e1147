"""Cycles 451, 452 and 453 on the simulated machine."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields

import numpy as np

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
from skiplatch.kinematics.machine import Machine
from skiplatch.kinematics.stations import Stations, station_rows
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import CData, connection
from skiplatch.simulator.rig import filled_rig

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
class Report:
    """What came of a cycle; see ``sim_measure_kinematics_report_t``."""

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
        code = lib.sim_measure_kinematics_set(
            self._handle, number, 0.0 if isinstance(value, str) else float(value), word
        )
        if code != 0:
            phrase = ffi.string(lib.sim_measure_kinematics_phrase(code)).decode()
            limits = None if code == UNKNOWN else setting(number, self._cycle)
            raise CycleRefusedError(number, f"Q{number} {phrase}", limits)

    def begin(self) -> bool:
        """Start and run until the measurements wait for their evaluation; False if it failed."""
        _, lib = connection()
        self._asked = lib.sim_measure_kinematics_run(self._handle)
        return bool(self._asked == lib.SIM_451_EVALUATE)

    def begin_measured(self, stations: Stations) -> bool:
        """Start with what was measured elsewhere; False if the cycle refused it."""
        _, lib = connection()
        self._asked = lib.sim_measure_kinematics_run_measured(
            self._handle, station_rows(stations), len(stations.axis)
        )
        return bool(self._asked == lib.SIM_451_EVALUATE)

    def answer(self, change_mm: float = 0.0, *, is_possible: bool = True) -> None:
        """Answer what the cycle came back for, and run on."""
        _, lib = connection()
        self._asked = lib.sim_measure_kinematics_answer(self._handle, change_mm, int(is_possible))

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
        lib.sim_measure_kinematics_believe(self._handle, machine_structure(machine, truth))

    def stations(self) -> Stations:
        """Give what was measured so far."""
        ffi, lib = connection()
        rows = ffi.new("sim_station_t[]", MOST_STATIONS)
        measured = rows[0 : lib.sim_measure_kinematics_stations(self._handle, rows, MOST_STATIONS)]
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
        filled = ffi.new("sim_measure_kinematics_report_t *")
        lib.sim_measure_kinematics_report(self._handle, filled)
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
        phrase = ffi.string(lib.sim_measure_kinematics_fault_phrase(report.error)).decode()
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
    name = lib.sim_measure_kinematics_limits(cycle, number, low, high, initial)
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
    place = ffi.new("sim_measure_kinematics_t **")
    switched = filled_rig(rig, CONTROLLER, switched_on, seed=seed, replicate=replicate)
    code = lib.sim_measure_kinematics_open(
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
            lib.sim_measure_kinematics_measure_grid(handle)
        elif preset_mm is not None:
            lib.sim_measure_kinematics_keep_preset(handle, list(preset_mm))
        for number, value in parameters.items():
            play.set(number, value)
        yield play
    finally:
        lib.sim_measure_kinematics_close(handle)


def _control(control: Control) -> CData:
    ffi, _ = connection()
    filled = ffi.new("sim_control_t *")
    for item in fields(Control):
        value = getattr(control, item.name)
        setattr(filled, item.name, list(value) if isinstance(value, tuple) else value)
    filled.path = path_code(control.path)
    return filled
