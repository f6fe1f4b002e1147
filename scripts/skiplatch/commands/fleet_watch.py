"""``skiplatch fleet watch``: campaigns diagnosed and kept as they appear."""

import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from skiplatch import undo
from skiplatch.campaign import Campaign
from skiplatch.commands.diagnose_many import Told, told_as_done, told_of
from skiplatch.commands.examining import Asked, examine
from skiplatch.commands.fleet_options import REFUSED, refused_json, store_option, tell_refused
from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import TIME_S
from skiplatch.commands.options import (
    add_json_line,
    jobs_option,
    json_option,
    json_text,
    seed_option,
    write_json,
)
from skiplatch.commands.worker_options import cluster_option, limit_option
from skiplatch.errors import InputError, as_told
from skiplatch.files import atomic_write_text
from skiplatch.fleet.arrivals import Arrivals, noticed
from skiplatch.fleet.diagnosed import DIAGNOSIS_FILE, is_diagnosed
from skiplatch.fleet.intake import refuse_unfit
from skiplatch.fleet.lock import BusyError
from skiplatch.fleet.store import opened_for_writing, refuse_unusable
from skiplatch.played_files import read_playable
from skiplatch.simulator.library import SimulationError
from skiplatch.workers import Failed, Workers

UNNOTICED_S = 60.0
"""Every so often it is looked whether anything came that nobody told: from a network drive."""
EPILOG = """\b
Example:
  skiplatch fleet watch /srv/touches --store build/store
  skiplatch fleet watch /srv/touches --store build/store --once
  skiplatch fleet watch /srv/touches --store build/store --cluster tcp://head:8786
"""


@dataclass(slots=True)
class Intake:
    """Where campaigns go.

    Attributes:
        store: The store.
        rig: Where they come from, unless their folders are to say that.
        seed: Of the diagnoses.
        workers: Who diagnoses: a campaign alone, without a cluster, is work for `jobs` threads.
    """

    store: Path
    rig: str | None
    seed: int
    workers: Workers

    def take(self, folders: Sequence[Path]) -> Iterator[tuple[Path, str | InputError]]:
        """Diagnose campaigns and keep them, in their order; each diagnosis is written as it comes.

        Gives for each what is said of it, nothing if it is known, or why it cannot be read,
        simulated or kept.

        Raises:
            InputError: No cluster answers, or it is lost, or its workers have other software.
        """
        done: dict[int, InputError | None] = {}
        following = 0
        for number, wrong in self._diagnose(folders):
            done[number] = wrong
            while following in done:
                folder = folders[following]
                yield folder, done[following] or self._keep(folder)
                following += 1

    def _diagnose(self, folders: Sequence[Path]) -> Iterator[tuple[int, InputError | None]]:
        """Write the diagnoses that are missing; gives the numbers of folders as they are done."""
        recorded: dict[int, Campaign] = {}
        for number, folder in enumerate(folders):
            try:
                if not is_diagnosed(folder):
                    playable = read_playable(folder)
                    refuse_unfit(folder, self.rig)
                    recorded[number] = playable
                    continue
            except (InputError, OSError) as error:
                yield number, _named(folder, error)
                continue
            yield number, None
        numbers, campaigns = list(recorded), list(recorded.values())
        for place, result in self._told(campaigns):
            folder = folders[numbers[place]]
            yield numbers[place], _written(folder, result)

    def _told(self, recorded: Sequence[Campaign]) -> Iterator[tuple[int, Told | Failed]]:
        asked = Asked(seed=self.seed)
        if len(recorded) == 1 and self.workers.cluster is None:
            yield 0, _told_here(recorded[0], asked, self.workers.jobs)
        else:
            yield from told_as_done(recorded, asked, self.workers, range(len(recorded)))

    def _keep(self, folder: Path) -> str | InputError:
        try:
            with undo.taken_back_on_failure(), opened_for_writing(self.store) as writer:
                intake = writer.add(folder, self.rig)
                writer.commit()
        except (InputError, OSError) as error:
            return _named(folder, error)
        return intake.told if intake else ""


def _told_here(recorded: Campaign, asked: Asked, jobs: int) -> Told | Failed:
    try:
        return told_of(examine(recorded, asked, jobs))
    except (InputError, SimulationError, OSError) as error:
        return Failed(str(error))


def _written(folder: Path, result: Told | Failed) -> InputError | None:
    """Write a diagnosis into the campaign's folder, or say why there is none."""
    if isinstance(result, Failed):
        return InputError(folder, None, None, result.why)
    try:
        atomic_write_text(folder / DIAGNOSIS_FILE, json_text(result.document))
    except (InputError, OSError) as error:
        return _named(folder, error)
    undo.keep_outputs()
    return None


