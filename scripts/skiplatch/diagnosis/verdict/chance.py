"""Whether what a finding leaves to chance is chance.

Which touches bounced, how late a scan began, where a value lies between two lines: no condition
tells it, and no touch before, for the physics of the effect knows none of them. Where something
does, the effect stands for something else. It shows at the feeds at which the effect adds scatter.
What a finding shifts touches by has never just the form of the real shift: what is no more than the
discrepancy that its fit asks for is no chance.
"""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.leftover import Beside
from skiplatch.diagnosis.plays.look import Look
from skiplatch.diagnosis.plays.telling import FEWEST
from skiplatch.diagnosis.search.scorer import MORE_VARIANCE
from skiplatch.side_by_side import side_by_side

SMALLEST = 1e-9


def chance_of(
    found: Beside, believed: Beside, discrepancy: float, executor: Executor | None = None
) -> list[Left]:
    """Look for what tells how the chance of a finding fell; all of it, the most significant first.

    Args:
        found: The touches beside plays of the rig with the effects.
        believed: The same without them.
        discrepancy: By how much of what they shift the effects are off in their form.
        executor: Looks from several sides at a time.
    """
    chancy = [each for each in _chancy_touches(found, believed) if each[-1].sum() >= FEWEST]
    looks = [found.look(*each) for each in chancy]
    least = [discrepancy * _shift(found, believed, name, rows) for name, _, rows in chancy]
    told = side_by_side(executor, Look.told_of_chance, looks)
    larger = (
        # A finding may hide in rounding; what tells its chance there counts as the finding does.
        replace(left, step=0.0)
        for lefts, size in zip(told, least, strict=True)
        for left in lefts
        if left.size > size
    )
    return sorted(larger, key=lambda left: -left.z)


def is_chancy(found: Beside, believed: Beside) -> bool:
    """Tell whether a finding leaves any observable of some touches more to chance."""
    return any(rows.any() for _, _, rows in _chancy_touches(found, believed))


def _chancy_touches(beside: Beside, before: Beside) -> Iterator[tuple[str, str, BoolArray]]:
    """Give the touches, shape (n,), that a finding leaves to chance; by observable and path."""
    for path, here in beside.paths.items():
        for name in beside.recorded:
            rows = here & beside.known(name) & before.known(name)
            if rows.any():
                yield name, path, rows & _adds_scatter(beside, before, name, rows)


def _shift(beside: Beside, before: Beside, name: str, rows: BoolArray) -> float:
    """Give the root mean square of what a finding shifts the middle of touches by.

    Off its grid a stamp lies by what it is shifted by, less whole periods.
    """
    name = "latch" if name == "grid" else name
    now, was = (np.nanmedian(plays.played[name][:, rows], axis=0) for plays in (beside, before))
    return float(np.sqrt(np.mean((now - was) ** 2)))


def _adds_scatter(beside: Beside, before: Beside, name: str, rows: BoolArray) -> BoolArray:
    """Tell which touches a finding leaves more to chance: at feeds where variance grows; (n,).

    Touches that a finding moves apart are each rounded in their own way, and in the middle of a
    step they showed less noise than there is: as much as rounding may make each of the two.
    """
    rounding = beside.setting.step(name) ** 2 / 12.0
    feeds = beside.setting.scene.touches.feed_mm_min
    adds = np.zeros(len(rows), dtype=np.bool_)
    for feed in np.unique(feeds[rows]):
        there = rows & (feeds == feed)
        now, was = (_variance(plays.played[name][:, there]) for plays in (beside, before))
        adds |= there & (now - 2.0 * rounding > MORE_VARIANCE * max(was, rounding))
    return adds


def _variance(played: FloatArray) -> float:
    """Give the mean variance of touches, shape (r, m)."""
    return max(float(np.nanmean(np.nanvar(played, axis=0))), SMALLEST)
