"""Numbers that options take: written in plain digits, finite, and within what can be meant."""

import math
from typing import Self

import click

from skiplatch.admitted import Count, Number
from skiplatch.errors import quoted
from skiplatch.numbers import number


def number_or_nan(text: str) -> float:
    """Read a number; NaN for what is none, and infinity for one too large for a float."""
    try:
        return number(text)
    except ValueError:
        return math.nan


class NumberType(click.FloatRange):
    """A number from `low` to `high`."""

    name = "number"

    def __init__(self, low: float, high: float) -> None:
        super().__init__(low, high)
        self.low, self.high = low, high

    @classmethod
    def of(cls, admitted: Number) -> Self:
        """Take what a function takes."""
        return cls(admitted.low, admitted.high)

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """See `click.ParamType.convert`."""
        converted = number_or_nan(str(value))
        if not self.low <= converted <= self.high:
            expected = f"expected a number from {self.low:.15g} to {self.high:.15g}"
            self.fail(f"{expected}, got {quoted(str(value))}", param, ctx)
        return converted


class CountType(click.IntRange):
    """A whole number from `low` to `high`, which may be written as 1e6."""

    name = "count"

    def __init__(self, low: int, high: int) -> None:
        super().__init__(low, high)

    @classmethod
    def of(cls, admitted: Count) -> Self:
        """Take what a function takes."""
        return cls(admitted.low, admitted.high)

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> int:
        """See `click.ParamType.convert`."""
        text = str(value)
        if not number_or_nan(text).is_integer():
            self.fail(f"expected a whole number, got {quoted(text)}", param, ctx)
        is_short = not text.lstrip("+-").isdigit()
        return int(super().convert(int(float(text)) if is_short else int(text), param, ctx))


FEED_MM_MIN = NumberType(1e-3, 1e6)
"""That of a simulated touch; the fastest linear motors make 3e5."""
ACCEL_MM_S2 = NumberType(1e-3, 1e6)
"""To a hundred times that of gravity, which no machine tool reaches."""
LENGTH_MM = NumberType(1e-6, 1e4)
"""A way of an axis: from an interferometer's nanometre to the 10 m of a gantry."""
LENGTH_UM = NumberType(1e-6, 1e6)
"""What is small beside a way: from far below any resolution to a metre."""
TIME_MS = NumberType(1e-6, 1e4)
"""A delay between contact and report: from a nanosecond to 10 s."""
PERCENT = NumberType(1e-6, 50.0)
"""An error that leaves half of what it is an error of."""
TIME_S = NumberType(1e-9, 1e9)
"""How long is waited: from not at all to 30 years."""
