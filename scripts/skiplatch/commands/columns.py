"""``skiplatch columns``: what may stand in a campaign."""

from pathlib import Path

import click

from skiplatch.campaign.reference import as_json, columns_table, keys_table
from skiplatch.commands.options import json_option, write_json

EPILOG = """\b
Example:
  skiplatch columns --nominal
"""


@click.command(epilog=EPILOG)
@click.option("--nominal", is_flag=True, help="The keys of nominal.toml instead.")
@json_option
def command(*, nominal: bool, json_path: Path | None) -> None:
    """List the columns of touches.csv as docs/CAMPAIGN.md does, in Markdown."""
    click.echo(keys_table() if nominal else columns_table(), nl=False)
    write_json(json_path, as_json())
