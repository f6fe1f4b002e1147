"""``skiplatch fleet``: campaigns of many rigs and months in one store."""

from importlib import import_module

import click

SUBCOMMANDS = ("add", "list", "show", "query", "export")


class _Group(click.Group):
    """Loads a command only when it is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(SUBCOMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        if cmd_name not in SUBCOMMANDS:
            return None
        found: click.Command = import_module(f"skiplatch.commands.fleet_{cmd_name}").command
        return found


EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
"""


@click.group(name="fleet", cls=_Group, epilog=EPILOG)
def command() -> None:
    """Keep the campaigns of many rigs and months in one store, and ask it.

    A store is a folder of Parquet files, partitioned by rig and month.
    """
