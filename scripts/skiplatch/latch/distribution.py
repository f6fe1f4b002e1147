"""The distribution of a stream of numbers, in memory that does not grow with it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.statistics import CONFIDENCE, Interval, mean, standard_deviation

QUANTILES = (0.5, 0.95, 0.99, 0.999)
COARSE_BINS = 100  # at most, of the histogram that is drawn and written


@dataclass(frozen=True, slots=True)
class Bins:
    """Bins of one width beside each other, and the limits that the rig sets to the values."""

    low: float
    width: float
    count: int
    limits: tuple[float, float]

    @property
    def edges(self) -> FloatArray:
        """Shape (count + 1,)."""
        return np.asarray(self.low + self.width * np.arange(self.count + 1))


@dataclass(frozen=True, slots=True)
class Histogram:
    """How many values fell between neighbouring edges."""

    edges: Sequence[float]
    counts: Sequence[int]


@dataclass(frozen=True, slots=True)
class Summary:
    """A distribution in figures, with 95 % confidence intervals.

    Those of the extremes and of the range reach from what was seen to the limit that the rig sets.
    """

    count: int
    mean: Interval
    standard_deviation: Interval
    range: Interval
    minimum: Interval
    quantiles: Mapping[float, Interval]
    maximum: Interval
    resolution: float
    """Of the quantiles: the width of the bins they were found with."""
    histogram: Histogram


@dataclass(frozen=True, slots=True, eq=False)
class Chunk:
    """What a chunk of values adds: counts of the bins, power sums about the pivot, extremes."""

    counts: NDArray[np.int64]
    power_sums: FloatArray
    extremes: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Scale:
    """What chunks are summed up by, wherever that is done."""

    bins: Bins
    pivot: float

    def chunk(self, values: FloatArray) -> Chunk:
        """Sum up values, shape (n,) with n ≥ 1.

        Raises:
            ValueError: One lies outside the bins.
        """
        edges = self.bins.edges
        counts, _ = np.histogram(values, self.bins.count, (edges[0], edges[-1]))
        if counts.sum() != len(values):
            raise ValueError(f"values outside {edges[0]} … {edges[-1]}")
        first = values - self.pivot
        second = first * first
        sums = np.array([first.sum(), second.sum(), first @ second, second @ second])
        return Chunk(counts, sums, (float(values.min()), float(values.max())))


class Distribution:
    """Takes values chunk by chunk; extremes and moments are exact, quantiles as fine as the bins.

    The moments are taken about the mean of the first chunk, next to the final one, so that
    nothing cancels.
    """

    def __init__(self, bins: Bins) -> None:
        self._bins = bins
        self._counts = np.zeros(bins.count, dtype=np.int64)
        self._power_sums = np.zeros(4)
        self._pivot: float | None = None
        self._extremes = (math.inf, -math.inf)

    @property
    def scale(self) -> Scale:
        """What further chunks are summed up by, once there is a first."""
        if self._pivot is None:
            raise ValueError("no chunk yet")
        return Scale(self._bins, self._pivot)

    def add(self, values: FloatArray) -> None:
        """Take in values, shape (n,) with n ≥ 1.

        Raises:
            ValueError: One lies outside the bins.
        """
        if self._pivot is None:
            self._pivot = float(values.mean())
        self.join(self.scale.chunk(values))

    def join(self, chunk: Chunk) -> None:
        """Take in a chunk that was summed up by `scale`; the order decides the last bits."""
        self._power_sums += chunk.power_sums
        self._counts += chunk.counts
        low, high = self._extremes
        self._extremes = (min(low, chunk.extremes[0]), max(high, chunk.extremes[1]))

    def summary(self) -> Summary:
        """Sum up what was taken in, at least two values."""
        count = int(self._counts.sum())
        first, second, third, fourth = (float(total) / count for total in self._power_sums)
        deviation = math.sqrt(max(second - first**2, 0.0))
        moment = fourth - 4.0 * first * third + 6.0 * first**2 * second - 3.0 * first**4
        low, high = self._extremes
        low_limit, high_limit = self._bins.limits
        return Summary(
            count=count,
            mean=mean((self._pivot or 0.0) + first, deviation, count),
            standard_deviation=standard_deviation(deviation, moment, count),
            range=Interval(high - low, high - low, high_limit - low_limit),
            minimum=Interval(low, low_limit, low),
            quantiles=self._quantiles(count),
            maximum=Interval(high, high, high_limit),
            resolution=self._bins.width,
            histogram=self._coarse(),
        )

    def _quantiles(self, count: int) -> dict[float, Interval]:
        """Interpolate in the bins; the intervals, of order statistics, allow for half a bin."""
        fitted = scipy.stats.rv_histogram((self._counts, self._bins.edges), density=False)
        low_rank = scipy.stats.binom.ppf((1.0 - CONFIDENCE) / 2.0, count, QUANTILES) - 1.0
        high_rank = scipy.stats.binom.ppf((1.0 + CONFIDENCE) / 2.0, count, QUANTILES) + 1.0
        half = self._bins.width / 2.0
        values = np.clip(fitted.ppf(QUANTILES), *self._extremes)
        lows = fitted.ppf(np.maximum(low_rank, 0.0) / count) - half
        highs = fitted.ppf(np.minimum(high_rank, count) / count) + half
        found = np.array([values, *np.clip([lows, highs], *self._bins.limits)])
        return {
            share: Interval(*map(float, figures))
            for share, figures in zip(QUANTILES, found.T, strict=True)
        }

    def _coarse(self) -> Histogram:
        """Put neighbouring bins together, without the empty ones at both ends."""
        filled = np.flatnonzero(self._counts)
        begin, end = int(filled[0]), int(filled[-1]) + 1
        size = -(-(end - begin) // COARSE_BINS)
        starts = np.arange(begin, end, size)
        counts = np.add.reduceat(self._counts[:end], starts)
        edges = self._bins.low + self._bins.width * np.append(starts, end)
        return Histogram(edges.tolist(), counts.tolist())
