"""Running an NC program with cycles 450 to 453 on the simulated five-axis machine."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from skiplatch.errors import InputError
from skiplatch.kinematics.correction import CHECK, POSITIONS
from skiplatch.kinematics.cycle import (
    COMPENSATE_PRESET,
    KINEMATICS_GRID,
    Control,
    CycleRefusedError,
    Play,
    Report,
    opened,
)
from skiplatch.kinematics.evaluate import evaluate, has_unknown_tip, turned_back
from skiplatch.kinematics.evaluation import Evaluation
from skiplatch.kinematics.firmware import NoFitError
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.grid_cycle import play_grid
from skiplatch.kinematics.grid_evaluation import GridEvaluation, NoGridError
from skiplatch.kinematics.machine import Machine, Vector
from skiplatch.kinematics.memory import Memory, run_450
from skiplatch.kinematics.points import Points
from skiplatch.kinematics.program import Cycle, Program
from skiplatch.kinematics.recorded import RecordedError, sort_recorded
from skiplatch.kinematics.run_notes import (
    NO_BACKLASH,
    cancelled_rotation,
    known_in_combination,
    moved_datums,
)
from skiplatch.kinematics.stations import Stations
from skiplatch.simulator.effects import Effect
from skiplatch.units import MM_PER_INCH

LENGTHS = (407, 320, 408, 253)
"""Parameters that are in inches in an inch program."""
SPHERE_RADIUS = 407
MODE = 406
TOUCHES = 423
DEFAULTS = {451: {MODE: CHECK, TOUCHES: 4}, 452: {MODE: POSITIONS, TOUCHES: 4}}
"""Of a cycle's parameters; cycle 452 has no mode but that one."""
SAVE_KINEMATICS = 450
PRESET, NEVER, PRESETS_AFTER = 431, 0.0, (2.0, 3.0)


@dataclass(frozen=True, slots=True)
class Setup:
    """What a program is run on.

    Attributes:
        machine: The description that the truth stands beside, and that is believed at first.
        truth: How the machine truly is.
        control: How the controller is set up.
        seed: Picks the random numbers.
        acknowledged: The operator presses NC start where a change exceeds maxModification.
        switched_on: Effects on every touch.
        recorded: Sphere centres of a real machine, that each cycle evaluates; None: the simulated
            one measures.
        changed: How the machine truly is from the first cycle 452 on; None: as before.
        preset_mm: Where the sphere was at zero when the preset was set that cycle 452 keeps; None:
            where a cycle 451 before it has left it, or the operator.
    """

    machine: Machine
    truth: Truth
    control: Control
    seed: int
    acknowledged: bool
    switched_on: Sequence[Effect] = ()
    recorded: Points | None = None
    changed: Truth | None = None
    preset_mm: Vector | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run of cycle 451, 452 or 453.

    Attributes:
        cycle: Which of them.
        parameters: Q parameters by number, as given; lengths in mm.
        stations: What was measured.
        evaluation: What it says.
        report: What the cycle did.
        notes: What the operator should know, a sentence each.
        tracks: The spindle turned the probe to each touch (TRACK).
        preset_at_0_mm: Where the preset is believed with every axis at 0.
    """

    cycle: int
    parameters: Mapping[int, float | str]
    stations: Stations
    evaluation: Evaluation | GridEvaluation
    report: Report
    notes: tuple[str, ...]
    tracks: bool
    preset_at_0_mm: Vector


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of a program: its runs of 451 to 453, what 450 said, the kinematics at the end."""

    runs: tuple[Run, ...]
    said: tuple[str, ...]
    machine: Machine


def run_program(program: Program, setup: Setup, memory: Memory) -> Outcome:
    """Run the cycles in their order; each begins with what the one before left.

    Raises:
        InputError: A cycle refused a parameter, or ended with an error; nothing is stored then
            but what a cycle 450 before it stored.
    """
    believed = setup.machine
    runs: list[Run] = []
    said: list[str] = []
    for cycle in program.cycles:
        if cycle.number == SAVE_KINEMATICS:
            believed, words = run_450(program, cycle, believed, memory)
            said.append(words)
        else:
            if cycle.number == COMPENSATE_PRESET:
                setup = _changed(program, cycle, setup, believed, runs)
            runs.append(_run_cycle(program, cycle, setup, believed, len(runs)))
            if runs[-1].evaluation.mode != CHECK:
                believed = runs[-1].evaluation.corrected
                memory.activate(believed)
    return Outcome(tuple(runs), tuple(said), believed)


def _changed(
    program: Program, cycle: Cycle, setup: Setup, believed: Machine, runs: Sequence[Run]
) -> Setup:
    """Know the preset that cycle 452 keeps, and let the machine change that has it.

    Raises:
        InputError: Nobody has told where the preset of a real machine was set.
    """
    preset_mm = setup.preset_mm
    if setup.recorded is not None and has_unknown_tip(believed):
        message = "cycle 452: tool_mm is needed of a machine with axes in the head"
        raise InputError(program.path, cycle.line, None, message)
    if runs and (setup.recorded is None or runs[-1].report.presets):
        preset_mm = runs[-1].preset_at_0_mm
    elif preset_mm is None and setup.recorded is not None:
        message = (
            "cycle 452: preset_mm of the machine's description is needed, or a cycle 451 with "
        )
        raise InputError(program.path, cycle.line, None, f"{message}Q431 = 2 or 3 before it")
    elif preset_mm is None:
        with opened(setup.machine, setup.truth, setup.control, {}, seed=setup.seed) as play:
            preset_mm = _at_0_mm(believed, setup.control.start_deg, play.report().preset_mm)
    return replace(setup, truth=setup.changed or setup.truth, changed=None, preset_mm=preset_mm)


