"""What happens to few touches: more of them beyond all their plays than chance has there.

Middle and spread of the ranks hardly tell of it, for a touch in twenty moves neither; how many lie
at the very end of a law does (Donoho and Jin, Annals of Statistics 32 (2004) 962).
"""

from collections.abc import Iterator

import numpy as np
from scipy import stats

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.plays.leftover import NOTICED, Beside, streams_at
from skiplatch.diagnosis.plays.look import DIGITS, FEWEST, SELDOM, far_off
from skiplatch.diagnosis.scene.observed import UNITS
from skiplatch.statistics import errors_of


def rarely_off(beside: Beside, materiality: Materiality) -> frozenset[str]:
    """Name the streams in which few touches may be off by what matters.

    That is worth a search, and no gap by itself: accidents are as rare.
    """
    found: set[str] = set()
    for path, here in beside.paths.items():
        for name in beside.recorded:
            seen = here & beside.known(name)
            if seen.sum() < FEWEST:
                continue
            recorded = np.round(beside.recorded[name][seen], DIGITS)
            played = np.round(beside.played[name][:, seen], DIGITS)
            look = beside.look(name, path, seen)
            least = materiality.absolute(UNITS[name])
            for off, z in _beyond(recorded, played, look.step):
                size = np.sqrt(np.mean((off / look.scale if least is None else off) ** 2))
                if z > NOTICED and size > (materiality.fraction if least is None else least):
                    found |= streams_at(name, path)
    return frozenset(found)


def _beyond(
    recorded: FloatArray, played: FloatArray, step: float
) -> Iterator[tuple[FloatArray, float]]:
    """Count touches above all plays, and below them.

    Yields:
        By how much each is beyond, shape (m,), 0 of one within; and how many standard errors the
        count of them, or of those far off, is above what the plays have among each other.
    """
    middle = np.nanmedian(played, axis=0)
    reach = float(np.nanmax(np.abs(played - middle)))
    is_far = far_off(recorded - middle, reach, step)
    n, chance = len(recorded), 1.0 / (len(played) + 1)
    for sense in (1.0, -1.0):
        ends = np.where(np.isnan(played), -np.inf, sense * played)
        second, most = np.sort(ends, axis=0)[-2:]
        beyond = np.maximum(sense * recorded - most, 0.0)
        counts = ((ends == most) & (most > second)).sum(axis=1)
        # What all touches of a play share, as the phase of the scans, takes them there together.
        spread = max(float(counts.var(ddof=1)) / (n * chance * (1.0 - chance)), 1.0)
        z = _errors(int(np.count_nonzero(beyond)), n, chance) / np.sqrt(spread)
        yield beyond, max(z, _errors(int(np.sum(is_far & (beyond > 0.0))), n, SELDOM))


def _errors(count: int, n: int, chance: float) -> float:
    return errors_of(float(stats.binom.sf(count - 1, n, chance)))
