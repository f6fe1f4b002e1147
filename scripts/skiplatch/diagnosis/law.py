"""The laws of a residual: sums of offsets, boxes, exponentials and a Gaussian, in closed form.

A simulated sample of any affordable size misjudges the tails, and with them every effect that adds
randomness; the density of the sum itself does not.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy import special

FloatArray = NDArray[np.float64]

CONTAMINATION = 1e-3
"""Share of touches that may lie anywhere: no law is trusted beyond that."""
SHORT = 0.3
"""Mean of an exponential, over the scatter of the boxes, that leaves the boxes their shape."""
SMALLEST = 1e-4
"""Scatter in µs or µm below which nothing is resolved, so that no density becomes infinite."""


@dataclass(frozen=True, slots=True)
class Extra:
    """What a share of the touches gets on top: an offset, a box from 0 and an exponential."""

    share: float
    offset: FloatArray | float = 0.0
    width: FloatArray | float = 0.0
    mean: FloatArray | float = 0.0
    """Of the exponential."""
    sigma: FloatArray | float = 0.0
    """Of a Gaussian."""
    boxless: FloatArray | float = 0.0
    """1 where the widest box of the law is not there for these touches."""


@dataclass(frozen=True, slots=True, eq=False)
class Law:
    """The law of n residuals: arrays of shape (n,), or numbers that hold for all of them.

    A residual is offset + U(0, box_a) + U(0, box_b) + N(0, sigma), and now and then an extra.
    """

    offset: FloatArray
    sigma: FloatArray
    box_a: FloatArray
    box_b: FloatArray
    extras: tuple[Extra, ...] = ()

    def select(self, rows: NDArray[np.bool_]) -> Self:
        """Give the law of some of the residuals; extras have to be numbers or of the same shape."""

        def part(value: FloatArray | float) -> FloatArray | float:
            return value[rows] if isinstance(value, np.ndarray) and value.ndim else value

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

    def widened(self, sigma: float) -> Self:
        """Give a smoother law, for a coarse search."""
        return replace(self, sigma=np.hypot(self.sigma, sigma))

    @property
    def mean(self) -> FloatArray:
        """Mean of each residual; shape (n,)."""
        mean = self.offset + (self.box_a + self.box_b) / 2.0
        for e in self.extras:
            gone = np.asarray(e.boxless) * self.box_a / 2.0
            mean = mean + e.share * (e.offset + np.asarray(e.width) / 2.0 + e.mean - gone)
        return np.asarray(mean)

    @property
    def spread(self) -> FloatArray:
        """Standard deviation of each residual, without the extras; shape (n,)."""
        variance = self.sigma**2 + (self.box_a**2 + self.box_b**2) / 12.0
        return np.asarray(np.sqrt(variance + SMALLEST**2))

    def log_density(self, residuals: FloatArray, reach: float) -> FloatArray:
        """Logarithm of the density of each residual, shape (n,).

        Args:
            residuals: Shape (n,).
            reach: Width over which a contaminated residual may lie anywhere.
        """
        rest = 1.0
        density = np.zeros_like(residuals)
        for extra in self.extras:
            density = density + extra.share * self._with(extra, residuals)
            rest -= extra.share
        density = density + rest * _plain(self, residuals - self.offset)
        wide = 1.0 / (np.pi * reach * (1.0 + (residuals / reach) ** 2))  # Cauchy
        return np.asarray(np.log((1.0 - CONTAMINATION) * density + CONTAMINATION * wide))

    def _with(self, extra: Extra, residuals: FloatArray) -> FloatArray:
        centred = residuals - self.offset - extra.offset
        law = replace(
            self,
            sigma=np.hypot(self.sigma, extra.sigma),
            box_a=self.box_a * (1.0 - np.asarray(extra.boxless)),
        )
        boxes_sigma = np.sqrt((law.box_a**2 + law.box_b**2) / 12.0)
        if np.any(np.asarray(extra.mean) > SHORT * boxes_sigma):
            return _with_exponential(law, extra, centred)
        law = replace(law, sigma=np.hypot(law.sigma, extra.mean))
        centred = centred - extra.mean
        boxes = np.sort(
            np.stack(
                np.broadcast_arrays(law.box_a, law.box_b, np.asarray(extra.width), centred)[:3]
            ),
            axis=0,
        )
        # The narrowest of three boxes counts by its mean and variance.
        sigma = np.sqrt(law.sigma**2 + boxes[0] ** 2 / 12.0)
        wide = replace(law, sigma=sigma, box_a=boxes[1], box_b=boxes[2])
        return _plain(wide, centred - boxes[0] / 2.0)


def _plain(law: Law, centred: FloatArray) -> FloatArray:
    """Density of the boxes and the Gaussian alone."""
    sigma = np.sqrt(law.sigma**2 + SMALLEST**2)
    return box_box_gauss(centred, sigma, law.box_a, law.box_b)


def _with_exponential(law: Law, extra: Extra, centred: FloatArray) -> FloatArray:
    widths = (law.box_a, law.box_b, np.asarray(extra.width))
    middle = sum(width / 2.0 for width in widths)
    sigma = np.sqrt(law.sigma**2 + SMALLEST**2 + sum(width**2 / 12.0 for width in widths))
    mean = np.maximum(np.asarray(extra.mean), SMALLEST)
    x = centred - middle
    # The exponentially modified Gaussian, by logarithms: its factors overflow.
    logarithm = 0.5 * (sigma / mean) ** 2 - x / mean + special.log_ndtr(x / sigma - sigma / mean)
    return np.asarray(np.exp(logarithm) / mean)


def extra_variance(law: Law) -> FloatArray:
    """Variance that extras add to each residual; shape (n,)."""
    mean, square = np.zeros_like(law.offset), np.zeros_like(law.offset)
    for e in law.extras:
        gone = np.asarray(e.boxless) * law.box_a / 2.0
        middle = np.asarray(e.offset) + np.asarray(e.width) / 2.0 + np.asarray(e.mean) - gone
        inner = np.asarray(e.width) ** 2 / 12.0 + np.asarray(e.mean) ** 2
        inner = inner + np.asarray(e.sigma) ** 2 - np.asarray(e.boxless) * law.box_a**2 / 12.0
        mean = mean + e.share * middle
        square = square + e.share * (inner + middle**2)
    return np.asarray(np.maximum(square - mean**2, -(law.spread**2)))


def box_box_gauss(
    x: FloatArray, sigma: FloatArray, box_a: FloatArray, box_b: FloatArray
) -> FloatArray:
    """Density at x of U(0, box_a) + U(0, box_b) + N(0, sigma); all of shape (n,), sigma > 0."""
    narrow, wide = np.minimum(box_a, box_b), np.maximum(box_a, box_b)
    # A box much narrower than the Gaussian is one more bit of Gaussian.
    folded = narrow < 0.1 * sigma
    sigma = np.where(folded, np.sqrt(sigma**2 + narrow**2 / 12.0), sigma)
    x = np.where(folded, x - narrow / 2.0, x)
    gone = wide < 0.1 * sigma
    spread = np.sqrt(sigma**2 + wide**2 / 12.0)
    gauss = np.exp(-0.5 * ((x - wide / 2.0) / spread) ** 2) / (spread * np.sqrt(2.0 * np.pi))
    safe_wide = np.where(gone, 1.0, wide)
    one = (special.ndtr(x / sigma) - special.ndtr((x - safe_wide) / sigma)) / safe_wide
    safe_narrow = np.where(folded, 1.0, narrow)
    ramps = [
        _ramp(x - shift, sigma) for shift in (0.0, safe_narrow, safe_wide, safe_narrow + safe_wide)
    ]
    two = (ramps[0] - ramps[1] - ramps[2] + ramps[3]) / (safe_narrow * safe_wide)
    density = np.where(gone, gauss, np.where(folded, one, two))
    return np.maximum(density, 0.0)


def _ramp(x: FloatArray, sigma: FloatArray) -> FloatArray:
    """Integral of the Gaussian's distribution function."""
    z = x / sigma
    return np.asarray(x * special.ndtr(z) + sigma * np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi))
