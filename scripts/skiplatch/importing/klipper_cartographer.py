"""What Cartographer's plugin of Klipper prints of its touches by the nozzle.

Each is a line ``Touch 2: 0.0123``, in klippy.log with ``[cartographer]`` before it. The
``TOUCH_ACCURACY`` of it makes several of them for each reading, and lists the readings at its end.
"""

import re

from skiplatch.importing.model import Imported
from skiplatch.numbers import NUMBER

PREFIX = "[cartographer] "
_TOUCH = re.compile(rf"^Touch \d+(?: of \d+)?: ({NUMBER})$")
_LIST = re.compile(r"^Measurements gathered: (.*)$")
_READING = re.compile(rf"(?<![\w.]){NUMBER}")
_TEST = re.compile(r"^(\w+)[_ ]accuracy:? at X:", re.IGNORECASE)


class Cartographer:
    """Tells which lines hold touches.

    Attributes:
        shows_touches: Whether the log has those of the test that runs, and not its readings alone.
    """

    def __init__(self) -> None:
        self.shows_touches = False
        self._is_touching = True
        self._listed = 0

    def begins(self, text: str) -> bool:
        """Take the head of a test, and tell whether it touches rather than reads from above."""
        test = _TEST.match(text)
        if test:
            self._is_touching = test[1].lower() == "touch"
            self.shows_touches = False
        return bool(test) and self._is_touching

    def touches(self, text: str) -> list[float]:
        """Give the Z of a touch, or the readings of a list where no touches behind them show."""
        if match := _TOUCH.match(text):
            self.shows_touches = True
            return [float(match[1])]
        match = _LIST.match(text)
        if not match or self.shows_touches or not self._is_touching:
            return []
        readings = [float(z) for z in _READING.findall(match[1])]
        self._listed += len(readings)
        return readings

    def say(self, found: Imported) -> None:
        """Say what the readings are."""
        if self._listed:
            found.assumed.append(
                f"{self._listed} readings of TOUCH_ACCURACY are taken for touches: each is the "
                'middle one of several, which scatter more; klippy.log has them as "Touch 1: …"'
            )
