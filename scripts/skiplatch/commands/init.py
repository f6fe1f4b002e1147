"""``skiplatch init``: a nominal.toml to begin with."""

from pathlib import Path

import click

from skiplatch.campaign.datum import Datum
from skiplatch.commands.outputs import OutputFile
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text
from skiplatch.importing.presets import PRESETS
from skiplatch.importing.writing import nominal_text
from skiplatch.tables import listing

EPILOG = """\b
Example:
  skiplatch init --preset grbl-avr --out nominal.toml
"""


@click.command(epilog=EPILOG)
@click.option("--preset", type=click.Choice(list(PRESETS)), help="The kind of rig.")
@click.option("-o", "--out", type=OutputFile(), help="File that is written.")
def command(preset: str | None, out: Path | None) -> None:
    """Write a nominal.toml with every key commented and a source for each figure.

    Without options it lists the presets; without --out it prints the text.
    """
    if preset is None:
        click.echo(listing([(name, rig.about) for name, rig in PRESETS.items()]))
        return
    chosen = PRESETS[preset]
    text = nominal_text(chosen.kind, chosen.figures, Datum.of_kind(chosen.kind).free)
    if out is None:
        click.echo(text, nl=False)
        return
    if out.exists():
        raise InputError(out, None, None, "exists already")
    atomic_write_text(out, text)
    click.echo(f"wrote {out}: {chosen.about}")
