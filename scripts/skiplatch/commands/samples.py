"""``skiplatch samples``: the sample campaigns, copied to where the reader works."""

from pathlib import Path

import click

from skiplatch.commands.options import json_option, write_json
from skiplatch.commands.outputs import OutputFolder
from skiplatch.files import atomic_copy_folder
from skiplatch.places import SAMPLES

EPILOG = """\b
Example:
  skiplatch samples --out build/samples
"""


@click.command(epilog=EPILOG)
@click.option(
    "-o",
    "--out",
    type=OutputFolder(is_new=True),
    required=True,
    help="Folder to make; must not hold anything yet.",
)
@json_option
def command(out: Path, json_path: Path | None) -> None:
    """Copy the sample campaigns and plans, with a README that says what is in them.

    Examples in --help name them as scripts/samples, where a checkout has them. With --out
    scripts/samples they run as they stand without a checkout, too.
    """
    names = sorted(path.name for path in SAMPLES.iterdir() if path.is_dir())
    atomic_copy_folder(SAMPLES, out)
    click.echo(f"{out}: {', '.join(names)}")
    write_json(json_path, {"out": str(out), "folders": names})
