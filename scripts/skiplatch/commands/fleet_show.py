"""``skiplatch fleet show``: what a rig was, campaign by campaign."""

from pathlib import Path
from typing import Any

import click

from skiplatch.commands.fleet_options import KEY_DIGITS, answer_text, plain, store_option
from skiplatch.commands.options import json_option, write_json
from skiplatch.fleet.reading import opened
from skiplatch.tables import number

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
    rows = [{**row, "campaign": row["campaign"][:KEY_DIGITS]} for row in history.mappings()]
    cells = [{**row, "effects": _effects(row["effects"])}.values() for row in rows]
    click.echo(answer_text(history.columns, cells))
    write_json(json_path, {"rig": rig, "campaigns": plain(history.mappings())})


def _effects(effects: list[dict[str, Any]] | None) -> str | None:
    parts = [
        f"{e['effect']}.{e['parameter']} = {number(e['value'])} "
        f"({number(e['low'])} … {number(e['high'])})"
        for e in effects or ()
    ]
    return "; ".join(parts) or None
