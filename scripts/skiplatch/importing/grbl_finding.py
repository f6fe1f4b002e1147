"""Touches by which programs of ``design --gcode grbl`` find a surface: they measure nothing.

They begin where somebody has set the probe by hand. Their commands tell them, as senders take
comments out: no other program goes on by just these.
"""

import re

from skiplatch.importing.model import Imported

_SPACES = re.compile(r"\s+|^\s*N\d+", re.IGNORECASE)
_MODES = "G21G94"
_FINDS = re.compile(r"G91G38\.2([XYZ])[-+.\d]+F([.\d]+)")
_BACK = re.compile(r"G90G53G1([XYZ])[-+.\d]+F([.\d]+)")


class Finding:
    """Follows commands in the order in which they are carried out.

    Attributes:
        begun: Numbers of the touches, from 0, that begin as those of such a program do.
        found: Those of them that it went on behind.
    """

    def __init__(self) -> None:
        self.begun: list[int] = []
        self.found: list[int] = []
        self._before = ""
        self._by: tuple[str, float] | None = None

    def sent(self, command: str, touches: int) -> None:
        """Take a command; so many touches were made before it."""
        text, before = _SPACES.sub("", command).upper(), self._before
        self._before = text
        if (finds := _FINDS.fullmatch(text)) and before == _MODES:
            self.begun.append(touches)
            self._by = (finds[1], float(finds[2]))
        elif back := _BACK.fullmatch(text):
            is_of_it = before == "G90" and self._by == (back[1], float(back[2]))
            if is_of_it and self.begun[-1] == touches - 1:
                self.found.append(touches - 1)
            self._by = None
        elif text != "G90":
            self._by = None

    def leave_out(self, imported: Imported) -> None:
        """Leave them out, those that met nothing too, unless there are no others."""
        touches = imported.touches
        missed = [n for n in self.begun if n < len(touches) and touches[n].coordinate is None]
        finding = {*self.found, *missed} if self.found else set()
        kept = [touch for number, touch in enumerate(touches) if number not in finding]
        if finding and any(touch.coordinate is not None for touch in kept):
            imported.touches = kept
            imported.known.append(
                f"{len(finding)} touches by which programs of 'design' find a surface, which are "
                "left out: they begin where the probe was set by hand"
            )
