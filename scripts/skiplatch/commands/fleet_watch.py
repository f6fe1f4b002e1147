"""``skiplatch fleet watch``: campaigns diagnosed and kept as they appear."""

import threading
from dataclasses import dataclass
from pathlib import Path

import click

from skiplatch import undo
from skiplatch.commands.examining import Asked, examine
from skiplatch.commands.fleet_options import store_option
from skiplatch.commands.options import (
    SizeType,
    jobs_option,
    json_option,
    json_text,
    seed_option,
    write_json,
)
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text
from skiplatch.fleet.arrivals import Arrivals, noticed
from skiplatch.fleet.diagnosed import DIAGNOSIS_FILE
from skiplatch.fleet.lock import BusyError
from skiplatch.fleet.store import opened_for_writing, refuse_unusable
from skiplatch.simulator.library import SimulationError
from skiplatch.stand_ins import read_playable

UNNOTICED_S = 60.0
"""Every so often it is looked whether anything came that nobody told: from a network drive."""
EPILOG = """\b
Example:
  skiplatch fleet watch /srv/touches --store build/store
  skiplatch fleet watch /srv/touches --store build/store --once
"""


@dataclass(slots=True)
class Intake:
    """Where campaigns go.

    Attributes:
        store: The store.
        rig: Where they come from, unless their folders are to say that.
        seed: Of the diagnoses.
        jobs: Threads of a diagnosis.
    """

    store: Path
    rig: str | None
    seed: int
    jobs: int

    def take(self, folder: Path) -> bool:
        """Diagnose a campaign and keep it; gives whether it is new.

        Raises:
            InputError: It cannot be read, simulated or kept.
            BusyError: Another one writes to the store.
        """
        try:
            if not (folder / DIAGNOSIS_FILE).exists():
                found = examine(read_playable(folder), Asked(seed=self.seed), self.jobs)
                atomic_write_text(folder / DIAGNOSIS_FILE, json_text(found.document))
                undo.keep_outputs()
            with opened_for_writing(self.store) as writer:
                is_new = writer.add(folder, self.rig) is not None
                writer.commit()
        except (SimulationError, OSError) as error:
            raise InputError(folder, None, None, str(error)) from error
        return is_new


@click.command(epilog=EPILOG)
@click.argument("folder", type=click.Path(path_type=Path))
@store_option
@click.option(
    "--rig", help="Where the campaigns come from; see skiplatch fleet add for what else says it."
)
@click.option(
    "--settle-s",
    type=SizeType(),
    default=10.0,
    show_default=True,
    metavar="s",
    help="A campaign is whole once nothing in its folder has changed for so long.",
)
@click.option("--once", is_flag=True, help="Take what is there and whole, and end.")
@seed_option
@jobs_option
@json_option
def command(
    folder: Path,
    store: Path,
    rig: str | None,
    settle_s: float,
    once: bool,  # noqa: FBT001
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Diagnose each campaign that appears below FOLDER, and keep it in a store, until interrupted.

    The diagnosis is written to diagnosis.json in the campaign's folder; one that lies there is
    taken as it is. What is not whole yet is left until it is. A campaign that cannot be read is
    told in one line and left until it changes; with --once the exit status is then 2.
    """
    refuse_unusable(store)
    intake = Intake(store, rig, seed, jobs)
    arrivals = Arrivals(folder, settle_s)
    if once:
        _once(intake, arrivals, json_path)
    else:
        if json_path is not None:
            raise click.UsageError("--json needs --once: a watch has no end")
        watch(intake, arrivals, threading.Event())


def _once(intake: Intake, arrivals: Arrivals, json_path: Path | None) -> None:
    whole, waiting = arrivals.look()
    kept, refused = [], []
    for folder in whole:
        try:
            if intake.take(folder):
                kept.append(folder)
                click.echo(f"{folder}: kept")
        except InputError as error:
            _refuse_whole_store(intake, error)
            refused.append(error)
    if refused:
        for earlier in refused[:-1]:
            click.echo(f"skiplatch: {earlier}", err=True)
        raise refused[-1]
    known = len(whole) - len(kept)
    click.echo(f"{len(kept)} kept, {known} known already, {waiting} not whole yet")
    document = {"kept": [str(path) for path in kept], "known": known, "not_whole": waiting}
    write_json(json_path, document)


def watch(intake: Intake, arrivals: Arrivals, stop: threading.Event) -> None:
    """Take what becomes whole until it is told to stop."""
    arrivals.look()  # refuses a folder that is not there
    with noticed(arrivals.folder) as news:
        while not stop.is_set():
            news.clear()
            whole, waiting = arrivals.look()
            for folder, state in whole.items():
                if _has_to_wait(intake, folder):
                    waiting += 1
                else:
                    arrivals.dealt_with[folder] = state
            news.wait(arrivals.settle_s / 2.0 if waiting else UNNOTICED_S)


def _has_to_wait(intake: Intake, folder: Path) -> bool:
    """Take a campaign, or say what is wrong with it, unless the store is busy."""
    try:
        if intake.take(folder):
            click.echo(f"{folder}: kept")
    except BusyError:
        return True
    except InputError as error:
        _refuse_whole_store(intake, error)
        click.echo(f"skiplatch: {error}", err=True)
    return False


def _refuse_whole_store(intake: Intake, error: InputError) -> None:
    """Raise what is wrong with the store: no other campaign would fare better."""
    if Path(error.path).is_relative_to(intake.store.resolve()):
        raise error
