"""What happens to few touches: more of them beyond all their plays than chance has there.

Middle and spread of the ranks hardly tell of it, for a touch in twenty moves neither; how many lie
at the very end of a law does (Donoho and Jin, Annals of Statistics 32 (2004) 962).
"""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.plays.leftover import NOTICED, Beside, streams_at
from skiplatch.diagnosis.plays.look import SELDOM, Look
from skiplatch.diagnosis.scene.observed import UNITS
from skiplatch.statistics import errors_of_excess


def rarely_off(beside: Beside, materiality: Materiality) -> frozenset[str]:
    """Name the streams in which few touches may be off by what matters.

    That is worth a search, and no gap by itself: accidents are as rare.
    """
    found: set[str] = set()
    for look in chain.from_iterable(beside.looks.values()):
        for off, z in _beyond(look):
            size, relative = (float(np.sqrt(np.mean(v**2))) for v in (off, off / look.scale))
            if z > NOTICED and materiality.is_exceeded(size, relative, UNITS[look.name]):
                found |= streams_at(look.name, look.path)
    return frozenset(found)


def _beyond(look: Look) -> Iterator[tuple[FloatArray, float]]:
    """Count touches above all plays, and below them.

    Yields:
        By how much each is beyond, shape (m,), 0 of one within; and how many standard errors the
        count of them, or of those far off, is above what the plays have among each other.
    """
    n, chance = len(look.recorded), 1.0 / (len(look.played) + 1)
    is_far = look.far
    for sense in (1.0, -1.0):
        ends = np.where(np.isnan(look.played), -np.inf, sense * look.played)
        second, most = np.sort(ends, axis=0)[-2:]
        beyond = np.maximum(sense * look.recorded - most, 0.0)
        counts = ((ends == most) & (most > second)).sum(axis=1)
        # What all touches of a play share, as the phase of the scans, takes them there together.
        spread = max(float(counts.var(ddof=1)) / (n * chance * (1.0 - chance)), 1.0)
        z = errors_of_excess(int(np.count_nonzero(beyond)), n, chance) / np.sqrt(spread)
        far = int(np.sum(is_far & (beyond > 0.0)))
        yield beyond, max(z, errors_of_excess(far, n, SELDOM))
