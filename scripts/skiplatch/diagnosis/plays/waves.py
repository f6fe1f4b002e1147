"""Waves in values of touches along a line: in position, in time, or in the sequence."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.plays.setting import Place
from skiplatch.diagnosis.plays.telling import FEWEST, SMALLEST
from skiplatch.diagnosis.scene.periodogram import explained_by_sines
from skiplatch.statistics import errors_of

LEAST_TURNS = 1.0
"""Of a wave over what was recorded; slower ones a forest sees."""
MOST_WAVES = 250_000
"""Over what was recorded, that are looked for; more take too long."""
FEWEST_FOR_FAST = 60
"""Touches that tell one of so many: the chance of the best of them is that of normal values, whose
tail few values do not have."""


@dataclass(frozen=True, slots=True)
class Wave:
    """The wave along a line that explains most.

    Attributes:
        words: What it goes with, for reports.
        share: Of the variance that it explains.
        z: Standard errors, all waves that were tried counted.
    """

    words: tuple[str, ...]
    share: float
    z: float


def waves_along(
    places: Sequence[Place], rows: BoolArray, values: FloatArray, *, is_fast: bool = False
) -> Iterator[Wave]:
    """Find the best wave along each of some lines.

    Args:
        places: The lines, with all n touches on them.
        rows: Which touches have values; shape (n,).
        values: Shape (m,).
        is_fast: Look also for waves of which many lie between two touches.
    """
    for place in places:
        along, sense = place.where[rows], place.sense[rows]
        found = best_wave(along, values * sense, place.shortest, is_fast=is_fast)
        if found is not None:
            period, share, z = found
            words = f"{place.name}, in waves of {period:.3g} {place.unit}".rstrip()
            yield Wave((words,), share, z)


def best_wave(
    place: FloatArray, scores: FloatArray, shortest: float, *, is_fast: bool = False
) -> tuple[float, float, float] | None:
    """Find the wave that explains most of scores, shape (m,): period, share, standard errors.

    The chance of the best of many frequencies is that of Baluev, Monthly Notices of the Royal
    Astronomical Society 385 (2008) 1279, table 1.

    Args:
        place: Where each lies; shape (m,).
        scores: Shape (m,).
        shortest: Wave that the places tell; 0 for any.
        is_fast: Places that lie anywhere tell also waves of which many lie between two of them
            (VanderPlas, Astrophysical Journal Supplement 236 (2018) 16, section 4).
    """
    known = ~np.isnan(place)
    place, scores, n = place[known], scores[known], int(known.sum())
    span = float(np.ptp(place)) if n else 0.0
    if n < (FEWEST_FOR_FAST if is_fast else FEWEST) or span <= 0.0 or np.ptp(scores) == 0.0:
        return None
    most = MOST_WAVES if is_fast else 0.5 * n
    fastest = min(most / span, 1.0 / shortest if shortest else np.inf)
    if fastest * span < LEAST_TURNS + 1.0:
        return None
    frequencies, shares = explained_by_sines(
        place, scores, np.ones(n), LEAST_TURNS, fastest, is_coarse=is_fast
    )
    best = int(np.argmax(shares))
    share = min(float(shares[best]), 1.0 - SMALLEST)
    tried = max(float(np.sqrt(4.0 * np.pi * np.var(place))) * fastest, 1.0)
    crossings = np.sqrt(0.5 * (n - 1.0) * share)
    chance = tried * crossings * np.exp(0.5 * (n - 4.0) * np.log1p(-share))
    return 1.0 / float(frequencies[best]), share, errors_of(float(chance))
