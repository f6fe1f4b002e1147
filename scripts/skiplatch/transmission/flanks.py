"""Which flank of a mark a pulse stamps: rising and falling edges change places with the sense.

A line of an encoder is a mark of some width. Forward its first flank gives the rising edge,
backward its second one. A backlash compares both senses, so it has to compare the same flank.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from skiplatch.transmission.pulses import BACKWARD, CODED, FALLING, INPUT, OUTPUT, Pulses

LEAST_MARKS = 10
"""Fewer do not tell a width."""


@dataclass(slots=True)
class Train:
    """What the edges of one encoder tell, taken block by block.

    Attributes:
        sense: In which the motion began; 0 before the first edge.
        turns: How often it turned.
        turned_on_mark: It first turned between the two flanks of a mark.
        falls_back: Falling edges were stamped against the sense in which it began.
        marks: How many had both flanks stamped, before it turned.
        widths: Sum of their widths, in pitches.
    """

    sense: int = 0
    turns: int = 0
    turned_on_mark: bool = False
    falls_back: bool = False
    marks: int = 0
    widths: float = 0.0
    _tail: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))

    def add(self, edges: NDArray[np.int64]) -> None:
        """Take edges of a block, shape (n, 3): time in ns, 1 where it falls, sense."""
        if not len(edges):
            return
        self.sense = self.sense or int(edges[0, 2])
        joined = np.concatenate([self._tail, edges])
        _, falls, sense = joined.T
        self.falls_back |= bool(np.any((falls == 1) & (sense != self.sense)))
        seen = max(len(self._tail) - 1, 0)  # turns between edges of the tail are counted
        turns = seen + np.flatnonzero(np.diff(sense[seen:]))
        if len(turns) and not self.turns:
            self.turned_on_mark = bool(falls[turns[0]] == 0)
        self.turns += len(turns)
        self._measure(joined)
        self._tail = joined[-2:]

    def _measure(self, edges: NDArray[np.int64]) -> None:
        t_ns, falls, sense = edges.T
        begins = np.flatnonzero(
            (falls[:-2] == 0)
            & (falls[1:-1] == 1)
            & (falls[2:] == 0)
            & (sense[:-2] == self.sense)
            & (sense[2:] == self.sense)
            & (t_ns[2:] > t_ns[:-2])
        )
        wide = (t_ns[begins + 1] - t_ns[begins]) / (t_ns[begins + 2] - t_ns[begins])
        self.marks += len(begins)
        self.widths += float(wide.sum())

    @property
    def width(self) -> float | None:
        """Mean width of a mark in pitches; None where both flanks were hardly stamped."""
        return self.widths / self.marks if self.marks >= LEAST_MARKS else None

    @property
    def ahead(self) -> float | None:
        """By how many lines the flank that is stamped after the turn lies ahead of its count.

        None where nobody can tell: only rising edges, and no width or several turns.
        """
        if not self.turns or self.falls_back:
            return 0.0
        if self.width is None or self.turns > 1:
            return None
        return self.width - self.turned_on_mark

    def keeps(self, falls: NDArray[np.bool_], back: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Tell which edges count: one flank of each mark, the same in both senses if it can be."""
        is_other = back == (self.sense > 0)
        return np.asarray(falls == (is_other & self.falls_back))


@dataclass(frozen=True, slots=True)
class Flanks:
    """The edges of both encoders: of the input, and of the output."""

    trains: dict[int, Train]

    def kept(self, pulses: Pulses) -> Pulses:
        """Leave one edge a line."""
        base, falls, back = _parts(pulses)
        keeps = base > OUTPUT
        for channel, train in self.trains.items():
            keeps |= (base == channel) & train.keeps(falls, back)
        return Pulses((pulses.channel & ~np.uint8(FALLING))[keeps], pulses.t_ns[keeps])

    def shift(self, line1: float, line2: float) -> float | None:
        """Give what the flanks take off a backlash; a line of input and output in its unit.

        None where that cannot be told.
        """
        ahead1, ahead2 = self.trains[INPUT].ahead, self.trains[OUTPUT].ahead
        if ahead1 is None or ahead2 is None:
            return None
        return ahead2 * line2 - ahead1 * line1


def survey(blocks: Iterable[Pulses]) -> Flanks:
    """Look at all edges of a file that has both kinds."""
    trains = {channel: Train() for channel in (INPUT, OUTPUT)}
    for pulses in blocks:
        base, falls, back = _parts(pulses)
        rows = np.column_stack([pulses.t_ns, falls, np.where(back, -1, 1)])
        for channel, train in trains.items():
            train.add(rows[base == channel])
    return Flanks(trains)


def _parts(pulses: Pulses) -> tuple[NDArray[np.uint8], NDArray[np.bool_], NDArray[np.bool_]]:
    code = pulses.channel
    return code & ~np.uint8(CODED), (code & FALLING) != 0, (code & BACKWARD) != 0
