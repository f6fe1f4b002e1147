"""Which errors of probing are told twice: a command fails once, whoever repeats what was said.

Pronterface shows an error as it was received, and again behind ``[ERROR]``.
"""

import re

from skiplatch.importing.log_lines import Line
from skiplatch.importing.model import Imported
from skiplatch.importing.named_lines import named

_COMMAND = re.compile(r"^(?:N\d+\s*)?(?:G29|G30|G38\.[2-5]|M48)(?!\d)", re.IGNORECASE)
_DIGITS = re.compile(r"\d+")


class Attempts:
    """Follows commands that probe, and what came of them."""

    def __init__(self) -> None:
        self._before: Line | None = None
        self._last: Line | None = None
        self._waiting = 0
        self._failed_text = ""
        self._failed_by_command = False
        self._repeats: list[int] = []

    def take(self, line: Line) -> None:
        """Take each line first, as the one before tells what is shown again."""
        self._before, self._last = self._last, line
        if _COMMAND.match(line.text) and not self._is_shown_again(line):
            self._waiting += 1

    def touched(self) -> None:
        """Take that a command met something."""
        self._waiting, self._failed_text = max(0, self._waiting - 1), ""

    def fails(self, line: Line) -> bool:
        """Take an error, and tell whether an attempt failed that no line before has told of."""
        is_same = line.text.lower() == self._failed_text
        is_of_none = self._failed_by_command and not self._waiting
        if is_same and (is_of_none or self._is_shown_again(line)):
            self._repeats.append(line.number)
            return False
        self._failed_by_command = self._waiting > 0
        self._waiting, self._failed_text = max(0, self._waiting - 1), line.text.lower()
        return True

    def _is_shown_again(self, line: Line) -> bool:
        """Tell the same words in the next line, with something else before them than a time."""
        before = self._before
        return before is not None and before.text == line.text and _mark(before) != _mark(line)

    def say(self, found: Imported) -> None:
        """Say which errors count once."""
        if self._repeats:
            said = "errors that only repeat the one before, of the same command"
            found.assumed.append(f"{said}: {len(self._repeats)}, {named(self._repeats)}")


def _mark(line: Line) -> str:
    """Give what stands before the words of a line, without the digits of a time or a number."""
    return _DIGITS.sub("", line.raw.partition(line.text)[0])
