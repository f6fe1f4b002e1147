"""``skiplatch fleet remove``: campaigns out of a store for good."""

from pathlib import Path

import click

from skiplatch.commands.fleet_options import store_option
from skiplatch.commands.options import json_option, write_json
from skiplatch.fleet.store import opened_for_writing
from skiplatch.tables import counted

EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet remove rig_nominal --store build/store
"""


@click.command(epilog=EPILOG)
@click.argument("campaigns", nargs=-1, required=True, metavar="CAMPAIGN…")
@store_option
@json_option
def command(campaigns: tuple[str, ...], store: Path, json_path: Path | None) -> None:
    """Take each CAMPAIGN out of a store for good: one of a wrong date or of another rig.

    CAMPAIGN is the beginning of its key (fleet show), or the name of the folder that was added, if
    no other has it. If one of several is not there, all stay. skiplatch fleet export gives a folder
    back first.
    """
    with opened_for_writing(store, may_be_new=False) as writer:
        removed = [writer.remove(name).key for name in campaigns]
        writer.commit()
    click.echo(f"{store}: {counted(len(removed), 'campaign')} removed")
    write_json(json_path, {"removed": removed})
