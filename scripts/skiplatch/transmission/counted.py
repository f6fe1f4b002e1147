"""What both trains show by themselves: the tick of their clock, and how far each turned."""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from skiplatch.tables import compact
from skiplatch.transmission.pulses import BACKWARD, INPUT, OUTPUT, Pulses

CHANNELS = (INPUT, OUTPUT)
MOST_APART = 0.005
"""Of the turns, by which both trains may differ: no drive that holds slips more."""
FEWEST_LINES = 8
"""Of the coarser train, by which they have to: both begin and end anywhere between two lines."""

IntArray = np.typing.NDArray[np.int64]


class Counted:
    """Takes the pulses block by block."""

    def __init__(self) -> None:
        self.tick_ns = 0
        """Greatest common divisor of all intervals: the clock's tick, or a part of it."""
        self._lines = np.zeros(len(CHANNELS), dtype=np.int64)
        self._first: dict[int, tuple[int, IntArray]] = {}
        self._last: dict[int, tuple[int, IntArray]] = {}
        self._tail_ns = np.empty(0, dtype=np.int64)

    def add(self, pulses: Pulses) -> None:
        """Take a block."""
        t_ns = np.append(self._tail_ns, pulses.t_ns)
        self.tick_ns = int(np.gcd.reduce(np.diff(t_ns), initial=self.tick_ns))
        self._tail_ns = t_ns[-1:]
        sense = np.where(pulses.channel & BACKWARD, -1, 1)
        base = pulses.channel & ~np.uint8(BACKWARD)
        lines = self._lines + np.cumsum([sense * (base == c) for c in CHANNELS], axis=1).T
        for channel in CHANNELS:
            seen = np.flatnonzero(base == channel)
            if len(seen):
                first, last = ((int(pulses.t_ns[i]), lines[i]) for i in (seen[0], seen[-1]))
                self._first.setdefault(channel, first)
                self._last[channel] = last
        self._lines = lines[-1] if len(lines) else self._lines

    def told(self, lines1: int, lines2: int, ratio: Fraction) -> Iterator[str]:
        """Say where both trains did not turn alike by these figures, while there were both."""
        begin = max(self._first.values(), key=lambda one: one[0])[1]
        end = min(self._last.values(), key=lambda one: one[0])[1]
        a_turn = np.array([float(lines1 * ratio), float(lines2)])
        turns = np.abs(end - begin) / a_turn
        if np.ptp(turns) > max(MOST_APART * turns.max(), FEWEST_LINES / a_turn.min()):
            yield (
                f"the output turned {compact(turns[0])} times by the pulses of the input and "
                f"{compact(turns[1])} times by its own: check --lines1, --lines2 and --ratio, "
                "or pulses are missing"
            )
