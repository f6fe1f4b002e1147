"""The group of ``skiplatch import``: of a file of another kind its commands say who reads it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from skiplatch.errors import InputError


class Importer(click.Command):
    """Reads a kind of log."""

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401
        """See `click.Command.invoke`."""
        try:
            return super().invoke(ctx)
        except InputError as error:
            # Only who has given the wrong file waits for it to be looked at.
            from skiplatch.importing.kinds import other_kind  # noqa: PLC0415

            path = Path(error.path)
            if path in self._logs(ctx) and (said := other_kind(path, self.name or "")):
                raise InputError(path, None, None, said) from error
            raise

    def _logs(self, ctx: click.Context) -> Iterator[Path]:
        """Give the files that are to be read, which are arguments; what goes with them is not."""
        for param in self.params:
            if isinstance(param, click.Argument):
                given = ctx.params[str(param.name)]
                yield from given if isinstance(given, tuple) else (given,)


class Importers(click.Group):
    """A group of such."""

    command_class = Importer
