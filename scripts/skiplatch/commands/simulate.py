"""``skiplatch simulate``: conditions in, campaign out."""

from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from skiplatch.campaign import Status, Touches, read_conditions, read_nominal, write_campaign
from skiplatch.commands.options import (
    EffectType,
    jobs_option,
    json_option,
    refuse_idle,
    seed_option,
    write_json,
)
from skiplatch.commands.outputs import OutputFolder
from skiplatch.simulator import Controller, Effect, Outcomes, play
from skiplatch.stand_ins import refuse_unplayable

EPILOG = """\b
Example:
  skiplatch simulate --nominal scripts/samples/machine_no_gap/nominal.toml \\
      --conditions scripts/samples/machine_no_gap/touches.csv --out build/simulated
"""

FILE = click.Path(path_type=Path, dir_okay=False)


def _as_recorded(conditions: Touches, outcomes: Outcomes) -> Touches:
    """Put the first replicate where a recorder would have put it; conditions stay as they are."""
    return replace(
        conditions,
        edge_us=outcomes.edge_us[0],
        latch_us=outcomes.latch_us[0],
        report_us=outcomes.report_us[0],
        deviation_um=outcomes.deviation_um[0],
        status=np.where(outcomes.ok[0], Status.OK, Status.MISSED).astype(np.int8),
    )


@click.command(epilog=EPILOG)
@click.option("--nominal", "nominal_path", type=FILE, required=True, help="The rig: nominal.toml.")
@click.option(
    "--conditions",
    "conditions_path",
    type=FILE,
    required=True,
    help="The touches to play: touches.csv, outcomes in it are ignored.",
)
@click.option(
    "-o",
    "--out",
    type=OutputFolder(is_new=True),
    required=True,
    help="Folder of the campaign; must not hold anything yet.",
)
@click.option(
    "--effect",
    "switched_on",
    type=EffectType(),
    multiple=True,
    metavar="ID[:NAME=VALUE,…]",
    help="Switch an effect on; may be given several times. See 'skiplatch effects'.",
)
@seed_option
@jobs_option
@json_option
def command(
    nominal_path: Path,
    conditions_path: Path,
    out: Path,
    switched_on: tuple[Effect, ...],
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Play conditions through the simulation, firmware and all, and write a campaign.

    What is played is the nominal chain, and the effects that are switched on.
    """
    nominal = read_nominal(nominal_path)
    refuse_idle(switched_on, nominal.kind)
    refuse_unplayable(nominal_path, nominal)
    conditions = read_conditions(conditions_path)
    controller = Controller.for_campaign(nominal, conditions)
    outcomes = play(nominal, controller, conditions, seed=seed, jobs=jobs, switched_on=switched_on)
    touches = _as_recorded(conditions, outcomes)
    write_campaign(out, nominal, touches)
    missed = int(touches.missed.sum())
    click.echo(f"{out}: {len(touches)} touches, {missed} missed")
    write_json(json_path, {"campaign": str(out), "touches": len(touches), "missed": missed})