def _at_0_mm(believed: Machine, angle_deg: Sequence[float], reading_mm: Sequence[float]) -> Vector:
    """Give where what is read at these angles of A, B, C is believed with every axis at 0."""
    angles, readings = (np.array(values)[np.newaxis] for values in (angle_deg, reading_mm))
    return cast(Vector, tuple(turned_back(believed, Truth(), angles, readings)[0].tolist()))


def _parameters(program: Program, cycle: Cycle) -> dict[int, float | str]:
    scale = MM_PER_INCH if program.is_inch else 1.0
    return {
        number: given.value * scale
        if isinstance(given.value, float) and number in LENGTHS
        else given.value
        for number, given in cycle.parameters.items()
    }


def _run_cycle(program: Program, cycle: Cycle, setup: Setup, believed: Machine, place: int) -> Run:
    parameters = _parameters(program, cycle)
    try:
        with opened(
            setup.machine,
            setup.truth,
            setup.control,
            parameters,
            believed=believed,
            seed=setup.seed,
            replicate=place,
            switched_on=setup.switched_on,
            cycle=cycle.number,
            preset_mm=setup.preset_mm if cycle.number == COMPENSATE_PRESET else None,
        ) as play:
            if cycle.number == KINEMATICS_GRID:
                return _measured_grid(play, parameters, setup, believed)
            return _measured(play, cycle.number, parameters, setup, believed)
    except CycleRefusedError as error:
        given = cycle.parameters.get(error.parameter)
        line, column = (given.line, given.column) if given else (cycle.line, None)
        message = f"cycle {cycle.number}: {error}{_range(error, program)}"
        raise InputError(program.path, line, column, message) from error
    except (NoFitError, NoGridError, RecordedError) as error:
        raise InputError(
            program.path, cycle.line, None, f"cycle {cycle.number}: {error}"
        ) from error


def _range(error: CycleRefusedError, program: Program) -> str:
    """Say what would be admitted, in the units of the program."""
    if (row := error.limits) is None:
        return ""
    is_inch = program.is_inch and error.parameter in LENGTHS
    low, high = (limit / MM_PER_INCH if is_inch else limit for limit in (row.low, row.high))
    return f" ({row.name}: {low:.9g} to {high:.9g}{' inch' if is_inch else ''})"


def _measured(
    play: Play,
    number: int,
    parameters: Mapping[int, float | str],
    setup: Setup,
    believed: Machine,
) -> Run:
    recorded = None
    notes: list[str] = []
    if setup.recorded is not None:
        recorded = sort_recorded(believed, setup.recorded, parameters)
        notes += recorded.notes
    if not (play.begin() if recorded is None else play.begin_measured(recorded.stations)):
        play.raise_failure()
    stations = play.stations()
    mode, touches = (int(parameters.get(q, DEFAULTS[number][q])) for q in (MODE, TOUCHES))
    points = recorded.points if recorded is not None else None
    preset_mm = setup.preset_mm if number == COMPENSATE_PRESET else None
    evaluation = evaluate(believed, setup.truth, stations, mode, touches, points, preset_mm)
    notes += play.conclude(
        evaluation.change_mm, evaluation.corrected, setup.truth, acknowledged=setup.acknowledged
    )
    report = play.report()
    notes += moved_datums(evaluation)
    notes += known_in_combination(evaluation)
    notes += [
        f"Outlier: {outlier.text}. The fit leaves it out: measure it again."
        for outlier in evaluation.outliers
    ]
    loose = [axis.letter for axis in evaluation.axes if not stations.has_second(axis.letter)]
    if loose:
        notes.append(NO_BACKLASH.format(", ".join(loose)))
    notes += cancelled_rotation(report)
    active = evaluation.corrected if mode > CHECK else believed
    at_0_mm = preset_mm or _preset_at_0_mm(active, setup, parameters, stations, report)
    tracks = setup.control.track
    return Run(number, parameters, stations, evaluation, report, tuple(notes), tracks, at_0_mm)


def _measured_grid(
    play: Play, parameters: Mapping[int, float | str], setup: Setup, believed: Machine
) -> Run:
    played = play_grid(
        play,
        parameters,
        believed,
        setup.truth,
        recorded=setup.recorded,
        acknowledged=setup.acknowledged,
    )
    report, found = play.report(), played.evaluation
    active = believed if found.mode == CHECK else found.corrected
    at_0_mm = _preset_at_0_mm(active, setup, parameters, played.stations, report)
    notes = (*played.notes, *cancelled_rotation(report))
    tracks = setup.control.track
    return Run(KINEMATICS_GRID, parameters, played.stations, found, report, notes, tracks, at_0_mm)


def _preset_at_0_mm(
    active: Machine,
    setup: Setup,
    parameters: Mapping[int, float | str],
    stations: Stations,
    report: Report,
) -> Vector:
    """Give where the preset of cycle 451 or 453 is believed with every axis at 0."""
    was_set_after = report.presets > 0 and parameters.get(PRESET, NEVER) in PRESETS_AFTER
    angle_deg = stations.angle_deg[0] if was_set_after else setup.control.start_deg
    return _at_0_mm(active, angle_deg, report.preset_mm)
