"""``skiplatch init``: a nominal.toml to begin with."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from skiplatch.campaign.datum import Datum
from skiplatch.commands.options import json_option, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text
from skiplatch.importing.presets import PRESETS, Preset
from skiplatch.importing.writing import nominal_text
from skiplatch.tables import listing

EPILOG = """\b
Example:
  skiplatch init --preset grbl-avr --out nominal.toml
"""


@click.command(epilog=EPILOG)
@click.option("--preset", type=click.Choice(list(PRESETS)), help="The kind of rig.")
@click.option("-o", "--out", type=OutputFile(), help="File that is written.")
@json_option
def command(preset: str | None, out: Path | None, json_path: Path | None) -> None:
    """Write a nominal.toml with every key commented and a source for each figure.

    Without options it lists the presets; without --out it prints the text.
    """
    if preset is None:
        if out is not None:
            raise click.UsageError("--out needs --preset")
        click.echo(listing([(name, rig.about) for name, rig in PRESETS.items()]))
        write_json(json_path, {"presets": [_as_json(name) for name in PRESETS]})
        return
    chosen = PRESETS[preset]
    _write(out, chosen)
    write_json(json_path, {"out": None if out is None else str(out), **_as_json(preset)})


def _write(out: Path | None, chosen: Preset) -> None:
    text = nominal_text(chosen.kind, chosen.figures, Datum.of_kind(chosen.kind).free)
    if out is None:
        click.echo(text, nl=False)
        return
    if out.exists():
        raise InputError(out, None, None, "exists already")
    atomic_write_text(out, text)
    click.echo(f"wrote {out}: {chosen.about}")


def _as_json(preset: str) -> dict[str, Any]:
    """Give a preset with its figures, whose keys are those of nominal.toml: plc.scan_us."""
    chosen = PRESETS[preset]
    figures = {".".join(key): asdict(figure) for key, figure in chosen.figures.items()}
    return {"preset": preset, "kind": chosen.kind, "about": chosen.about, "figures": figures}
