"""The speed that status lines of grbl tell, ``<Run|…|FS:50,0|Ov:50,100,100>``, and the override.

grbl, FluidNC and grblHAL leave the feed override out of probing moves unless they are built or set
otherwise ($65 of grblHAL). So a feed is taken with the override only where the speed shows it.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

from skiplatch.importing.model import Touch
from skiplatch.importing.probe_move import AXES
from skiplatch.numbers import NUMBER
from skiplatch.tables import counted

_STATUS = re.compile(r"<[A-Z]\w*(?::\d+)?\|[^>]*")
_SPEED = re.compile(rf"\|FS?:({NUMBER})")
_OVERRIDE = re.compile(r"\|Ov:([0-9]+)(?!\w)")
_HALF_A_DIGIT_MM = 0.51  # mm/min are printed without decimals, inches with one
_HALF_A_DIGIT_INCH = 0.051
_MAX_RATE = 110  # and the numbers after it, an axis each


class Speeds:
    """Follows status lines, and counts the touches that an override may have changed."""

    def __init__(self) -> None:
        self._override = 1.0
        self._seen: list[float] = []
        self._changed = 0
        self._as_programmed = 0

    def restarted(self) -> None:
        """Take back the override, as a controller does that starts anew."""
        self._override = 1.0

    def take(self, text: str, *, is_probing: bool) -> None:
        """Take in a line, if it is of a status."""
        if not (status := _STATUS.search(text)):
            return
        if override := _OVERRIDE.search(status[0]):
            self._override = int(override[1]) / 100.0
        if is_probing and (speed := _SPEED.search(status[0])):
            self._seen.append(float(speed[1]))

    def feed(self, programmed: float | None, unit_mm: float) -> float | None:
        """Give the feed of the move that ends here in mm/min; the unit is that of the replies."""
        seen, self._seen = [speed * unit_mm for speed in self._seen], []
        if programmed is None or self._override == 1.0:
            return programmed
        half_a_digit = _HALF_A_DIGIT_MM if unit_mm == 1.0 else _HALF_A_DIGIT_INCH * unit_mm

        def shows(feed: float) -> bool:
            return any(abs(speed - feed) <= half_a_digit for speed in seen)

        changed = programmed * self._override
        if shows(programmed):
            return programmed
        if shows(changed):
            self._changed += 1
            return changed
        self._as_programmed += 1
        return programmed

    def known(self) -> Iterator[str]:
        """Say which feeds the status lines show."""
        if self._changed:
            yield f"feeds with the override (Ov:), as the speed shows (FS:): {self._changed}"

    def assumed(self) -> Iterator[str]:
        """Say which feeds are taken as programmed in spite of an override."""
        if self._as_programmed:
            yield (
                f"feeds as programmed in spite of an override (Ov:): {self._as_programmed}; grbl "
                "leaves it out while probing, unless built or set otherwise"
            )


def limit(touches: Iterable[Touch], settings: Mapping[int, float]) -> list[str]:
    """Give touches no larger feed than their axis has, and say how many had one."""
    limited: Counter[str] = Counter()
    for touch in touches:
        number = _MAX_RATE + AXES.index(touch.axis)
        fastest = settings.get(number, 0.0)
        if touch.feed is not None and 0.0 < fastest < touch.feed:
            touch.feed = fastest
            limited[f"${number} is {fastest:g} mm/min"] += 1
    return [f"{counted(n, 'touch')} slower than asked for, as {why}" for why, n in limited.items()]
