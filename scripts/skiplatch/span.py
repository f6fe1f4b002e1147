"""The touches at which an effect acts: all of them, or those since one, or until one."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray


@dataclass(frozen=True, slots=True)
class Span:
    """A stretch of a campaign, by the numbers of its touches.

    Attributes:
        since: The first touch of it; None for the first of all.
        until: The last touch of it; None for the last of all.
    """

    since: int | None = None
    until: int | None = None

    def holds(self, touch: NDArray[np.integer]) -> BoolArray:
        """Tell for touches, by their numbers of shape (n,), whether they are in it."""
        is_in = np.full(len(touch), fill_value=True)
        if self.since is not None:
            is_in &= touch >= self.since
        if self.until is not None:
            is_in &= touch <= self.until
        return is_in

    @property
    def ends(self) -> int:
        """Number of its ends within the campaign."""
        return (self.since is not None) + (self.until is not None)


def parted(spans: Iterable[Span], touch: NDArray[np.integer], rows: BoolArray) -> list[BoolArray]:
    """Take rows, a mask of shape (n,), apart by the spans that hold their touches' numbers."""
    parts = [rows]
    for span in spans:
        acts = span.holds(touch)
        parts = [half for part in parts for half in (part & acts, part & ~acts)]
    return parts


ALWAYS = Span()
