"""What is wrong with the user's input, told in one line, or in one for each of several things."""

import os
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any, Self

SHOWN_CHARACTERS = 40
"""Of a piece of the input that a message quotes."""
MOST_CHARACTERS = 1000
"""Of a message: libraries quote in theirs what they could not read, however long it is."""
MOST_TOLD = 20
"""Of the things that are wrong with one file."""


class _Located:
    """A message on a place in a file, in one line: ``path:line:column: message``.

    Attributes:
        path: The file or folder, as the user named it.
        line: Line number from 1, or None when it is not known.
        column: Character position from 1, or the name of a CSV column, or None.
        message: What is wrong there.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        line: int | None,
        column: int | str | None,
        message: str,
    ) -> None:
        self.path = path
        self.line = line
        self.column = column
        self.message = message

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path, self.line, self.column, self.message)

    def __str__(self) -> str:
        place = os.fspath(self.path)
        if self.line is not None:
            place += f":{self.line}"
        if isinstance(self.column, str):
            place += f": {self.column}"
        elif self.column is not None:
            place += f":{self.column}"
        return one_line(f"{place}: {shortened(self.message, MOST_CHARACTERS)}")


class InputError(_Located, Exception):
    """The input is wrong and cannot be used.

    Attributes:
        further: What else is wrong with the same input, or with another file of it; each is a line
            of its own.
    """

    further: Sequence["InputError"] = ()

    @property
    def apart(self) -> Sequence["InputError"]:
        """All of them, one by one."""
        return (InputError(self.path, self.line, self.column, self.message), *self.further)

    @classmethod
    def together(cls, errors: Sequence["InputError"]) -> Self:
        """Make one of several on the same input, by their lines."""
        first, *others = sorted(errors, key=lambda error: error.line or 0)
        joined = cls(first.path, first.line, first.column, first.message)
        joined.further = tuple(others)
        return joined

    def __reduce__(self) -> tuple[Any, ...]:
        return *super().__reduce__(), {"further": self.further}

    def __str__(self) -> str:
        lines = [super().__str__(), *map(str, self.further[: MOST_TOLD - 1])]
        if more := len(self.further) + 1 - len(lines):
            lines.append(f"{one_line(os.fspath(self.path))}: and {more} more")
        return "\n".join(lines)


class CampaignWarning(_Located, UserWarning):
    """The campaign can be used, but something in it is ignored; given by ``warnings.warn``."""


def as_told(error: object) -> str:
    """Give it as the command line says it: each line begins with the program's name."""
    return "\n".join(f"skiplatch: {line}" for line in str(error).split("\n"))


def one_line(text: str) -> str:
    """Write every unprintable character, line ends among them, as an escape."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def quoted(text: str) -> str:
    """Quote a piece of the input for a message, shortened when it is long."""
    return f'"{one_line(shortened(text))}"'


def shortened(text: str, most: int = SHOWN_CHARACTERS) -> str:
    """Give at most so many characters, with an ellipsis for what is left out."""
    return text if len(text) <= most else text[: most - 1] + "…"


def hint(name: str, known: Iterable[str]) -> str:
    """Propose the known name that an unknown one may be a slip of, or give nothing."""
    close = get_close_matches(name[:SHOWN_CHARACTERS], known, n=1, cutoff=0.75)
    return f"; did you mean {quoted(close[0])}?" if close else ""
