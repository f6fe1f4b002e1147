"""Latch errors of one input path: how much later the latch is than the edge, and how far off."""

import math
from dataclasses import dataclass

from skiplatch.latch.distribution import Bins, Distribution, Summary
from skiplatch.latch.effort import Effort
from skiplatch.latch.probing import Probing, chunks
from skiplatch.latch.reaction import reaction_of
from skiplatch.progress import shown

FINE_BINS = 32_768
NANOSECOND_US = 1e-3  # to which the simulation rounds times


@dataclass(frozen=True, slots=True)
class LatchErrors:
    """The two distributions of a path, and the standard uncertainty that a formula gives."""

    latency_us: Summary
    """Time stamp minus true edge."""
    position_um: Summary
    """Latched minus true position."""
    formula_us: float
    """T/√12 of the reaction width T."""
    formula_um: float
    """v·T/√12, at the feed v."""


def latch_errors(probing: Probing, effort: Effort) -> LatchErrors:
    """Play so many touches and collect how far off they latch."""
    latency = Distribution(_latency_bins(probing))
    position = Distribution(_position_bins(probing))
    title = f"{probing.path.name.lower()} touches"
    for outcomes in shown(probing.latched(effort), chunks(effort), title):
        latency.add((outcomes.latch_us - outcomes.true_edge_us)[0])
        position.add(outcomes.deviation_um[0])
    formula_us = reaction_of(probing.nominal, probing.path).width_us / math.sqrt(12.0)
    return LatchErrors(
        latency_us=latency.summary(),
        position_um=position.summary(),
        formula_us=formula_us,
        formula_um=probing.feed_um_us * formula_us,
    )


def _latency_bins(probing: Probing) -> Bins:
    """A time stamp is rounded down to a tick, so that it may even be early."""
    reaction = reaction_of(probing.nominal, probing.path)
    early_us = reaction.earliest_us - probing.nominal.skip.tick_us
    return _bins(early_us, reaction.latest_us, NANOSECOND_US, (early_us, reaction.latest_us))


def _position_bins(probing: Probing) -> Bins:
    """A position is rounded to the nearest count of the axis."""
    reaction = reaction_of(probing.nominal, probing.path)
    low_um = probing.feed_um_us * reaction.earliest_us
    high_um = probing.feed_um_us * reaction.latest_us
    count_um = probing.nominal.axis.resolution_um
    limits = (low_um - count_um / 2.0, high_um + count_um / 2.0)
    return _bins(low_um, high_um, count_um, limits)


def _bins(low: float, high: float, step: float, limits: tuple[float, float]) -> Bins:
    """Cover multiples of a step, of which every bin holds as many, and none at its edges."""
    first, last = math.floor(low / step) - 1, math.ceil(high / step) + 1
    size = math.ceil((last - first + 1) / FINE_BINS)
    count = math.ceil((last - first + 1) / size)
    return Bins((first - 0.5) * step, size * step, count, limits)
