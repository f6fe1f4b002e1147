"""``skiplatch fleet add``: campaigns into a store."""

import time
from pathlib import Path
from typing import Any

import click

from skiplatch.commands.fleet_options import store_option
from skiplatch.commands.inputs import Source
from skiplatch.commands.options import json_option, write_json
from skiplatch.errors import InputError
from skiplatch.fleet.intake import Intake
from skiplatch.fleet.store import Writer, opened_for_writing
from skiplatch.progress import shown

COMMIT_S = 5.0
"""Every so often what was added until then counts: more is lost of no work that is cut short."""
EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
"""


@click.command(epilog=EPILOG)
@click.argument("folders", nargs=-1, required=True, type=Source(is_whole=True), metavar="DIR…")
@store_option
@click.option(
    "--rig",
    help="Where the campaigns come from; else [notes] rig of nominal.toml says it, else the name "
    "of the folder that each lies in.",
)
@json_option
def command(
    folders: tuple[Path, ...], store: Path, rig: str | None, json_path: Path | None
) -> None:
    """Keep the campaigns DIR… in a store, with all files of their folders.

    A diagnosis that lies there as diagnosis.json is kept with its figures. Adding twice adds once.
    A campaign that cannot be read is told in one line, the others are added, and the exit status
    is 2.
    """
    added: list[Intake] = []
    refused: list[InputError] = []
    with opened_for_writing(store) as writer:
        _add_all(writer, folders, rig, added, refused)
    if refused:
        for error in refused[:-1]:
            click.echo(f"skiplatch: {error}", err=True)
        raise refused[-1]
    rigs = {intake.rig for intake in added}
    known = len(folders) - len(added)
    click.echo(f"{store}: {len(added)} campaigns of {len(rigs)} rigs added, {known} known already")
    write_json(json_path, {"added": [_json(intake) for intake in added], "known": known})


def _add_all(
    writer: Writer,
    folders: tuple[Path, ...],
    rig: str | None,
    added: list[Intake],
    refused: list[InputError],
) -> None:
    committed_s = time.monotonic()
    for folder in shown(folders, len(folders), "adding"):
        try:
            intake = writer.add(folder, rig)
        except InputError as error:
            if Path(error.path).is_relative_to(writer.path):
                raise
            refused.append(error)
            continue
        if intake is not None:
            added.append(intake)
        if time.monotonic() - committed_s > COMMIT_S:
            writer.commit()
            committed_s = time.monotonic()
    writer.commit()


def _json(intake: Intake) -> dict[str, Any]:
    return {
        "campaign": intake.key,
        "rig": intake.rig,
        "month": intake.month,
        "folder": str(intake.contents.folder),
        "touches": len(intake.recorded.touches),
    }
