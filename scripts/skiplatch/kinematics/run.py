"""Running an NC program with cycles 450 and 451 on the simulated five-axis machine."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from skiplatch.errors import InputError
from skiplatch.kinematics.correction import ARCSEC_PER_DEG, CHECK
from skiplatch.kinematics.cycle import Control, CycleRefusedError, Play, Report, Stations, opened
from skiplatch.kinematics.evaluate import Evaluation, evaluate
from skiplatch.kinematics.firmware import NoFitError
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.machine import Machine
from skiplatch.kinematics.memory import Memory, run_450
from skiplatch.kinematics.points import Points
from skiplatch.kinematics.program import MM_PER_INCH, Cycle, Program
from skiplatch.kinematics.recorded import RecordedError, sort_recorded
from skiplatch.simulator import Effect

LENGTHS = (407, 320, 408, 253)
"""Parameters that are in inches in an inch program."""
SPHERE_RADIUS = 407
MODE = 406
TOUCHES = 423
NO_BACKLASH = (
    "Backlash of {} was not measured (Q432 = 0, a Hirth coupling or an M function): an axis that "
    "has some stands off by up to that angle, as it came. It shows as scatter, and as a tilt of "
    "the axis that it carries."
)
DEFAULTS = {MODE: CHECK, TOUCHES: 4}


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
        recorded: Sphere centres of a real machine, that each cycle 451 evaluates; None: the
            simulated one measures.
    """

    machine: Machine
    truth: Truth
    control: Control
    seed: int
    acknowledged: bool
    switched_on: Sequence[Effect] = ()
    recorded: Points | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run of cycle 451; `tracks`: the spindle turned the probe to each touch (TRACK)."""

    parameters: Mapping[int, float | str]
    stations: Stations
    evaluation: Evaluation
    report: Report
    notes: tuple[str, ...]
    tracks: bool


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of a program: its runs of 451, what 450 said, the kinematics at the end."""

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
        if cycle.number == 450:
            believed, words = run_450(program, cycle, believed, memory)
            said.append(words)
        else:
            runs.append(_run_451(program, cycle, setup, believed, len(runs)))
            if runs[-1].evaluation.mode > 0:
                believed = runs[-1].evaluation.corrected
                memory.activate(believed)
    return Outcome(tuple(runs), tuple(said), believed)


def _parameters(program: Program, cycle: Cycle) -> dict[int, float | str]:
    scale = MM_PER_INCH if program.is_inch else 1.0
    return {
        number: given.value * scale
        if isinstance(given.value, float) and number in LENGTHS
        else given.value
        for number, given in cycle.parameters.items()
    }


def _run_451(program: Program, cycle: Cycle, setup: Setup, believed: Machine, place: int) -> Run:
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
        ) as play:
            return _measured(play, parameters, setup, believed)
    except CycleRefusedError as error:
        given = cycle.parameters.get(error.parameter)
        line, column = (given.line, given.column) if given else (cycle.line, None)
        message = f"cycle 451: {error}{_range(error, program)}"
        raise InputError(program.path, line, column, message) from error
    except (NoFitError, RecordedError) as error:
        raise InputError(program.path, cycle.line, None, f"cycle 451: {error}") from error


def _range(error: CycleRefusedError, program: Program) -> str:
    """Say what would be admitted, in the units of the program."""
    if (row := error.limits) is None:
        return ""
    is_inch = program.is_inch and error.parameter in LENGTHS
    low, high = (limit / MM_PER_INCH if is_inch else limit for limit in (row.low, row.high))
    return f" ({row.name}: {low:.9g} to {high:.9g}{' inch' if is_inch else ''})"


def _measured(
    play: Play, parameters: Mapping[int, float | str], setup: Setup, believed: Machine
) -> Run:
    recorded = None
    notes: list[str] = []
    if setup.recorded is not None:
        recorded = sort_recorded(believed, setup.recorded, parameters)
        notes += recorded.notes
    if not (play.begin() if recorded is None else play.begin_measured(recorded.stations)):
        play.raise_failure()
    stations = play.stations()
    mode, touches = (int(parameters.get(q, DEFAULTS[q])) for q in (MODE, TOUCHES))
    points = recorded.points if recorded is not None else None
    evaluation = evaluate(believed, setup.truth, stations, mode, touches, points)
    play.answer(evaluation.change_mm)
    while play.asks in ("acknowledge", "apply"):
        if play.asks == "acknowledge":
            change_mm = play.report().change_mm
            notes.append(f"Warning: a change of {change_mm:.4f} mm exceeds maxModification.")
            play.answer(is_possible=setup.acknowledged)
        else:
            play.believe(evaluation.corrected, setup.truth)
            play.answer()
    if play.asks != "done":
        play.raise_failure()
    report = play.report()
    notes += _moved_datums(evaluation)
    notes += _combined(evaluation)
    notes += [
        f"Outlier: {outlier.text}. The fit leaves it out: measure it again."
        for outlier in evaluation.outliers
    ]
    loose = [axis.letter for axis in evaluation.axes if not stations.has_second(axis.letter)]
    if loose:
        notes.append(NO_BACKLASH.format(", ".join(loose)))
    if report.cancelled_rotation:
        notes.append("The preset has no basic rotation any more (SPA, SPB, SPC): set it again.")
    return Run(parameters, stations, evaluation, report, tuple(notes), setup.control.track)


def _moved_datums(evaluation: Evaluation) -> Iterator[str]:
    for before, after in zip(evaluation.believed.axes, evaluation.corrected.axes, strict=True):
        if after.datum_deg != before.datum_deg:
            moved_arcsec = ARCSEC_PER_DEG * (after.datum_deg - before.datum_deg)
            yield (
                f"The machine datum of {before.letter} moves by {moved_arcsec:+.2f}″: it takes the "
                "tilt of the axis carried, which no position tells from it."
            )


def _combined(evaluation: Evaluation) -> Iterator[str]:
    if evaluation.combined:
        yield (
            f"Known only in combination: {', '.join(evaluation.combined)}. The smallest correction "
            "that does it is taken, offsets before tilts."
        )
