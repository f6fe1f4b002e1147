"""Files and folders that commands read: nothing that they write goes there."""

import os
from pathlib import Path
from typing import Any

import click

from skiplatch.commands.claims import claim_input


def refuse_nameless(
    value: Any,  # noqa: ANN401
    kind: click.Path,
    param: click.Parameter | None,
    ctx: click.Context | None,
) -> None:
    """Raise click.BadParameter for an empty path, which would be the folder that one is in."""
    if not os.fspath(value):
        kind.fail(f"expected the name of a {kind.name}, got nothing", param, ctx)


class Source(click.Path):
    """A file or a folder that is read.

    Args:
        is_file: Whether it is no folder.
        is_folder: Whether it is no file.
        is_whole: Of a folder: whether all that is in it is read, and not just a campaign.
    """

    def __init__(
        self, *, is_file: bool = False, is_folder: bool = False, is_whole: bool = False
    ) -> None:
        super().__init__(path_type=Path, dir_okay=not is_file, file_okay=not is_folder)
        self.is_whole = is_whole

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:  # noqa: ANN401
        """See `click.ParamType.convert`."""
        refuse_nameless(value, self, param, ctx)
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        claim_input(path, param, is_whole=self.is_whole)
        return path


FILE = Source(is_file=True)
