"""RepRapFirmware, of Duet boards: `G30 S-1` touches where the probe stands, and prints the height.

The console tells neither place nor feed. Moves and `M558` before it do, where they were logged.
"""

import re

from skiplatch.importing.console import ADJUSTING
from skiplatch.numbers import NUMBER, PLAIN

STOPPED = rf"\bStopped at height ({NUMBER}) ?mm\b"
HOMING = re.compile(r"^(?:G28\b|G30\b(?!.*[SP])|M999\b)", re.IGNORECASE)
"""`G30` alone makes the height at the trigger that of the machine."""
LEVELLING = {ADJUSTING: re.compile(r"^G32\b", re.IGNORECASE)}

_STOPPED = re.compile(STOPPED)
_FAILED = re.compile(r"probe was not triggered during probing move", re.IGNORECASE)
_FALSE = re.compile(r"probe already triggered (?:at|before)", re.IGNORECASE)
_SPEED = re.compile(rf"\bM558\b.*?\bF\s*({PLAIN})(?::({PLAIN}))?", re.IGNORECASE)
_TAPS = re.compile(r"\bM558\b.*?\bA\s*(\d{1,3})(?!\d)", re.IGNORECASE)
_TOLD = re.compile(rf"\bprobe speeds? (?:{PLAIN},)?({PLAIN}) ?mm/min", re.IGNORECASE)
_MOVE = re.compile(r"^G(?:0|1|30)\b", re.IGNORECASE)
_X, _Y = (re.compile(rf"{axis}\s*(-?{PLAIN})", re.IGNORECASE) for axis in "XY")


class Duet:
    """Follows a console line by line.

    Attributes:
        feed: Of the touches that follow, in mm/min; None where no line told it.
        has_touched: Whether a touch was told.
        taps: How often the firmware may touch for one height.
    """

    def __init__(self) -> None:
        self.feed: float | None = None
        self.has_touched = False
        self.taps = 1
        self._at: dict[str, float] = {}

    @property
    def place(self) -> tuple[float, ...]:
        """Where the head stands in X and Y, as far as moves told it."""
        return tuple(self._at[axis] for axis in sorted(self._at))

    def take(self, text: str) -> None:
        """Take a move, or what is said of the speed: of two, touches are made at the second."""
        if match := _TOLD.search(text):
            self.feed = float(match[1])
        elif match := _SPEED.search(text):
            self.feed = float(match[2] or match[1])
        if match := _TAPS.search(text):
            self.taps = int(match[1])
        if _MOVE.match(text):
            for axis, word in (("X", _X), ("Y", _Y)):
                if match := word.search(text):
                    self._at[axis] = float(match[1])

    def height(self, text: str) -> float | None:
        """Give the height of a touch in mm."""
        match = _STOPPED.search(text)
        self.has_touched |= match is not None
        return float(match[1]) if match else None


def fails(text: str) -> bool:
    """Tell an attempt that met nothing."""
    return bool(_FAILED.search(text))


def is_false(text: str) -> bool:
    """Tell an attempt that found the probe triggered."""
    return bool(_FALSE.search(text))
