"""Options that several commands share, and what they stand for."""

import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import click

from skiplatch.admitted import JOBS, SEED
from skiplatch.campaign import Kind
from skiplatch.campaign.kind import NOT_ON_A_BENCH
from skiplatch.commands.claims import STDOUT_TAKEN
from skiplatch.commands.numbers import CountType, number_or_nan
from skiplatch.commands.outputs import STDOUT, OutputFile
from skiplatch.errors import hint, quoted
from skiplatch.files import atomic_write_text, failures_named
from skiplatch.former_names import present_names
from skiplatch.simulator.effects import Effect, effects

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def _usable_cores() -> int:
    return len(os.sched_getaffinity(0))


seed_option: Decorator = click.option(
    "--seed",
    type=CountType.of(SEED),
    default=1,
    show_default=True,
    help="Picks the random numbers; the same seed gives the same result.",
)

jobs_option: Decorator = click.option(
    "--jobs",
    type=CountType.of(JOBS),
    default=_usable_cores,
    show_default="all cores",
    help="Threads to work on; the result does not depend on it.",
)

other_touches_option: Decorator = click.option(
    "--other-touches",
    is_flag=True,
    help="Take a diagnosis of other touches, as of an earlier campaign of the same rig.",
)


ATOMIC = 1024
"""Characters, at most 4096 bytes, that a pipe takes as a whole or refuses: of what it took in part
before its reader left, Python says nothing."""


def text_aside(ctx: click.Context, _: click.Parameter, path: Path | None) -> Path | None:
    """Send what is meant for people to stderr if a document goes to stdout."""
    if path == STDOUT:
        if STDOUT_TAKEN in ctx.meta:
            raise click.UsageError("only one document can go to stdout")
        ctx.meta[STDOUT_TAKEN] = sys.stdout
        ctx.with_resource(redirect_stdout(sys.stderr))
    return path


json_option: Decorator = click.option(
    "--json",
    "json_path",
    type=OutputFile(allow_dash=True),
    callback=text_aside,
    help="Also write the result as JSON to this file; - for stdout, all else then goes to stderr.",
)

html_option: Decorator = click.option(
    "--html",
    "html_path",
    type=OutputFile(allow_dash=True),
    callback=text_aside,
    help="Also write the result as one page with pictures to this file; - for stdout.",
)


class EffectType(click.ParamType[Effect]):
    """An effect of the table with its parameters: ``backlash:backlash_um=3.5``."""

    name = "effect"

    def convert(
        self, value: str | Effect, param: click.Parameter | None, ctx: click.Context | None
    ) -> Effect:
        """See `click.ParamType.convert`."""
        if isinstance(value, Effect):
            return value
        effect_id, _, rest = value.partition(":")
        if effect_id not in effects():
            self.fail(f"{quoted(effect_id)} is no effect{hint(effect_id, effects())}", param, ctx)
        pairs = [pair.partition("=") for pair in rest.split(",") if pair]
        try:
            named = present_names(_once_each((name, text) for name, _, text in pairs))
            return Effect(effect_id, dict(_parameter(effect_id, *pair) for pair in named.items()))
        except ValueError as error:
            self.fail(str(error), param, ctx)


def _once_each(pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Give texts by name.

    Raises:
        ValueError: A name comes twice.
    """
    texts: dict[str, str] = {}
    for name, text in pairs:
        if name in texts:
            raise ValueError(f"{quoted(name)} is given twice")
        texts[name] = text
    return texts


def _parameter(effect_id: str, name: str, text: str) -> tuple[str, float]:
    known = {parameter.name: parameter for parameter in effects()[effect_id].parameters}
    if not text:
        raise ValueError(f"expected NAME=VALUE, such as {next(iter(known))}=…, got {quoted(name)}")
    if name not in known:
        raise ValueError(f"{effect_id} has no parameter {quoted(name)}{hint(name, known)}")
    low, high = known[name].low, known[name].high
    value = number_or_nan(text)
    if not low <= value <= high:
        raise ValueError(f"{name}: expected a number from {low:g} to {high:g}, got {quoted(text)}")
    return name, value


def refuse_idle(switched_on: Iterable[Effect], kind: Kind) -> None:
    """Raise UsageError for an effect that can do nothing on a rig of this kind."""
    for effect in switched_on:
        stage = effects()[effect.id].stage
        if kind is Kind.BENCH and stage in NOT_ON_A_BENCH:
            idle = f"{effect.id} is an effect of the {stage}, which a bench has none of"
            raise click.UsageError(f"{idle}: it does nothing")


def json_text(result: Mapping[str, Any] | Sequence[Any]) -> str:
    """Give the result as text. NaN is no JSON: put None in its place."""
    return json.dumps(result, indent=2, allow_nan=False) + "\n"


def write_json(path: Path | None, result: Mapping[str, Any] | Sequence[Any]) -> None:
    """Write the result, or do nothing without a path; see `json_text`."""
    if path is not None:
        write_document(path, json_text(result))


def add_json_line(path: Path | None, result: Mapping[str, Any]) -> None:
    """Add a result to a file or to stdout, as one line; it stands there at once, whatever comes."""
    text = json.dumps(result, allow_nan=False) + "\n"
    if path == STDOUT:
        write_document(path, text)
    elif path is not None:
        with failures_named(path, "write"), path.open("a", encoding="utf-8") as file:
            file.write(text)


def write_document(path: Path, text: str) -> None:
    """Write what `json_option` or `html_option` asked for to its file, or to stdout."""
    if path == STDOUT:
        stdout = click.get_current_context().meta[STDOUT_TAKEN]
        for begin in range(0, len(text), ATOMIC):
            click.echo(text[begin : begin + ATOMIC], file=stdout, nl=False)
    else:
        atomic_write_text(path, text)
