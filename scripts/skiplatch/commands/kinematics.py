"""``skiplatch kinematics``: location errors of rotary axes."""

import click

from skiplatch.commands.lazy_group import LazyGroup

SUBCOMMANDS = ("fit", "probing", "run", "sphere")
EPILOG = """\b
Example:
  skiplatch kinematics run scripts/samples/kinematics/optimise_positions.h --html build/log.html
"""


@click.group(name="kinematics", cls=LazyGroup, subcommands=SUBCOMMANDS, epilog=EPILOG)
def command() -> None:
    """Find the location errors of rotary axes from touches of a sphere."""
