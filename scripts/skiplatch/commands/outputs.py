"""Files and folders that commands write: what cannot be written is refused before any work."""

import os
from pathlib import Path
from typing import Any

import click

from skiplatch.commands.claims import claim_output
from skiplatch.commands.inputs import refuse_nameless
from skiplatch.files import refuse_occupied, refuse_unwritable

STDOUT = Path("-")


class OutputFile(click.Path):
    """A file that is written, in a folder that is there; or - for stdout, where that is allowed.

    Args:
        allow_dash: Whether - stands for stdout.
        makes_folders: Whether folders above it are made where they are missing.
    """

    name = "file"

    def __init__(self, *, allow_dash: bool = False, makes_folders: bool = False) -> None:
        super().__init__(path_type=Path, dir_okay=False, allow_dash=allow_dash)
        self.makes_folders = makes_folders

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:  # noqa: ANN401
        """See `click.ParamType.convert`."""
        refuse_nameless(value, self, param, ctx)
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if path == STDOUT:
            if not self.allow_dash:
                self.fail("expected the name of a file: this is not written to stdout", param, ctx)
            return path
        if os.fspath(value).endswith(os.sep):
            self.fail(f"expected the name of a file, got that of a folder, {value}", param, ctx)
        refuse_unwritable(path, makes_folders=self.makes_folders)
        claim_output(path, param)
        return path


class OutputFolder(click.Path):
    """A folder that is written into, and made with those above it where they are missing.

    Args:
        is_new: Whether it must not hold anything yet.
    """

    name = "folder"

    def __init__(self, *, is_new: bool = False) -> None:
        super().__init__(path_type=Path, file_okay=False)
        self.is_new = is_new

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:  # noqa: ANN401
        """See `click.ParamType.convert`."""
        refuse_nameless(value, self, param, ctx)
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if path == STDOUT:
            self.fail("expected the name of a folder: this is not written to stdout", param, ctx)
        if self.is_new:
            refuse_occupied(path)
        refuse_unwritable(path, makes_folders=True)
        claim_output(path, param, is_whole=self.is_new)
        return path
