"""A command of commands, each in a module of its own."""

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import click


class LazyGroup(click.Group):
    """Loads a command, with its reports and pictures, only when it is called."""

    def __init__(self, name: str, subcommands: Sequence[str], **attributes: Any) -> None:  # noqa: ANN401
        """Name the modules ``skiplatch.commands.NAME_SUBCOMMAND``."""
        super().__init__(name, **attributes)
        self._subcommands = subcommands

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Give the names in their order."""
        del ctx
        return list(self._subcommands)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Load a command; None for an unknown name."""
        del ctx
        if cmd_name not in self._subcommands:
            return None
        module = import_module(f"skiplatch.commands.{self.name}_{cmd_name}")
        found: click.Command = module.command
        return found
