"""``skiplatch fleet list``: the rigs of a store."""

from pathlib import Path

import click

from skiplatch.commands.fleet_options import answer_text, in_own_units, plain, store_option
from skiplatch.commands.options import json_option, write_json
from skiplatch.fleet.reading import opened

EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet list --store build/store
"""


@click.command(epilog=EPILOG)
@store_option
@json_option
def command(store: Path, json_path: Path | None) -> None:
    """List the rigs of a store: campaigns, touches, first and last time, last diagnosis."""
    with opened(store, with_touches=False) as reader:
        rigs = reader.rigs()
    told = in_own_units(rigs)
    click.echo(answer_text(told.columns, told.rows))
    write_json(json_path, {"rigs": plain(rigs.mappings())})
