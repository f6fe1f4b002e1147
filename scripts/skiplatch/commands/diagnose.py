"""``skiplatch diagnose``: where the gap lies, what causes it, how far it shrinks."""

from pathlib import Path

import click

from skiplatch.campaign import read_campaign
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.diagnosis import as_json, as_text, diagnose

EPILOG = """\b
Example:
  skiplatch diagnose scripts/samples/bench_isr_latency --json build/diagnosis.json
"""


@click.command(epilog=EPILOG)
@click.argument("campaign", type=click.Path(path_type=Path))
@seed_option
@jobs_option
@json_option
def command(campaign: Path, seed: int, jobs: int, json_path: Path | None) -> None:
    """Say where the gap of a CAMPAIGN lies, which effects cause it, and how far it shrinks.

    Half of the touches serve to fit, a fifth to check, and the rest to measure the shrink by
    simulation. No effect is named that gains less than 5 nats on the touches it is fitted to,
    beyond what its parameters are worth, or less than 1 nat on others.
    """
    recorded = read_campaign(campaign)
    diagnosis = diagnose(recorded, seed=seed, jobs=jobs)
    click.echo(f"{campaign}: {recorded.nominal.kind} campaign, {len(recorded.touches)} touches\n")
    click.echo(as_text(diagnosis))
    write_json(json_path, as_json(diagnosis))
