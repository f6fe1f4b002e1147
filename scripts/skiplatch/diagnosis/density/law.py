"""The laws of a residual: sums of offsets, boxes, exponentials and a Gaussian, in closed form.

A simulated sample of any affordable size misjudges the tails, and with them every effect that adds
randomness; the density of the sum itself does not. It is computed in ``sum.c``, beside this.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray, median

SMALLEST = 1e-4
"""Scatter in µs or µm below which nothing is resolved, so that no density becomes infinite."""


@dataclass(frozen=True, slots=True)
class Extra:
    """What a share of the touches gets on top: an offset, a box from 0 and an exponential."""

    share: float
    offset: FloatArray | float = 0.0
    width: FloatArray | float = 0.0
    mean: FloatArray | float = 0.0
    """Of the exponential, which takes away if it is below 0."""
    sigma: FloatArray | float = 0.0
    """Of a Gaussian."""
    boxless: FloatArray | float = 0.0
    """1 where the widest box of the law is not there for these touches."""

    def middle(self, box: FloatArray) -> FloatArray:
        """Give its mean, less that of the law's widest box where this is not there; shape (n,)."""
        gone = np.asarray(self.boxless) * box / 2.0
        return np.asarray(self.offset + np.asarray(self.width) / 2.0 + self.mean - gone)

    def with_share(self, share: float) -> "Extra":
        """Give the same for another share of the touches."""
        # A copy by dataclasses.replace takes several times as long; searches ask by the thousand.
        return Extra(share, self.offset, self.width, self.mean, self.sigma, self.boxless)


@dataclass(frozen=True, eq=False)
class Law:
    """The law of n residuals: arrays of shape (n,), or numbers that hold for all of them.

    A residual is offset + U(0, box_a) + U(0, box_b) + N(0, sigma), and now and then an extra.
    """

    offset: FloatArray
    sigma: FloatArray
    box_a: FloatArray
    box_b: FloatArray
    extras: tuple[Extra, ...] = ()

    def select(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Self:
        """Give the law of some of the residuals; extras have to be numbers or of the same shape."""
        numbers = np.flatnonzero(rows) if rows.dtype == np.bool_ else rows

        def part(value: FloatArray | float) -> FloatArray | float:
            return value.take(numbers) if isinstance(value, np.ndarray) and value.ndim else value

        extras = tuple(
            Extra(
                e.share,
                part(e.offset),
                part(e.width),
                part(e.mean),
                part(e.sigma),
                part(e.boxless),
            )
            for e in self.extras
        )
        return type(self)(
            offset=np.asarray(part(self.offset)),
            sigma=np.asarray(part(self.sigma)),
            box_a=np.asarray(part(self.box_a)),
            box_b=np.asarray(part(self.box_b)),
            extras=extras,
        )

    @cached_property
    def mean(self) -> FloatArray:
        """Mean of each residual; shape (n,)."""
        mean = self.offset + (self.box_a + self.box_b) / 2.0
        for e in self.extras:
            mean = mean + e.share * e.middle(self.box_a)
        return np.asarray(mean)

    @cached_property
    def plain_variance(self) -> FloatArray:
        """Variance of each residual, without the extras; shape (n,)."""
        return np.asarray(self.sigma**2 + (self.box_a**2 + self.box_b**2) / 12.0 + SMALLEST**2)

    @cached_property
    def spread(self) -> FloatArray:
        """Standard deviation of each residual, without the extras; shape (n,)."""
        return np.asarray(np.sqrt(self.plain_variance))

    @cached_property
    def variance(self) -> FloatArray:
        """Variance of each residual, with the extras; shape (n,)."""
        plain = self.plain_variance
        return np.asarray(plain + extra_variance(self)) if self.extras else plain

    @cached_property
    def usual_spread(self) -> float:
        """Median of the spread, n > 0."""
        return median(self.spread)


def spliced(parts: Sequence[tuple[BoolArray, Law]]) -> Law:
    """Give one law of those for some of n residuals each, by masks of shape (n,) that share none.

    It is for their middle and their scatter, in which it has the extras; densities are the parts'.
    """

    def whole(values: Iterable[FloatArray]) -> FloatArray:
        there = (np.where(rows, v, 0.0) for (rows, _), v in zip(parts, values, strict=True))
        return np.asarray(sum(there))

    laws = [law for _, law in parts]
    box_a, box_b = whole(law.box_a for law in laws), whole(law.box_b for law in laws)
    mean, variance = whole(law.mean for law in laws), whole(law.variance for law in laws)
    gaussian = variance - (box_a**2 + box_b**2) / 12.0 - SMALLEST**2
    sigma = np.sqrt(np.maximum(gaussian, 0.0))
    return Law(mean - (box_a + box_b) / 2.0, sigma, box_a, box_b)


def extra_variance(law: Law) -> FloatArray:
    """Variance that extras add to each residual; shape (n,)."""
    mean, square = np.zeros_like(law.offset), np.zeros_like(law.offset)
    for e in law.extras:
        middle = e.middle(law.box_a)
        inner = np.asarray(e.width) ** 2 / 12.0 + np.asarray(e.mean) ** 2
        inner = inner + np.asarray(e.sigma) ** 2 - np.asarray(e.boxless) * law.box_a**2 / 12.0
        mean = mean + e.share * middle
        square = square + e.share * (inner + middle**2)
    return np.asarray(np.maximum(square - mean**2, -law.plain_variance))
