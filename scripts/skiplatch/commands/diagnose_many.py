"""Campaigns diagnosed side by side: each is one task of one process, and is kept as it comes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import click

from skiplatch.campaign import Campaign
from skiplatch.commands.examining import Asked, Examined, examine
from skiplatch.commands.kept import Kept, key_of
from skiplatch.errors import InputError, as_told
from skiplatch.executors import software
from skiplatch.progress import shown
from skiplatch.workers import Failed, Workers, finished, opened


@dataclass(frozen=True, slots=True)
class Told:
    """A diagnosis in words and in plain types, and whether there is a gap."""

    text: str
    document: Mapping[str, Any]
    has_gap: bool


def tell(recorded: Campaign, asked: Asked) -> Told:
    """Diagnose a campaign: what a worker does."""
    return told_of(examine(recorded, asked, jobs=1))


def told_of(found: Examined) -> Told:
    """Leave out what only the command that asked can use."""
    return Told(found.text, found.document, found.has_gap)


def tell_all(
    recorded: Sequence[Campaign], asked: Asked, workers: Workers, kept: Kept
) -> Iterator[Told]:
    """Diagnose campaigns on workers; gives them in their order, each as soon as it can be.

    Raises:
        InputError: Some cannot be diagnosed, which is told of each; the others are kept.
    """
    keys = [key_of(one.path, asked, software()) for one in recorded]
    told = {number: Told(**answer) for number, answer in _kept(keys, kept)}
    refused: list[InputError] = []
    following = 0
    missing = sorted(set(range(len(keys))) - {*told})
    for number, result in told_as_done(recorded, asked, workers, missing):
        if isinstance(result, Failed):
            refused.append(InputError(recorded[number].path, None, None, result.why))
            continue
        answer = {"text": result.text, "document": result.document, "has_gap": result.has_gap}
        kept.put(keys[number], answer)
        told[number] = result
        while following in told:
            yield told[following]
            following += 1
    if refused:
        _refuse(refused, len(told), kept)
    yield from (told[number] for number in range(following, len(keys)))


def _kept(keys: Sequence[str], kept: Kept) -> Iterator[tuple[int, Mapping[str, Any]]]:
    for number, key in enumerate(keys):
        answer = kept.get(key)
        if answer is not None:
            yield number, answer


def told_as_done(
    recorded: Sequence[Campaign], asked: Asked, workers: Workers, numbers: Sequence[int]
) -> Iterator[tuple[int, Told | Failed]]:
    """Diagnose campaigns of these numbers on workers; gives each as it comes, with its number."""
    if not numbers:
        return
    with opened(replace(workers, loads=__name__)) as executor:
        tasks = [(recorded[number], asked) for number in numbers]
        for place, result in shown(finished(executor, tell, tasks), len(tasks), "diagnosing"):
            yield numbers[place], result


def _refuse(refused: Sequence[InputError], done: int, kept: Kept) -> None:
    for error in refused[:-1]:
        click.echo(as_told(error), err=True)
    if kept.folder is not None:
        click.echo(f"{done} done are kept in {kept.folder}; the same command goes on", err=True)
    raise refused[-1]
