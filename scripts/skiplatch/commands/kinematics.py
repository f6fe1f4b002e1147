"""``skiplatch kinematics``: location errors of rotary axes."""

from importlib import import_module

import click

SUBCOMMANDS = ("fit", "probing", "run", "sphere")


class _Group(click.Group):
    """Loads a command, with its reports and pictures, only when it is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(SUBCOMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        if cmd_name not in SUBCOMMANDS:
            return None
        found: click.Command = import_module(f"skiplatch.commands.kinematics_{cmd_name}").command
        return found


EPILOG = """\b
Example:
  skiplatch kinematics run scripts/samples/kinematics/optimise_positions.h --html build/log.html
"""


@click.group(name="kinematics", cls=_Group, epilog=EPILOG)
def command() -> None:
    """Find the location errors of rotary axes from touches of a sphere."""
