"""``skiplatch fleet export``: a campaign's folder back out of a store."""

from pathlib import Path

import click

from skiplatch.commands.fleet_options import store_option
from skiplatch.commands.options import json_option, write_json
from skiplatch.commands.outputs import OutputFolder
from skiplatch.fleet.reading import opened

EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet export rig_nominal --store build/store --out build/rig_nominal
"""


@click.command(epilog=EPILOG)
@click.argument("campaign")
@store_option
@click.option("-o", "--out", type=OutputFolder(is_new=True), required=True, help="Folder to make.")
@json_option
def command(campaign: str, store: Path, out: Path, json_path: Path | None) -> None:
    """Give back the folder of a CAMPAIGN, byte for byte.

    CAMPAIGN is the beginning of its key (fleet show), or the name of the folder that was added, if
    no other has it.
    """
    with opened(store, with_touches=False) as reader:
        key = reader.export(campaign, out)
    click.echo(out)
    write_json(json_path, {"campaign": key, "folder": str(out)})
