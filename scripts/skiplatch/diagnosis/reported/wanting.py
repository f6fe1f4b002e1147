"""What a gap that is explained in part lacks, where nothing is seen to be left of it."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.diagnosis.verdict.verdict import Failure
from skiplatch.statistics import Interval
from skiplatch.tables import number

MOST_TOUCHES = 4_000
"""Touches that the search looks at; a larger campaign is drawn from."""
FAILED_FOR_WANT = frozenset({"shrinks", "held_out", "known"})
"""Rules that more touches may let hold."""
SHRINKS = "shrinks"
SURELY = 2.0
"""Times what would do on average, so that it mostly does: it did for 20 of 24 simulated campaigns
of 120 touches, and half of it for 17 of 29."""
DIGITS = 2
"""Of an estimated number of touches."""


@dataclass(frozen=True, slots=True)
class Wanting:
    """What keeps a gap from being explained.

    Attributes:
        level: Share of it that has to be gone for certain.
        shares: Gone of what is clear and too small for certain; a gap may be clear nowhere.
        touches: That the search looked at.
    """

    level: float
    shares: tuple[Interval, ...]
    touches: int

    @property
    def is_short(self) -> bool:
        """For certain less goes than has to: no further touches would change that."""
        return any(share.high < self.level for share in self.shares)

    @property
    def is_likely(self) -> bool:
        """As far as these touches tell, enough of it goes."""
        return all(share.value >= self.level for share in self.shares)

    @property
    def enough(self) -> int | None:
        """Touches of the same kind that would do; None if that cannot be told.

        An interval narrows with the root of their number.
        """
        if not self.shares or any(share.value <= self.level for share in self.shares):
            return None
        halves = [(s.value - s.low) / (s.value - self.level) for s in self.shares]
        wanted = SURELY * self.touches * max(halves) ** 2
        return round(wanted) if wanted <= MOST_TOUCHES else None

    @property
    def words(self) -> str:
        """Say it, as the end of a sentence."""
        if self.is_short:
            most = min(share.high for share in self.shares)
            return f"but no more than {max(most, 0.0):.0%} of it goes"
        if self.enough is not None:
            return (
                f"but {self.touches} touches are too few to be sure of all of it; "
                f"about {number(self.enough, DIGITS)} of their kind would do"
            )
        if not self.shares:
            return (
                "but no gap stands out enough to see all of it go; "
                "that takes more touches that show it"
            )
        least, level = min(share.value for share in self.shares), f"{self.level:.0%}"
        if least > self.level:
            return (
                f"but {self.touches} touches are too few to be sure of all of it; "
                f"as many as are looked at, {MOST_TOUCHES}, may not do"
            )
        return f"but these touches show {least:.0%} of it go, and {level} would have to"


def wanting(failures: Collection[Failure], gaps: Iterable[Gap], touches: int) -> Wanting | None:
    """Give what more of the gap would have to go; None if other rules failed than that.

    Args:
        failures: The rules that the finding failed.
        gaps: On touches held out.
        touches: That the search looked at.
    """
    if {failure.rule for failure in failures} != {SHRINKS}:
        return None
    (level,) = (failure.threshold for failure in failures)
    shares = (gap.shrink for gap in gaps if gap.is_clear)
    return Wanting(level, tuple(share for share in shares if share.low < level), touches)
