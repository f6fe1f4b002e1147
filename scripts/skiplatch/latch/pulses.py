"""Short pulses on the trigger line: which are seen, and which glitches trigger."""

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.campaign import Nominal
from skiplatch.latch.effort import Effort
from skiplatch.latch.probing import Probing
from skiplatch.latch.reaction import reaction_of
from skiplatch.statistics import Interval, proportion, rate_bound

NS_PER_US = 1000
SHARES_OF_FILTER = (0.5, 1.0, 1.5)
SHARES_OF_SCAN = (0.01, 0.1, 0.25, 0.5, 0.75, 1.0)


@dataclass(frozen=True, slots=True)
class ShortestSeen:
    """The shortest pulse of which none was missed.

    "Always" means just that: with 95 % confidence no more than `miss_bound` of them are missed.
    """

    pulse_us: float
    pulses: int
    miss_bound: float


@dataclass(frozen=True, slots=True)
class Pulses:
    """What one input path makes of pulses of random phase."""

    pulses: int
    """Of each width."""
    triggering: Mapping[float, Interval]
    """The share that latches, by width in µs."""
    shortest: ShortestSeen


def default_widths_us(nominal: Nominal) -> Sequence[float]:
    """Give pulse widths about the filter time, and from there to the scan period."""
    about_filter = {share * nominal.input.filter_us for share in SHARES_OF_FILTER}
    within_scan = {share * nominal.plc.scan_us for share in SHARES_OF_SCAN}
    return sorted((about_filter | within_scan) - {0.0})


def pulse_response(probing: Probing, widths_us: Sequence[float], effort: Effort) -> Pulses:
    """Play so many pulses of each width, and search for the shortest that is always seen."""

    def seen(pulse_us: float) -> int:
        played = probing.outcomes(effort, pulse_us=pulse_us)
        return sum(int(np.count_nonzero(outcomes.ok)) for outcomes in played)

    def always_seen(pulse_ns: int) -> bool:
        return seen(pulse_ns / NS_PER_US) == effort.touches

    longest_us = reaction_of(probing.nominal, probing.path).latest_us
    candidates_ns = range(1, round(longest_us * NS_PER_US) + 2)
    shortest_ns = candidates_ns[bisect_left(candidates_ns, True, key=always_seen)]
    return Pulses(
        pulses=effort.touches,
        triggering={width: proportion(seen(width), effort.touches) for width in widths_us},
        shortest=ShortestSeen(shortest_ns / NS_PER_US, effort.touches, rate_bound(effort.touches)),
    )
