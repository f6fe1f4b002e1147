"""Options that several commands share, and what they stand for."""

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

from skiplatch.files import atomic_write_text

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

SEED_MAX = 2**63 - 1


def _usable_cores() -> int:
    return len(os.sched_getaffinity(0))


seed_option: Decorator = click.option(
    "--seed",
    type=click.IntRange(0, SEED_MAX),
    default=1,
    show_default=True,
    help="Picks the random numbers; the same seed gives the same result.",
)

jobs_option: Decorator = click.option(
    "--jobs",
    type=click.IntRange(1, 1024),
    default=_usable_cores,
    show_default="all cores",
    help="Threads to work on; the result does not depend on it.",
)

json_option: Decorator = click.option(
    "--json",
    "json_path",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Also write the result as JSON to this file.",
)


def write_json(path: Path | None, result: Mapping[str, Any]) -> None:
    """Write the result, or do nothing without a path. NaN is no JSON: put None in its place."""
    if path is not None:
        atomic_write_text(path, json.dumps(result, indent=2, allow_nan=False) + "\n")
