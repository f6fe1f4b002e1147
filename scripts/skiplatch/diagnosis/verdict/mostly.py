"""What a finding leaves that is much of what was there: it is not its cause, then."""

from skiplatch.diagnosis.plays.left import CHANCE, Left
from skiplatch.diagnosis.plays.leftover import streams_of
from skiplatch.diagnosis.verdict.evidence import Evidence

UNTOUCHED = 0.02
"""Share by which what is left may change by chance where a finding does nothing."""
MOST = 0.5
"""Share of the variance of a gap from which on what is left is most of it."""
PART_OF_ALL = 0.1
"""Share of the variance of an observable's gap that what is left of one kind has to be to count:
no real effect has just the form that is fitted, and what its form leaves may be of another kind."""


def mostly_left(evidence: Evidence, threshold: float = MOST) -> list[Left]:
    """Give what a finding leaves that is much of what was there: it is not its cause, then."""
    reached = (one for one in evidence.after if not streams_of(one) <= evidence.unreached)
    return [one for one in reached if one.z > CHANCE and _is_most(evidence, one, threshold)]


def _is_most(evidence: Evidence, left: Left, threshold: float) -> bool:
    """Tell whether what is left is much of what was there of its like, and something of it all.

    Like is held against like in its own unit, the most against the most: a larger scatter makes no
    wave small. What shows only once more than it is gone is held against that, in terms of noise.
    """
    there = [one for one in evidence.before if one.is_of(left)]
    like = [one.size for one in there if one.is_like(left)]
    most = max(one.size for one in evidence.after if one.is_of(left) and one.is_like(left))
    now, whole = (
        (most, max(one.size for one in there))
        if like
        else (left.relative, max((one.relative for one in there), default=0.0))
    )
    was = max(like, default=whole)
    is_touched = abs(now - was) > UNTOUCHED * was
    return is_touched and now**2 > max(threshold * was**2, PART_OF_ALL * whole**2)
