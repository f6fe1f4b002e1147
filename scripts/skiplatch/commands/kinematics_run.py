"""``skiplatch kinematics run``: an NC program on the simulated five-axis machine."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

import click
import numpy as np

from skiplatch.campaign import InputPath
from skiplatch.commands.claims import claim_input, claim_output
from skiplatch.commands.inputs import FILE
from skiplatch.commands.kinematics_fit import tell
from skiplatch.commands.options import (
    EffectType,
    json_option,
    seed_option,
    text_aside,
    write_document,
    write_json,
)
from skiplatch.commands.outputs import STDOUT, OutputFile
from skiplatch.files import atomic_write_text
from skiplatch.kinematics.control import read_control
from skiplatch.kinematics.evaluation import Evaluation
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.grid_evaluation import GridEvaluation
from skiplatch.kinematics.machine import (
    LETTERS,
    Machine,
    Vector,
    read_machine,
    read_preset,
    read_spindle,
)
from skiplatch.kinematics.memory import Memory, format_machine
from skiplatch.kinematics.points import TOLD_COLUMNS, columns_of, read_points
from skiplatch.kinematics.program import Program, read_program
from skiplatch.kinematics.run import Outcome, Run, Setup, run_program
from skiplatch.kinematics.truth import draw_truth, read_truth
from skiplatch.places import ROOT
from skiplatch.report.kinematics import Log, Logged, lay_out
from skiplatch.report.kinematics_grid import LoggedGrid
from skiplatch.report.kinematics_run import as_json, effort, end_state, run_text
from skiplatch.simulator.effects import Effect

LOG_NAME = "TCHPRAUTO.html"
MEMORY_NAME = "kinematics.bin"
DEFAULT_MACHINE = ROOT / "scripts" / "samples" / "kinematics" / "machine_bc.toml"

EPILOG = """\b
Example:
  skiplatch kinematics run scripts/samples/kinematics/optimise_positions.h \\
      --truth scripts/samples/kinematics/truth_bc.toml --html build/TCHPRAUTO.html