def _named(folder: Path, error: InputError | OSError) -> InputError:
    """Say which campaign it is that something went wrong with, if that is not said."""
    return error if isinstance(error, InputError) else InputError(folder, None, None, str(error))


@click.command(epilog=EPILOG)
@click.argument("folder", type=Source(is_whole=True))
@store_option
@click.option(
    "--rig", help="Where the campaigns come from; see skiplatch fleet add for what else says it."
)
@click.option(
    "--settle-s",
    type=TIME_S,
    default=10.0,
    show_default=True,
    metavar="SECONDS",
    help="A campaign is whole once nothing in its folder has changed for so long.",
)
@click.option("--once", is_flag=True, help="Take what is there and whole, and end.")
@seed_option
@jobs_option
@cluster_option
@limit_option
@json_option
def command(
    folder: Path,
    store: Path,
    rig: str | None,
    settle_s: float,
    once: bool,  # noqa: FBT001
    seed: int,
    jobs: int,
    cluster: str | None,
    limit_s: float,
    json_path: Path | None,
) -> None:
    """Diagnose each campaign that appears below FOLDER, and keep it in a store, until interrupted.

    The diagnosis is written to diagnosis.json in the campaign's folder; one that lies there is
    taken as it is. What is not whole yet is left until it is. A campaign that cannot be read is
    told in one line and left until it changes; with --once the exit status is then 2.

    Several that are whole at a time are diagnosed side by side, each by one process, and kept in
    the order of their names. A cluster that does not answer ends the watch.

    With --once the JSON is one document. A watch that has no end adds a line of JSON to the file,
    or to stdout, for each campaign that is kept or refused, as it comes.
    """
    refuse_unusable(store)
    workers = Workers(jobs=jobs, cluster=cluster, limit_s=limit_s)
    intake = Intake(store, rig, seed, workers)
    arrivals = Arrivals(folder, settle_s)
    if once:
        _once(intake, arrivals, json_path)
    else:
        watch(intake, arrivals, threading.Event(), json_path)


def _once(intake: Intake, arrivals: Arrivals, json_path: Path | None) -> None:
    whole, waiting = arrivals.look()
    kept: list[Path] = []
    refused: list[tuple[Path, InputError]] = []
    for folder, taken in intake.take(list(whole)):
        if isinstance(taken, InputError):
            _refuse_whole_store(intake, taken)
            refused.append((folder, taken))
        elif taken:
            kept.append(folder)
            click.echo(f"{folder}: {taken}")
    tell_refused(refused)
    for folder in waiting:
        click.echo(f"{folder}: not whole yet")
    known = len(whole) - len(kept) - len(refused)
    more = f", {len(refused)} refused" if refused else ""
    click.echo(f"{len(kept)} kept, {known} known already{more}, {len(waiting)} not whole yet")
    document = {
        "kept": [str(path) for path in kept],
        "known": known,
        "not_whole": len(waiting),
        "waiting": [str(path) for path in waiting],
        "refused": refused_json(refused),
    }
    write_json(json_path, document)
    if refused:
        click.get_current_context().exit(REFUSED)


def watch(
    intake: Intake, arrivals: Arrivals, stop: threading.Event, json_path: Path | None = None
) -> None:
    """Take what becomes whole until it is told to stop."""
    arrivals.look()  # refuses a folder that is not there
    with noticed(arrivals.folder) as news:
        while not stop.is_set():
            news.clear()
            whole, waiting = arrivals.look()
            for folder, taken in intake.take(list(whole)):
                if isinstance(taken, BusyError):
                    waiting.append(folder)
                    continue
                arrivals.dealt_with[folder] = whole[folder]
                _tell(intake, folder, taken, json_path)
            news.wait(arrivals.settle_s / 2.0 if waiting else UNNOTICED_S)


def _tell(intake: Intake, folder: Path, taken: str | InputError, json_path: Path | None) -> None:
    """Say that a campaign is new, or what is wrong with it."""
    if isinstance(taken, InputError):
        _refuse_whole_store(intake, taken)
        click.echo(as_told(taken), err=True)
        add_json_line(json_path, {"path": str(folder), "is_kept": False, "said": str(taken)})
    elif taken:
        click.echo(f"{folder}: {taken}")
        add_json_line(json_path, {"path": str(folder), "is_kept": True, "said": taken})


def _refuse_whole_store(intake: Intake, error: InputError) -> None:
    """Raise what is wrong with the store: no other campaign would fare better."""
    if Path(error.path).is_relative_to(intake.store.resolve()):
        raise error
