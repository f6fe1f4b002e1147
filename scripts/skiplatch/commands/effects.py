"""``skiplatch effects``: the table of effects."""

from collections.abc import Iterable
from dataclasses import asdict
from itertools import groupby
from pathlib import Path

import click

from skiplatch.commands.options import json_option, write_json
from skiplatch.simulator.effects import EffectDescription, Parameter, effects
from skiplatch.tables import listing

EPILOG = """\b
Examples:
  skiplatch effects
  skiplatch simulate --effect backlash:backlash_um=3.5 \\
      --nominal scripts/samples/machine_no_gap/nominal.toml \\
      --conditions scripts/samples/machine_no_gap/touches.csv --out build/with_backlash
"""

MARKDOWN_HEADER = """\
| effect | stage | paths | what happens | parameters |
|---|---|---|---|---|"""


def _number(value: float) -> str:
    return f"{value:.10g}"


def _range(parameter: Parameter) -> str:
    """Give the range with its unit; a pure number has none."""
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    return f"{_number(parameter.low)} … {_number(parameter.high)}{unit}"


def _as_text(table: Iterable[EffectDescription]) -> str:
    """Group the effects by stage: one row an effect, and under it one row a parameter."""
    rows = []
    for stage, of_stage in groupby(table, key=lambda row: row.stage):
        rows.append((f"{stage}:", "", ""))
        for row in of_stage:
            rows.append((f"  {row.id}", row.paths, row.physics))
            rows += [(f"    {p.name}", _range(p), p.meaning) for p in row.parameters]
        rows.append(("", "", ""))
    return listing(rows)


def _as_markdown(table: Iterable[EffectDescription]) -> str:
    """Lay out one row an effect."""
    lines = [MARKDOWN_HEADER]
    for row in table:
        parameters = "<br>".join(f"`{p.name}` {_range(p)}: {p.meaning}" for p in row.parameters)
        cells = (f"`{row.id}`", row.stage, row.paths, row.physics, parameters)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


@click.command(epilog=EPILOG)
@click.option("--markdown", is_flag=True, help="Print a Markdown table, as docs/GAP.md has it.")
@json_option
def command(markdown: bool, json_path: Path | None) -> None:  # noqa: FBT001
    """List every effect that a simulation can be given, in the order of the chain.

    Per effect: the input paths it acts on and what happens; per parameter: range, unit, meaning.
    """
    table = effects().values()
    click.echo(_as_markdown(table) if markdown else _as_text(table).rstrip())
    if not markdown:
        click.echo("\nSwitch one on: skiplatch simulate --effect ID:NAME=VALUE,NAME=VALUE …")
    write_json(json_path, {"effects": [asdict(effect) for effect in table]})
