"""``skiplatch design``: the touches that would best settle a diagnosis, as a conditions file."""

from pathlib import Path

import click

from skiplatch.campaign import CONDITIONS, format_touches
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.experiment import experiment_json, experiment_text, next_experiment
from skiplatch.diagnosis.experiment.experiment import TOUCHES
from skiplatch.files import atomic_write_text
from skiplatch.stand_ins import read_playable

EPILOG = """\b
Example:
  skiplatch design scripts/samples/bench_isr_latency --out build/next.csv
"""


@click.command(epilog=EPILOG)
@click.argument("campaign", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    type=OutputFile(),
    required=True,
    help="Conditions to write, the most telling touch first.",
)
@click.option(
    "--touches",
    type=click.IntRange(1, 1000),
    default=TOUCHES,
    show_default=True,
    help="How many touches to recommend.",
)
@seed_option
@jobs_option
@json_option
def command(
    campaign: Path, out: Path, touches: int, seed: int, jobs: int, json_path: Path | None
) -> None:
    """Say which touches, or which column, would settle the diagnosis of a CAMPAIGN, and write them.

    The candidates that are left after the diagnosis play touches drawn about the conditions of
    the campaign; those are written that are expected to tell most.
    """
    recorded = read_playable(campaign)
    diagnosis = diagnose(recorded, seed=seed, jobs=jobs)
    experiment = next_experiment(recorded, diagnosis, seed=seed, jobs=jobs, touches=touches)
    atomic_write_text(out, format_touches(experiment.touches, CONDITIONS))
    click.echo(experiment_text(experiment))
    click.echo(f"{out}: {len(experiment.touches)} touches")
    write_json(json_path, experiment_json(experiment))
