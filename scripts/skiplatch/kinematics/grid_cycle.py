"""One run of cycle 453 on the simulated machine, or with what a real one has recorded."""

from collections.abc import Mapping
from dataclasses import dataclass

from skiplatch.kinematics.cycle import KINEMATICS_GRID, Play, setting
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.grid_evaluation import (
    DELETE,
    GridEvaluation,
    deleted,
    evaluate_grid,
    sort_grid,
)
from skiplatch.kinematics.machine import Machine
from skiplatch.kinematics.points import Points
from skiplatch.kinematics.stations import Stations

MODE, SPHERE_RADIUS = 406, 407


@dataclass(frozen=True, slots=True, eq=False)
class GridPlayed:
    """What was measured, what it says, and what the operator should know, a sentence each."""

    stations: Stations
    evaluation: GridEvaluation
    notes: tuple[str, ...]


def play_grid(
    play: Play,
    parameters: Mapping[int, float | str],
    believed: Machine,
    truth: Truth,
    *,
    recorded: Points | None,
    acknowledged: bool,
) -> GridPlayed:
    """Run an opened cycle 453 to its end.

    Args:
        play: The cycle, with its parameters set.
        parameters: The same.
        believed: The description with its table.
        truth: How the machine truly is.
        recorded: Sphere centres of a real machine; None: the simulated one measures.
        acknowledged: The operator presses NC start where a change exceeds maxModification.

    Raises:
        CycleRefusedError: The firmware ended the cycle.
        NoGridError: The recorded positions are none of the grid.
    """
    mode = int(_number(parameters, MODE))
    if mode == DELETE:
        return _delete(play, believed, truth)
    notes: list[str] = []
    if recorded is None or believed.grid is None:
        started = play.begin()
    else:
        stations, notes = sort_grid(believed, recorded, _number(parameters, SPHERE_RADIUS))
        started = play.begin_measured(stations)
    if not started:
        play.raise_failure()
    stations = play.stations()
    evaluation = evaluate_grid(believed, truth, stations, mode)
    notes += play.conclude(
        evaluation.change_mm, evaluation.corrected, truth, acknowledged=acknowledged
    )
    return GridPlayed(stations, evaluation, tuple(notes))


def _delete(play: Play, believed: Machine, truth: Truth) -> GridPlayed:
    play.begin()
    if play.asks != "clear":
        play.raise_failure()
    evaluation = deleted(believed)
    play.believe(evaluation.corrected, truth)
    play.answer()
    if play.asks != "done":
        play.raise_failure()
    return GridPlayed(play.stations(), evaluation, ())


def _number(parameters: Mapping[int, float | str], number: int) -> float:
    row = setting(number, KINEMATICS_GRID)
    given = parameters.get(number, row.initial if row else 0.0)
    return given if isinstance(given, float) else 0.0
