"""What Klipper says of a touch, and which touches a log lacks or cuts off."""

import re
from collections.abc import Sequence

from skiplatch.importing.console import decimals
from skiplatch.importing.log_lines import Line
from skiplatch.importing.model import Imported
from skiplatch.importing.named_lines import NAMED
from skiplatch.numbers import NUMBER

PROBE = re.compile(
    rf"probe(?:: at| at) ({NUMBER}),\s*({NUMBER})(?:,\s*({NUMBER}))? "
    rf"(?:is|bed will contact at) z=({NUMBER})",
    re.IGNORECASE,
)
_CUT = re.compile(
    rf"probe(?:: at| at)(?: (?:{NUMBER}(?:,\s*(?:{NUMBER},?\s*)?)?(?:i|is|is z=?[-+]?)?)?)?$",
    re.IGNORECASE,
)
"""A touch as far as its z at most."""


def without_torn_end(lines: Sequence[Line]) -> Sequence[Line]:
    """Leave out the last line if it is a touch that was cut off, in its z or before it.

    All z have the same number of decimals, so the last one with fewer is a stump.
    """
    if not lines:
        return lines
    *before, last = lines
    if _CUT.search(last.text):
        return before
    if not (touch := PROBE.search(last.text)):
        return lines
    others = {decimals(match[4]) for line in before if (match := PROBE.search(line.text))}
    return before if others and decimals(touch[4]) < min(others) else lines


class Lacking:
    """Counts the touches of each PROBE_ACCURACY.

    Attributes:
        sampled: Touches of the one that runs.
    """

    def __init__(self) -> None:
        self.sampled = 0
        self._lacking: list[str] = []

    def begins(self) -> None:
        """Begin another one."""
        self.sampled = 0

    def ends(self, samples: float | None, where: str) -> None:
        """Note how many touches there are too few, if it says how many it makes."""
        if samples and self.sampled < samples:
            self._lacking.append(f"{samples - self.sampled:.0f} of {samples:.0f}, {where}")

    def say(self, found: Imported) -> None:
        """Say where touches are missing."""
        if self._lacking:
            more = len(self._lacking) - NAMED
            besides = f"; and {more} more" if more > 0 else ""
            parts = "; ".join(self._lacking[:NAMED])
            found.unread.append(f"touches of PROBE_ACCURACY that are missing: {parts}{besides}")
