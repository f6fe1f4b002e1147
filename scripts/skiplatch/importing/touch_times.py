"""When the moves of a log began: a log tells of a touch once it is over."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf
from statistics import median

from skiplatch.importing.model import Touch
from skiplatch.units import S_PER_MIN


def begun_before(touches: Sequence[Touch]) -> Iterator[str]:
    """Set times back from the end of each move to its beginning, and say so.

    A move takes as long as its way does at its feed, and begins no sooner than the one before it
    ended. Where way or feed is not known, its end stands for its beginning.
    """
    ends = spread_times([touch.time_s for touch in touches])
    before = -inf
    is_set_back = False
    for touch, end in zip(touches, ends, strict=True):
        touch.time_s = end
        if end is not None:
            touch.time_s = min(max(end - _takes_s(touch), before), end)
            is_set_back = is_set_back or touch.time_s < end
            before = end
    if is_set_back:
        yield "a move began as long before its touch was told as its way takes at its feed"


def _takes_s(touch: Touch) -> float:
    """Give how long a move took, or 0 where that is not known."""
    if touch.start is None or touch.coordinate is None or not touch.feed:
        return 0.0
    return abs(touch.coordinate - touch.start) / (touch.feed * (touch.share or 1.0)) * S_PER_MIN


def spread_times(times: list[float | None]) -> list[float | None]:
    """Spread times that stand there more than once evenly up to the next one.

    Where that is farther than between others, there was a pause before it.
    """
    found = list(times)
    steps = [b - a for a, b in pairwise(t for t in times if t is not None) if b > a]
    usual = median(steps) if steps else 1.0
    start = 0
    while start < len(times):
        end = start
        while end < len(times) and times[end] == times[start]:
            end += 1
        first = times[start]
        if first is not None and end - start > 1:
            following = times[end] if end < len(times) else None
            pause = following - first if following is not None else 0.0
            span = min(pause, usual) if pause > 0.0 else usual
            for i in range(start, end):
                found[i] = first + span * (i - start) / (end - start)
        start = end
    return found
