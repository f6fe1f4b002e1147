"""Commands of grbl, carried out as far as probing moves need it.

What hangs on the offset between the program's coordinates and the machine's is not known.
"""

import re
from collections.abc import Sequence

from skiplatch.importing.gcode import Machine, without_comments
from skiplatch.importing.log_lines import Line
from skiplatch.importing.probe_move import AXES, ProbeMove

_FEED_0 = re.compile(r"\bF0(?:\.0*)?\b")
_IN_MACHINE = re.compile(r"G53(?!\d)", re.IGNORECASE)
_OFFSETS = re.compile(r"G(?:10|28|30|43|49|92|5[4-9])(?!\d)", re.IGNORECASE)
_TOOL_CHANGES = (6.0, 61.0)  # M6, and M61 that tells of one by hand
_UNIT = re.compile(r"G2[01](?!\d)", re.IGNORECASE)


class Commands:
    """Follows modes and positions.

    Attributes:
        units: Those of G20 and G21 that were told.
        tools: Changes of the tool between touches.
    """

    def __init__(self, *, inch: bool) -> None:
        self.units: set[str] = set()
        self.tools = 0
        self._tool_has_touched = False
        self._begins_in_inches = inch
        self._machine = Machine(is_inch=inch)
        self._program: dict[str, float] = {}  # where its absolute moves went, as it counts

    def take_modes(self, text: str, line: Line) -> None:
        """Take the modes that ``[GC:…]`` lists; F0 there is a feed that is not set."""
        self._note_unit(text)
        self._machine.execute(_FEED_0.sub("", text), line.number)

    def homed(self) -> None:
        """Forget where the axes were."""
        self._machine.position.clear()
        self._program.clear()

    def restarted(self) -> None:
        """Take back modes and feed, as a controller does that starts anew: G21, G90, no F."""
        self._machine = Machine(is_inch=self._begins_in_inches)
        self._program.clear()

    def touched(self, position: Sequence[float]) -> None:
        """Go on from where a touch was latched, in machine coordinates.

        The program goes on in its own, which are the same only where no offset is set. Relative
        moves need no more than this.
        """
        self._machine.position = dict(zip(AXES, position, strict=False))
        self._tool_has_touched = True

    def execute(self, text: str, line: Line) -> ProbeMove | None:
        """Carry out a command and give the probing move in it."""
        text = without_comments(text)
        if text.startswith("$"):
            self._jogged(text)
            return None
        self._note_unit(text)
        self._note_tool(text)
        before = dict(self._machine.position)
        move = self._machine.execute(text, line.number)
        places = {n: v for n, v in self._machine.words(text) if n in AXES and v is not None}
        if _IN_MACHINE.search(text):
            reached = {n: v * self._machine.unit_of(n) for n, v in places.items()}
            self._machine.position = before | reached
            self._program = {n: v for n, v in self._program.items() if n not in places}
        elif self._machine.is_relative or _OFFSETS.search(text):
            self._program.clear()
        else:
            move = self._in_unknown_offset(move, places)
        return move

    def _jogged(self, text: str) -> None:
        """Forget where the axes of a jog are: senders cancel jogs, and logs do not show it.

        It leaves the modes and the feed of other commands as they are.
        """
        for letter, _ in self._machine.words(text):
            self._machine.position.pop(letter, None)
            self._program.pop(letter, None)

    def _in_unknown_offset(
        self, move: ProbeMove | None, places: dict[str, float]
    ) -> ProbeMove | None:
        """Forget what hangs on the offset between the program's coordinates and the machine's.

        What is left is the sense, from the place that the program named before.
        """
        senses = {n: v - self._program[n] for n, v in places.items() if n in self._program}
        self._program |= places
        for letter in places:
            self._machine.position.pop(letter, None)
        if move is None:
            return None
        self._program = {n: v for n, v in places.items() if senses.get(n) == 0.0}  # that stay
        return move.along({n: senses.get(n) for n in places})

    def _note_unit(self, text: str) -> None:
        self.units |= {code.upper() for code in _UNIT.findall(text)}

    def _note_tool(self, text: str) -> None:
        words = self._machine.words(text)
        if any(letter == "M" and value in _TOOL_CHANGES for letter, value in words):
            self.tools += self._tool_has_touched
            self._tool_has_touched = False
