"""``skiplatch fleet``: campaigns of many rigs and months in one store."""

import click

from skiplatch.commands.lazy_group import LazyGroup

SUBCOMMANDS = (
    "add",
    "list",
    "show",
    "query",
    "export",
    "remove",
    "check",
    "report",
    "watch",
    "verify",
)
EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
"""


@click.group(name="fleet", cls=LazyGroup, subcommands=SUBCOMMANDS, epilog=EPILOG)
def command() -> None:
    """Keep the campaigns of many rigs and months in one store, and ask it.

    A store is a folder of Parquet files, partitioned by rig and month.
    """
