"""``skiplatch fleet add``: campaigns into a store."""

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click

from skiplatch.commands.fleet_options import REFUSED, refused_json, store_option, tell_refused
from skiplatch.commands.inputs import Source
from skiplatch.commands.options import json_option, write_json
from skiplatch.errors import InputError
from skiplatch.fleet.intake import PLAINLY, Intake
from skiplatch.fleet.store import Writer, opened_for_writing
from skiplatch.progress import shown
from skiplatch.tables import counted
from skiplatch.undo import taken_back_on_failure

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
@click.pass_context
def command(
    ctx: click.Context,
    folders: tuple[Path, ...],
    store: Path,
    rig: str | None,
    json_path: Path | None,
) -> None:
    """Keep the campaigns DIR… in a store, with all files of their folders.

    A diagnosis that lies there as diagnosis.json is kept with its figures. Adding twice adds once.
    A campaign that cannot be read is told in one line, the others are added, and the exit status
    is 2.
    """
    taken = Taken()
    _fill(store, folders, rig, taken)
    tell_refused(taken.refused)
    click.echo(f"{store}: {_summary(taken)}")
    write_json(json_path, _document(taken))
    if taken.refused:
        ctx.exit(REFUSED)


@dataclass(slots=True)
class Taken:
    """What became of the campaigns: new, with other files than were kept, as kept, or refused.

    Only what the document says of them stays, for their touches would fill the memory.
    """

    added: list[dict[str, Any]] = field(default_factory=list)
    replaced: list[dict[str, Any]] = field(default_factory=list)
    known: int = 0
    refused: list[tuple[Path, InputError]] = field(default_factory=list)

    def count(self, folder: Path, intake: Intake | None) -> None:
        """Count a campaign, and say what is not plain of it."""
        if intake is None:
            self.known += 1
            return
        (self.replaced if intake.is_known or intake.older else self.added).append(_json(intake))
        if intake.told != PLAINLY:
            click.echo(f"{folder}: {intake.told}")


def _fill(store: Path, folders: tuple[Path, ...], rig: str | None, taken: Taken) -> None:
    """Add what can be read; a store that nothing went into is not made."""
    try:
        with taken_back_on_failure(), opened_for_writing(store) as writer:
            _add_all(writer, folders, rig, taken)
            if len(taken.refused) == len(folders):
                raise taken.refused[-1][1]
    except InputError as error:
        if not taken.refused or error is not taken.refused[-1][1]:
            raise


def _add_all(writer: Writer, folders: tuple[Path, ...], rig: str | None, taken: Taken) -> None:
    committed_s = time.monotonic()
    for folder in shown(folders, len(folders), "adding"):
        try:
            intake = writer.add(folder, rig)
        except InputError as error:
            if Path(error.path).is_relative_to(writer.path):
                raise
            taken.refused.append((folder, error))
            continue
        taken.count(folder, intake)
        if time.monotonic() - committed_s > COMMIT_S:
            writer.commit()
            committed_s = time.monotonic()
    writer.commit()


def _summary(taken: Taken) -> str:
    rigs = len({campaign["rig"] for campaign in taken.added})
    words = [f"{counted(len(taken.added), 'campaign')} of {counted(rigs, 'rig')} added"]
    if taken.replaced:
        words.append(f"{len(taken.replaced)} replaced")
    words.append(f"{taken.known} known already")
    if taken.refused:
        words.append(f"{len(taken.refused)} refused")
    return ", ".join(words)


def _document(taken: Taken) -> dict[str, Any]:
    return {
        "added": taken.added,
        "replaced": taken.replaced,
        "known": taken.known,
        "refused": refused_json(taken.refused),
    }


def _json(intake: Intake) -> dict[str, Any]:
    return {
        "campaign": intake.key,
        "replaces": intake.older,
        "rig": intake.rig,
        "month": intake.month,
        "folder": intake.folder,
        "path": str(intake.contents.folder),
        "touches": len(intake.recorded.touches),
    }
