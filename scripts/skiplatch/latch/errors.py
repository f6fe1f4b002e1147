"""Latch errors of one input path: how much later the latch is than the edge, and how far off."""

import math
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.latch.distribution import Bins, Chunk, Distribution, Scale, Summary
from skiplatch.latch.effort import Effort
from skiplatch.latch.probing import CHUNK_TOUCHES, Probing, all_latched, chunks
from skiplatch.latch.reaction import reaction_of
from skiplatch.progress import shown
from skiplatch.simulator.playing import Outcomes
from skiplatch.workers import NOT_KEPT, Keeper, in_order

FINE_BINS = 32_768
NANOSECOND_US = 1e-3  # to which the simulation rounds times
FINEST_UM = 1e-3  # of a position, which comes from a surface anywhere between two counts


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


def latch_errors(
    probing: Probing,
    effort: Effort,
    executor: Executor | None = None,
    keeper: Keeper = NOT_KEPT,
) -> LatchErrors:
    """Play so many touches and collect how far off they latch.

    Args:
        probing: How is probed.
        effort: How many touches.
        executor: Workers that play the chunks; else they are played here. The result is the same.
        keeper: Keeps the chunks that workers have played.
    """
    latency = Distribution(_latency_bins(probing))
    position = Distribution(_position_bins(probing))
    title = f"{probing.path.name.lower()} touches"
    if executor is None:
        for outcomes in shown(probing.latched(effort), chunks(effort), title):
            latency.add(_latency_us(outcomes))
            position.add(outcomes.deviation_um[0])
    else:
        outcomes = all_latched(probing.chunk(effort, 0))
        latency.add(_latency_us(outcomes))
        position.add(outcomes.deviation_um[0])
        alone = replace(effort, jobs=1)
        firsts = range(CHUNK_TOUCHES, effort.touches, CHUNK_TOUCHES)
        tasks = [(probing, alone, first, latency.scale, position.scale) for first in firsts]
        names = [f"{title} {first + 1} and after" for first in firsts]
        coming = in_order(executor, _played, tasks, names, keeper)
        for chunk in shown(coming, len(tasks), title):
            latency.join(chunk[0])
            position.join(chunk[1])
    formula_us = reaction_of(probing.nominal, probing.path).width_us / math.sqrt(12.0)
    return LatchErrors(
        latency_us=latency.summary(),
        position_um=position.summary(),
        formula_us=formula_us,
        formula_um=probing.feed_um_us * formula_us,
    )


def _played(
    probing: Probing, effort: Effort, first: int, latency: Scale, position: Scale
) -> tuple[Chunk, Chunk]:
    """Play a chunk and sum it up: what a worker does."""
    outcomes = all_latched(probing.chunk(effort, first))
    return latency.chunk(_latency_us(outcomes)), position.chunk(outcomes.deviation_um[0])


def _latency_us(outcomes: Outcomes) -> FloatArray:
    return np.asarray((outcomes.latch_us - outcomes.true_edge_us)[0])


def _latency_bins(probing: Probing) -> Bins:
    """A time stamp is rounded down to a tick, so that it may even be early."""
    reaction = reaction_of(probing.nominal, probing.path)
    early_us = reaction.earliest_us - probing.nominal.skip.tick_us
    return _bins(early_us, reaction.latest_us, NANOSECOND_US, (early_us, reaction.latest_us))


def _position_bins(probing: Probing) -> Bins:
    """A position is rounded to the nearest count of the axis."""
    reaction = reaction_of(probing.nominal, probing.path)
    count_um = probing.nominal.axis.resolution_um
    low_um = probing.feed_um_us * reaction.earliest_us - count_um / 2.0
    high_um = probing.feed_um_us * reaction.latest_us + count_um / 2.0
    return _bins(low_um, high_um, min(FINEST_UM, count_um), (low_um, high_um))


def _bins(low: float, high: float, step: float, limits: tuple[float, float]) -> Bins:
    """Cover multiples of a step, of which every bin holds as many, and none at its edges."""
    first, last = math.floor(low / step) - 1, math.ceil(high / step) + 1
    size = math.ceil((last - first + 1) / FINE_BINS)
    count = math.ceil((last - first + 1) / size)
    return Bins((first - 0.5) * step, size * step, count, limits)
