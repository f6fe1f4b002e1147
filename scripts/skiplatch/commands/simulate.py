"""``skiplatch simulate``: conditions in, campaign out."""

from pathlib import Path

import click

from skiplatch.api.work import simulate
from skiplatch.campaign import read_nominal, write_campaign
from skiplatch.commands.inputs import FILE
from skiplatch.commands.options import (
    EffectType,
    jobs_option,
    json_option,
    refuse_idle,
    seed_option,
    write_json,
)
from skiplatch.commands.outputs import OutputFolder
from skiplatch.played_files import all_faults_told, read_played
from skiplatch.simulator.effects import Effect
from skiplatch.stand_ins import refuse_endless_move, refuse_unplayable

EPILOG = """\b
Example:
  skiplatch simulate --nominal scripts/samples/machine_no_gap/nominal.toml \\
      --conditions scripts/samples/machine_no_gap/touches.csv --out build/simulated
"""


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
    with all_faults_told(nominal_path, conditions_path):
        nominal = read_nominal(nominal_path)
        refuse_idle(switched_on, nominal.kind)
        refuse_unplayable(nominal_path, nominal)
        conditions = read_played(conditions_path, nominal)
        refuse_endless_move(nominal_path, nominal, conditions)
    touches = simulate(nominal, conditions, effects=switched_on, seed=seed, jobs=jobs).touches
    write_campaign(out, nominal, touches)
    missed = int(touches.missed.sum())
    click.echo(f"{out}: {len(touches)} touches, {missed} missed")
    write_json(json_path, {"campaign": str(out), "touches": len(touches), "missed": missed})
