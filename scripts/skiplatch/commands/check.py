"""``skiplatch check``: what is odd in a campaign, what is missing, what it cannot tell."""

from dataclasses import asdict
from pathlib import Path

import click

from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE, Campaign, read_campaign
from skiplatch.campaign.oddity import Oddity
from skiplatch.campaign.plausibility import oddities
from skiplatch.campaign.telling import cannot_be_told, missing_columns, missing_keys
from skiplatch.commands.inputs import Source
from skiplatch.commands.options import json_option, write_json
from skiplatch.errors import InputError
from skiplatch.played_files import all_faults_told, recorded
from skiplatch.stand_ins import refuse_unplayable
from skiplatch.tables import counted, prose

EPILOG = """\b
Example:
  skiplatch check scripts/samples/bench_isr_latency
"""


@click.command(epilog=EPILOG)
@click.argument("campaign", type=Source())
@json_option
def command(campaign: Path, json_path: Path | None) -> None:
    """Say in a second what in a CAMPAIGN is odd, what is missing, and what it cannot tell."""
    with all_faults_told(campaign / NOMINAL_FILE, campaign / TOUCHES_FILE, recorded):
        read = read_campaign(campaign)
    click.echo(check_text(read))
    found = {
        "odd": [asdict(oddity) for oddity in _odd(read)],
        "missing_columns": missing_columns(read),
        "missing_keys": missing_keys(read),
        "cannot_be_told": cannot_be_told(read),
    }
    head = {"campaign": str(campaign), "kind": read.nominal.kind, "touches": len(read.touches)}
    write_json(json_path, {**head, **found})


def check_text(campaign: Campaign) -> str:
    """Give what is found, a line each."""
    kind, n = campaign.nominal.kind, len(campaign.touches)
    columns, keys = missing_columns(campaign), missing_keys(campaign)
    lost = [f"{name}: {what}" for name, what in {**columns, **keys}.items()]
    parts = (
        ("Odd", [oddity.line for oddity in _odd(campaign)]),
        ("Not recorded or left out, and what cannot be told for it", lost),
        ("Not varied, and what would help", cannot_be_told(campaign)),
    )
    lines = [f"{campaign.path}: {kind} campaign, {counted(n, 'touch')}"]
    for head, found in parts:
        lines += ["", head, *(f"  {line}" for line in found or ["nothing"])]
    return prose("\n".join(lines))


def _odd(campaign: Campaign) -> list[Oddity]:
    """Give what is odd, and what no diagnosis would take."""
    found = list(oddities(campaign))
    try:
        refuse_unplayable(campaign.path / NOMINAL_FILE, campaign.nominal)
    except InputError as error:
        found += [Oddity(str(one)) for one in error.apart]
    return found
