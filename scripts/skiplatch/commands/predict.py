"""``skiplatch predict``: conditions and a diagnosis in, predictions out."""

from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np

from skiplatch.campaign import (
    NOMINAL_FILE,
    Nominal,
    Touches,
    read_campaign,
    read_conditions,
    read_nominal,
)
from skiplatch.commands.options import CountType, jobs_option, json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.diagnosis import rig_from_json
from skiplatch.diagnosis.phase import at_given_edges, play_in_phase
from skiplatch.diagnosis.playing import Rig
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text, read_json
from skiplatch.simulator import Outcomes
from skiplatch.stand_ins import refuse_unplayable

EPILOG = """\b
Example:
  skiplatch predict scripts/samples/bench_isr_latency --replicates 20 --out build/predicted.csv \\
      --conditions scripts/samples/bench_isr_latency/touches.csv
"""

FILE = click.Path(path_type=Path, dir_okay=False)
HEADER = "touch,replicate,edge_us,latch_us,report_us,deviation_um,status"


def _rig(path: Path | None, nominal: Nominal) -> Rig:
    """Give the rig that a diagnosis says it is, or the believed one."""
    if path is None:
        return Rig(nominal)
    document = read_json(path)
    try:
        return rig_from_json(document, nominal)
    except ValueError as error:
        raise InputError(path, None, None, str(error)) from error


def _cells(values: np.ndarray) -> list[str]:
    return ["" if np.isnan(value) else f"{value:.3f}" for value in values]


def _lines(conditions: Touches, outcomes: Outcomes) -> Sequence[str]:
    given = np.where(np.isnan(conditions.edge_us), outcomes.edge_us, conditions.edge_us)
    columns = [given, outcomes.latch_us, outcomes.report_us, outcomes.deviation_um]
    lines = [HEADER]
    for replicate, ok in enumerate(outcomes.ok):
        cells = [_cells(column[replicate]) for column in columns]
        status = np.where(ok, "ok", "missed")
        rows = zip(conditions.touch, *cells, status, strict=True)
        lines += [f"{touch},{replicate},{','.join(rest)}" for touch, *rest in rows]
    return lines


@click.command(epilog=EPILOG)
@click.argument("campaign", type=click.Path(path_type=Path))
@click.option("--diagnosis", type=FILE, help="JSON of a diagnosis; without it, the nominal chain.")
@click.option("--conditions", "conditions_path", type=FILE, required=True, help="Touches to play.")
@click.option(
    "--replicates",
    type=CountType(1, 100_000),
    default=1,
    show_default=True,
    help="How often to play them.",
)
@click.option("-o", "--out", type=OutputFile(), required=True, help="CSV to write.")
@seed_option
@jobs_option
@json_option
def command(
    campaign: Path,
    diagnosis: Path | None,
    conditions_path: Path,
    replicates: int,
    out: Path,
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Play conditions on the rig of a CAMPAIGN, with the effects that a diagnosis found.

    Where the conditions give edge_us (on a bench), the contacts close there. With a diagnosis the
    scans of the PLC keep the phase that the recorded stamps show.
    """
    nominal = read_nominal(campaign / NOMINAL_FILE)
    refuse_unplayable(campaign / NOMINAL_FILE, nominal)
    conditions = read_conditions(conditions_path)
    rig = _rig(diagnosis, nominal)
    given = at_given_edges(rig, conditions)
    if diagnosis is None:
        outcomes = rig.play(given, seed=seed, replicates=replicates, jobs=jobs)
    else:
        recorded = read_campaign(campaign).touches
        outcomes = play_in_phase(rig, recorded, given, seed=seed, replicates=replicates, jobs=jobs)
    atomic_write_text(out, "\n".join(_lines(conditions, outcomes)) + "\n")
    click.echo(f"{out}: {len(conditions)} touches, {replicates} times")
    write_json(json_path, {"out": str(out), "touches": len(conditions), "replicates": replicates})
