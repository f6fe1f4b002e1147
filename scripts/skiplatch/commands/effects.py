"""``skiplatch effects``: the table of effects."""

from dataclasses import asdict
from pathlib import Path

import click

from skiplatch.commands.options import json_option, write_json
from skiplatch.simulator import EffectDescription, effects
from skiplatch.tables import table

EPILOG = """\b
Example:
  skiplatch simulate --effect backlash:backlash_um=3.5 \\
      --nominal scripts/samples/machine_no_gap/nominal.toml \\
      --conditions scripts/samples/machine_no_gap/touches.csv --out build/with_backlash
"""

HEADER = ("effect", "stage", "paths", "parameter", "unit", "from", "to")


def _rows(effect: EffectDescription) -> list[tuple[str, ...]]:
    rows = []
    for number, parameter in enumerate(effect.parameters):
        first = (effect.id, effect.stage, effect.paths) if number == 0 else ("", "", "")
        limits = (f"{parameter.low:g}", f"{parameter.high:g}")
        rows.append((*first, parameter.name, parameter.unit, *limits))
    return rows


@click.command(epilog=EPILOG)
@json_option
def command(json_path: Path | None) -> None:
    """List every effect with its stage, paths, parameters and ranges, in the order of the chain."""
    rows = [row for effect in effects().values() for row in _rows(effect)]
    click.echo(table(HEADER, rows))
    write_json(json_path, {"effects": [asdict(effect) for effect in effects().values()]})
