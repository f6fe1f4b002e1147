"""Which numbers make sense, and how a message says so; for nominal keys and CSV columns alike."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray

# Beyond these a quantity is a slip of the pen, and its square or its inverse may not be finite.
SMALLEST_POSITIVE = 1e-6
LARGEST = 1e15
LONGEST_UM = 1e7  # 10 m
LARGEST_ANGLE = 1e7
LEAST_GUARD = 1e4  # limits of this size and more are told only when they are broken


class Constraint(Protocol):
    """What a number must fulfil."""

    @property
    def words(self) -> str:
        """What is expected, as in "expected a number > 0"."""

    def holds(self, values: FloatArray) -> BoolArray:
        """Tell for each value, shape (n,), whether it is admitted; NaN never is."""

    def words_against(self, value: float) -> str:
        """Say what is expected instead of a value that is not admitted."""


@dataclass(frozen=True, slots=True)
class Range:
    """Numbers from `low` to `high`, both included."""

    words: str
    low: float = -LARGEST
    high: float = LARGEST

    def holds(self, values: FloatArray) -> BoolArray:
        """See `Constraint.holds`."""
        return (values >= self.low) & (values <= self.high)

    def words_against(self, value: float) -> str:
        """Name the limit of size where only that is broken."""
        if value > self.high >= LEAST_GUARD:
            return f"a number <= {self.high:g}"
        if value < self.low <= -LEAST_GUARD or 0 < value < self.low:
            return f"a number >= {self.low:g}"
        return self.words


@dataclass(frozen=True, slots=True)
class OneOf:
    """A few admitted numbers."""

    words: str
    values: Sequence[float]

    def holds(self, values: FloatArray) -> BoolArray:
        """See `Constraint.holds`."""
        return np.isin(values, self.values)

    def words_against(self, _value: float) -> str:
        """See `Constraint.words_against`."""
        return self.words


INSTANT_US = Range("a number")
NOT_NEGATIVE = Range("a number >= 0", low=0.0)
POSITIVE = Range("a number > 0", low=SMALLEST_POSITIVE)
INSTANT_S = Range("a number >= 0", low=0.0, high=1e9)
LENGTH_UM = Range("a number", low=-LONGEST_UM, high=LONGEST_UM)
SIZE_UM = Range("a number >= 0", low=0.0, high=LONGEST_UM)
STEP_UM = Range("a number > 0", low=SMALLEST_POSITIVE, high=LONGEST_UM)
PLACE_MM = Range("a number", low=-LONGEST_UM, high=LONGEST_UM)
WAY_MM = Range("a number > 0", low=SMALLEST_POSITIVE, high=LONGEST_UM)
FEED = Range("a number > 0", low=SMALLEST_POSITIVE, high=1e9)
ANGLE = Range("a number", low=-LARGEST_ANGLE, high=LARGEST_ANGLE)
TEMPERATURE = Range("a number from -273.15 to 2500", low=-273.15, high=2500.0)
"""Hotter than any thermocouple stands, nothing was measured."""
ELEVATION = Range("a number from -90 to 90", low=-90.0, high=90.0)
SENSE = OneOf("1 or -1", (1.0, -1.0))
