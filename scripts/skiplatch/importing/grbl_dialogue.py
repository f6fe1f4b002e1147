"""Which command a reply of grbl answers: commands are answered in their order, or refused."""

import re
from collections import deque
from collections.abc import Callable

from skiplatch.importing.gcode import without_comments
from skiplatch.importing.log_lines import Line
from skiplatch.importing.probe_move import ProbeMove

_COMMAND = re.compile(
    r"(?:^|[\s\[:>\"'])(\$J(?:og)?=.*|(?:N\d+\s*)?(?:G|F|M|X|Y|Z|#)\s*[-+\d.\[#].*)",
    re.IGNORECASE,
)
"""G-code, or a jog: other lines that begin with $ are no motion, even with G-code in them."""
_REPORT = re.compile(r"^\s*(?:<|\$(?!J)|ok\b|error|ALARM|\[(?!\s*[GgFfXxYyZz]|echo)|\*\*\*)")
_PROSE = re.compile(r"\berror\b|(?:[A-Za-z]+\W+){4}", re.IGNORECASE)
"""What stands before a command in a sentence about it; marks before a command are shorter."""
_PROBES = re.compile(r"G38", re.IGNORECASE)
_ANSWER = r"(?:^|[<\]]\s*)"  # at the beginning, or behind the command on the same line
_NOT_BEGUN = re.compile(_ANSWER + r"ALARM:4\b")  # the probe was open or closed already
_REFUSED = re.compile(_ANSWER + r"error\b", re.IGNORECASE)
_DONE = re.compile(_ANSWER + r"ok\b", re.IGNORECASE)
_STARTED = re.compile(_ANSWER + r"(?:Grbl(?:HAL)? \d|FluidNC v)", re.IGNORECASE)


def command_in(text: str) -> str | None:
    """Give the command in a line: after a mark, not within a comment or a sentence about it."""
    text = without_comments(text)
    if _REPORT.match(text) or not (command := _COMMAND.search(text)):
        return None
    if _PROSE.search(text[: command.start(1)]):
        return None
    return command[1].split("]")[0]


def probes(text: str) -> bool:
    """Tell whether a command probes."""
    return bool(_PROBES.search(text))


class Dialogue:
    """Commands that were sent, and the probing moves that wait for their touch.

    Senders that stream are some commands ahead of the controller.
    """

    def __init__(self, execute: Callable[[str, Line], ProbeMove | None]) -> None:
        self._execute = execute
        self._moves: deque[ProbeMove] = deque()
        self._ahead: deque[tuple[str, Line]] = deque()  # sent before the touch they follow
        self._unanswered: deque[str] = deque()  # without their ok or error
        self._has_oks = False

    def sent(self, text: str, line: Line, *, is_answered: bool = False) -> None:
        """Carry out a command, or keep it until the touch before it was answered."""
        if not is_answered:
            self._unanswered.append(text)
        self._ahead.append((text.replace("*", ""), line))
        self.catch_up()

    def catch_up(self) -> None:
        """Carry out what was sent ahead, up to the next probing move."""
        while self._ahead and not self._moves:
            if move := self._execute(*self._ahead.popleft()):
                self._moves.append(move)

    @property
    def is_probing(self) -> bool:
        """Whether a probing move was carried out whose touch has not come."""
        return bool(self._moves)

    def touched(self) -> ProbeMove | None:
        """Give the move that a touch answers; all that was sent before it is answered too."""
        while self._unanswered and not probes(self._unanswered[0]):
            self._unanswered.popleft()
        return self._moves.popleft() if self._moves else None

    def answered(self, text: str) -> ProbeMove | None:
        """Take a line that may be an answer without a touch.

        Give the move that it says did not begin, as the probe was triggered before.
        """
        if _NOT_BEGUN.search(text):
            return self._drop_first_probing()
        if _REFUSED.search(text):
            self._refused()
        elif _DONE.search(text):
            self._has_oks = True
            if self._unanswered:
                self._unanswered.popleft()
        return None

    def started(self, text: str) -> bool:
        """Tell whether a controller started anew; it answers nothing of what was sent before."""
        if not _STARTED.search(text):
            return False
        self._moves.clear()
        self._ahead.clear()
        self._unanswered.clear()
        return True

    def _refused(self) -> None:
        """Take back a probing move that the controller refused: no touch answers it.

        Where the log shows no ok, the command sent last is meant.
        """
        if not self._unanswered:
            return
        text = self._unanswered.popleft() if self._has_oks else self._unanswered.pop()
        if probes(text) and not self._has_oks and self._ahead:
            self._ahead.pop()
        elif probes(text):
            self._drop_first_probing()

    def _drop_first_probing(self) -> ProbeMove | None:
        dropped = self._moves.popleft() if self._moves else None
        self.catch_up()
        return dropped
