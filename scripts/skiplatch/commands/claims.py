"""What a command reads and writes: no file for two outputs, and none over what it reads.

The paths of a command line claim what they name while they are parsed, and a command claims the
files that it names itself. What is updated in place, which is the store of `kinematics run` and
that of a fleet, is claimed as an input alone: so nothing else goes there.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import click

from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE

STDOUT_TAKEN = "skiplatch.stdout"
"""Key of what a command keeps with its context: the stdout that a document goes to."""


@dataclass(frozen=True, slots=True)
class _Claim:
    """A file or folder that a command reads or writes.

    Attributes:
        path: As it was named.
        param: The option that names it, if one does.
        is_output: Whether it is written.
        is_whole: Of a folder: whether all that is in it is meant.
    """

    path: Path
    param: click.Parameter | None
    is_output: bool
    is_whole: bool

    def meets(self, other: "_Claim") -> bool:
        """Say whether both are one file, by links too, or one lies in the other.

        A folder may be read and written into; in a device or a pipe nothing is lost.
        """
        one, two = Path(os.path.realpath(self.path)), Path(os.path.realpath(other.path))
        if (other.is_whole and two in one.parents) or (self.is_whole and one in two.parents):
            return True
        if os.path.exists(one) and os.path.exists(two):  # noqa: PTH110  which asks no questions
            return one.is_file() and one.samefile(two)
        return one == two


def claim_output(
    path: Path, param: click.Parameter | None = None, *, is_whole: bool = False
) -> None:
    """Note a file or folder that is written.

    Raises:
        click.BadParameter: It is read, or written as well by another option.
    """
    _claim(_Claim(path, param, is_output=True, is_whole=is_whole))


def claim_input(
    path: Path, param: click.Parameter | None = None, *, is_whole: bool = False
) -> None:
    """Note a file that is read, or a folder with the campaign in it.

    Raises:
        click.BadParameter: An option names it as an output.
    """
    for one in (path, path / NOMINAL_FILE, path / TOUCHES_FILE):
        _claim(_Claim(one, param, is_output=False, is_whole=is_whole))


def goes_to_files() -> bool:
    """Tell whether the command at work writes a file, and nothing that was asked for to stdout."""
    context = click.get_current_context(silent=True)
    claims: list[_Claim] = context.meta.get(__name__, []) if context else []
    return any(one.is_output for one in claims) and not (context and STDOUT_TAKEN in context.meta)


def _claim(mine: _Claim) -> None:
    context = click.get_current_context(silent=True)
    if context is None:  # a type that is asked by itself
        return
    claims: list[_Claim] = context.meta.setdefault(__name__, [])
    for other in claims:
        output, second = (mine, other) if mine.is_output else (other, mine)
        if output.is_output and mine.meets(other):
            raise click.BadParameter(f"{output.path} {_clash(second)}", context, output.param)
    claims.append(mine)


def _clash(other: _Claim) -> str:
    if other.is_output:
        return "is named for two outputs"
    if other.is_whole:
        return f"lies in {other.path}, which is an input as a whole"
    return "is an input, and would be overwritten"
