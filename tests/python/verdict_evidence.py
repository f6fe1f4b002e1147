"""Made-up evidence for the rules of a verdict."""

from collections.abc import Mapping
from dataclasses import replace

from skiplatch.diagnosis.plays.left import EVERYWHERE, Left
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.statistics import Interval


def left(z: float, *conditions: str, relative: float = 1.0) -> Left:
    """Something left of a position, where plays scatter by 1 µm."""
    names = conditions or (EVERYWHERE,)
    return Left("position", "skip", "shift", names, relative, "µm", relative, 1.0, 0.1, z)


def gap(low: float, high: float = 1.0, *, is_clear: bool = True, tightness: float = 1.0) -> Gap:
    """A gap that shrinks by so much."""
    share = Interval((low + high) / 2.0, low, high)
    after = 5.0 - 4.0 * share.value
    return Gap("position", "µm", 5.0, after, 0.9, share, is_clear=is_clear, tightness=tightness)


GROWING = replace(gap(-1.0, -0.5), grows=True)


def gaps(*several: Gap) -> Mapping[str, Gap]:
    return {f"observable_{i}": one for i, one in enumerate(several)}


def missing(z: float) -> Left:
    """A fifth of the touches was missed."""
    return Left("missed", "plc", "share", (EVERYWHERE,), 0.2, "1", 0.2, 0.0, 0.0, z)
