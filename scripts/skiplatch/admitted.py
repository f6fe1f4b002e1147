"""Which numbers documented functions and the options of the commands take: one table for both."""

import math
import operator
from dataclasses import dataclass
from numbers import Real


@dataclass(frozen=True, slots=True)
class Count:
    """Whole numbers from `low` to `high`."""

    low: int
    high: int

    def checked(self, name: str, value: object) -> int:
        """Give an argument as a whole number.

        Raises:
            TypeError: It is no whole number.
            ValueError: It is out of range.
        """
        expected = f"{name}: expected a whole number from {self.low} to {self.high}, got {value!r}"
        try:
            count = operator.index(value)  # type: ignore[arg-type]  # which it tells
        except TypeError as error:
            raise TypeError(expected) from error
        if not self.low <= count <= self.high:
            raise ValueError(expected)
        return count


@dataclass(frozen=True, slots=True)
class Number:
    """Numbers from `low` to `high`."""

    low: float
    high: float

    def checked(self, name: str, value: object) -> float:
        """Give an argument as a number.

        Raises:
            TypeError: It is no number.
            ValueError: It is out of range, or NaN.
        """
        expected = f"{name}: expected a number from {self.low:g} to {self.high:g}, got {value!r}"
        if not isinstance(value, Real):
            raise TypeError(expected)
        number = float(value)
        if math.isnan(number) or not self.low <= number <= self.high:
            raise ValueError(expected)
        return number


SEED = Count(0, 2**63 - 1)
JOBS = Count(1, 1024)
REPLICATES = Count(1, 100_000)
TOUCHES = Count(1, 1000)
"""That are recommended."""
DRAWS = Count(1, 1_000_000)
MATERIAL_FRACTION = Number(1e-6, 1e6)
MATERIAL_SIZE = Number(1e-6, 1e9)
"""In µs or µm."""
