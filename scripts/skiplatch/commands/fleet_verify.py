"""``skiplatch fleet verify``: whether a store is whole."""

from dataclasses import asdict
from pathlib import Path

import click

from skiplatch.commands.fleet_options import plain, store_option
from skiplatch.commands.options import json_option, write_json
from skiplatch.fleet.kept import read_kept
from skiplatch.fleet.layout import KEY_DIGITS
from skiplatch.fleet.reading import opened
from skiplatch.fleet.verify import Damage, damages
from skiplatch.progress import shown
from skiplatch.tables import counted

DAMAGED = 1
"""Exit status if something is missing or damaged."""
EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet verify --store build/store
"""


@click.command(epilog=EPILOG)
@store_option
@json_option
@click.pass_context
def command(ctx: click.Context, store: Path, json_path: Path | None) -> None:
    """Read all files of a store, and name each that is missing or damaged with its campaign.

    The exit status is then 1. skiplatch fleet add writes such a file anew from the folder that the
    campaign came from.
    """
    with opened(store, with_touches=False) as reader:
        kept = list(read_kept(reader.engine))
        found = list(damages(reader.path, reader.engine, shown(kept, len(kept), "reading")))
    for damage in found:
        click.echo(_line(damage))
    lost = len({damage.campaign for damage in found})
    click.echo(f"{store}: {counted(len(kept), 'campaign')}, {lost} with lost or damaged files")
    document = {"format": "skiplatch-fleet-verify/1", "campaigns": len(kept)}
    write_json(json_path, plain({**document, "damaged": [asdict(damage) for damage in found]}))
    if found:
        ctx.exit(DAMAGED)


def _line(damage: Damage) -> str:
    key = damage.campaign[:KEY_DIGITS]
    return f"{damage.rig}: {damage.folder} ({key}): {damage.path}: {damage.why}"