"""


@click.command(name="run", epilog=EPILOG)
@click.argument("program_path", metavar="PROGRAM", type=FILE)
@click.option(
    "--machine",
    "machine_path",
    type=FILE,
    default=DEFAULT_MACHINE,
    show_default="a table with B and C",
    help="The rotary axes as believed; see 'skiplatch kinematics fit --help'.",
)
@click.option(
    "--truth",
    "truth_path",
    type=FILE,
    help="How the simulated machine truly is; drawn by the seed when not given.",
)
@click.option(
    "--changed",
    "changed_path",
    type=FILE,
    help="How it truly is from the first cycle 452 on: with another head, or after a drift.",
)
@click.option(
    "--path",
    "path_name",
    type=click.Choice([path.name.lower() for path in InputPath]),
    default=InputPath.SKIP.name.lower(),
    show_default=True,
    help="Input path that latches the touches.",
)
@click.option(
    "--effect",
    "switched_on",
    type=EffectType(),
    multiple=True,
    help="An effect on every touch, ID:NAME=VALUE,…; several are possible.",
)
@click.option(
    "--acknowledge",
    "acknowledged",
    is_flag=True,
    help="Press NC start where a change exceeds maxModification.",
)
@click.option(
    "--html",
    "html_path",
    type=OutputFile(allow_dash=True),
    callback=text_aside,
    help="The log, - for stdout; its charts go beside a file as SVG.  "
    f"[default: {LOG_NAME} beside PROGRAM]",
)
@click.option(
    "--from-points",
    "recorded_path",
    type=FILE,
    help="Evaluate these sphere centres of a real machine and simulate nothing; see 'fit'.",
)
@click.option(
    "--points", "points_path", type=OutputFile(), help="Write the sphere centres as POINTS.csv."
)
@click.option(
    "--corrected", "corrected_path", type=OutputFile(), help="Write the kinematics at the end."
)
@click.option(
    "--memory",
    "memory_path",
    type=FILE,
    help=f"The store of cycle 450.  [default: {MEMORY_NAME} beside PROGRAM]",
)
@click.option(
    "--discard-damaged",
    "discards_damaged",
    is_flag=True,
    help="Go on with what is left in a store that has lost bits.",
)
@seed_option
@json_option
def command(
    program_path: Path,
    machine_path: Path,
    truth_path: Path | None,
    changed_path: Path | None,
    path_name: str,
    switched_on: Sequence[Effect],
    acknowledged: bool,  # noqa: FBT001
    html_path: Path | None,
    recorded_path: Path | None,
    points_path: Path | None,
    corrected_path: Path | None,
    memory_path: Path | None,
    discards_damaged: bool,  # noqa: FBT001
    seed: int,
    json_path: Path | None,
) -> None:
    """Run cycles 450, 451, 452 and 453 of PROGRAM, and write their log.

    PROGRAM is a HEIDENHAIN program with blocks TOOL CALL and TCH PROBE 450 to 453 and their Q
    lines. Every measurement of the sphere is made of touches that the firmware latches, on a
    simulated machine with errors of its own; what is found is fitted by the firmware too.
    """
    memory_path, html_path = _beside(program_path, memory_path, html_path)
    program = read_program(program_path)
    machine = read_machine(machine_path)
    recorded = None if recorded_path is None else read_points(recorded_path, machine)
    if recorded is not None:
        truth = Truth()
    elif truth_path is None:
        truth = draw_truth(machine, seed)
    else:
        truth = read_truth(truth_path, machine)
    control = read_control(
        machine_path, input_path=InputPath[path_name.upper()], tip_radius_mm=truth.tip_radius_mm
    )
    setup = Setup(
        machine=machine,
        truth=truth,
        control=control,
        seed=seed,
        acknowledged=acknowledged,
        switched_on=switched_on,
        recorded=recorded,
        changed=None if changed_path is None else read_truth(changed_path, machine),
        preset_mm=read_preset(machine_path),
    )
    memory = Memory(memory_path, discards_damaged=discards_damaged)
    outcome = run_program(program, setup, memory)
    if outcome.runs:
        log = _log(program, machine_path, html_path, outcome)
        if html_path != STDOUT:
            for name, chart in log.charts.items():
                atomic_write_text(html_path.with_name(name), chart)
        write_document(html_path, log.html)
    if points_path is not None:
        atomic_write_text(points_path, _points(machine, outcome))
    if corrected_path is not None:
        atomic_write_text(corrected_path, format_machine(outcome.machine))
    result = (
        as_json(outcome) if recorded is not None else {**as_json(outcome), "truth": asdict(truth)}
    )
    click.echo("\n".join([*outcome.said, *map(run_text, outcome.runs)]))
    if outcome.runs and html_path != STDOUT:
        click.echo(f"log: {html_path}")
    fitted = [e.fit for run in outcome.runs if isinstance(e := run.evaluation, Evaluation)]
    if recorded is not None and fitted:
        result |= tell(machine, recorded, fitted[-1])
    write_json(json_path, result)


def _beside(program: Path, memory: Path | None, log: Path | None) -> tuple[Path, Path]:
    """Give store and log, which are beside the program where no option names them."""
    if memory is None:
        memory = program.parent / MEMORY_NAME
        claim_input(memory)
    if log is None:
        log = program.parent / LOG_NAME
        claim_output(log)
    return memory, log


def _log(program: Program, machine_path: Path, log_path: Path, outcome: Outcome) -> Log:
    spindle_mm = read_spindle(machine_path)
    return lay_out(
        [_logged(run, spindle_mm) for run in outcome.runs],
        name=None if log_path == STDOUT else log_path.stem,
        when=datetime.now(UTC).astimezone(),
        program=program.path.resolve(),
        tool=program.tool,
        kinematics=machine_path.stem,
    )


def _logged(run: Run, spindle_mm: Vector) -> Logged | LoggedGrid:
    found, took, end = run.evaluation, effort(run), end_state(run)
    if isinstance(found, GridEvaluation):
        return LoggedGrid(found, took, end, run.notes)
    return Logged(run.cycle, found, run.parameters, took, end, run.notes, spindle_mm)


def _points(machine: Machine, outcome: Outcome) -> str:
    """Write all measured centres of all runs as POINTS.csv."""
    places = [LETTERS.index(letter) for letter in machine.letters]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow((*columns_of(machine), *TOLD_COLUMNS))
    for run in outcome.runs:
        seen = run.stations
        rows = np.hstack([seen.angle_deg[:, places], seen.centre_mm])
        for row, approach, radius_mm in zip(rows, seen.approach, seen.radius_mm, strict=True):
            writer.writerow([*(f"{value:.6f}" for value in row), approach, f"{radius_mm:.6f}"])
    return text.getvalue()
