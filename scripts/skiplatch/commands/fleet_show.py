"""``skiplatch fleet show``: what a rig was, campaign by campaign."""

from pathlib import Path
from typing import Any

import click

from skiplatch.commands.fleet_options import (
    answer_text,
    in_own_units,
    plain,
    store_option,
)
from skiplatch.commands.options import json_option, write_json
from skiplatch.fleet.layout import KEY_DIGITS
from skiplatch.fleet.reading import opened
from skiplatch.fleet.turned import turned_unit
from skiplatch.tables import number

AXES = "axes"
EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet show bench-1 --store build/store
"""


@click.command(epilog=EPILOG)
@click.argument("rig")
@store_option
@json_option
def command(rig: str, store: Path, json_path: Path | None) -> None:
    """Show the campaigns of a RIG in the order of time.

    Mean and standard deviation of the deviations, verdict and gap of the diagnosis, and each
    effect's parameters with their intervals.
    """
    with opened(store, with_touches=False) as reader:
        history = reader.history(rig)
    told = in_own_units(history)
    cells = [_told(row) for row in told.mappings()]
    click.echo(answer_text([name for name in told.columns if name != AXES], cells))
    write_json(json_path, {"rig": rig, "campaigns": plain(history.mappings())})


def _told(row: dict[str, Any]) -> list[Any]:
    axes = row.pop(AXES)
    short = {"campaign": row["campaign"][:KEY_DIGITS], "effects": _effects(row["effects"], axes)}
    return list({**row, **short}.values())


def _effects(effects: list[dict[str, Any]] | None, axes: str) -> str | None:
    return "; ".join(_effect(one, axes) for one in effects or ()) or None


def _effect(one: dict[str, Any], axes: str) -> str:
    unit = turned_unit(one["effect"], one["parameter"], axes)
    value, low, high = (number(one[name]) for name in ("value", "low", "high"))
    said = f"{one['effect']}.{one['parameter']} = {value} ({low} … {high})"
    return f"{said} {unit}" if unit else said
