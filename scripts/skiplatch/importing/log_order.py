"""Whether a log without times shows its newest line first: by commands and what answers them."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from skiplatch.numbers import NUMBER

_BEGINS, _TOUCHES, _ENDS = "begins", "touches", "ends"
_KINDS = {
    _BEGINS: re.compile(
        rf"PROBE[_ ]ACCURACY:? at X:({NUMBER}) Y:({NUMBER})|M48 Z-Probe Repeatability Test"
        r"|\bG38\.[2-5](?!\d)",
        re.IGNORECASE,
    ),
    _TOUCHES: re.compile(
        rf"\bprobe(?:: at| at) ({NUMBER}),\s*({NUMBER})|(?<!\d)\d{{1,6}} of \d{{1,6}}:?\s*z:"
        r"|\[PRB:",
        re.IGNORECASE,
    ),
    _ENDS: re.compile(
        r"^probe accuracy results|^(?:Finished!|Standard Deviation:)|(?:^|<\s*)ok\b", re.IGNORECASE
    ),
}
LEAST = 2
"""How often something has to stand the wrong way round: the first or the last test may be cut."""


@dataclass(frozen=True, slots=True)
class _Mark:
    """A line that tells of a touch, or of what begins or ends touches at a place, if it has one."""

    kind: str
    place: tuple[str | None, ...] = ()


def is_newest_first(texts: Iterable[str]) -> bool:
    """Tell a log that has to be read from below.

    Touches stand between what begins them, at their place, and what ends them. Those that have the
    same on both sides tell nothing.

    Args:
        texts: The lines, without what stands before them.
    """
    marks = [mark for mark, _ in groupby(filter(None, map(_mark, texts)))]
    begun = any(mark.kind == _BEGINS for mark in marks)
    balance = [_turned(three, begun=begun) for three in _around(marks)]
    turned = sum(count for count in balance if count > 0)
    return turned >= LEAST and sum(balance) > 0


NOTHING = _Mark("")


def _mark(text: str) -> _Mark | None:
    """Give what a line is; one that is several, as a command with its answer, is nothing."""
    found = [(kind, match) for kind, sign in _KINDS.items() if (match := sign.search(text))]
    if len(found) != 1:
        return None
    ((kind, match),) = found
    return _Mark(kind, tuple(place for place in match.groups() if place))


def _around(marks: Sequence[_Mark]) -> Iterable[tuple[_Mark, _Mark, _Mark]]:
    """Give each stretch of touches at a place with what stands before and behind it."""
    padded = [NOTHING, *marks, NOTHING]
    threes = zip(padded, padded[1:], padded[2:], strict=False)
    return (three for three in threes if three[1].kind == _TOUCHES)


def _turned(three: tuple[_Mark, _Mark, _Mark], *, begun: bool) -> int:
    """Count what stands the wrong way round, less what stands the right way round."""
    before, touches, after = three
    begins = [mark.kind == _BEGINS and mark.place == touches.place for mark in (before, after)]
    ends = [mark.kind == _ENDS for mark in (before, after)]
    if begun and True not in begins:
        return 0  # a mesh of the bed, after the results of a test
    return (begins[1] - begins[0]) + (ends[0] - ends[1])
