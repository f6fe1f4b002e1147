"""Estimates and the intervals that hold the true figure with 95 % confidence."""

import math
from dataclasses import dataclass
from typing import Self

import scipy

from skiplatch.arrays import FloatArray

CONFIDENCE = 0.95
SMALLEST_CHANCE = 1e-300


@dataclass(frozen=True, slots=True)
class Interval:
    """A figure with its confidence interval, all in one unit."""

    value: float
    low: float
    high: float

    def scaled(self, factor: float) -> Self:
        """Give the same in another unit; `factor` > 0."""
        return type(self)(self.value * factor, self.low * factor, self.high * factor)


def proportion(successes: int, trials: int, confidence: float = CONFIDENCE) -> Interval:
    """Estimate a probability, with the interval of Clopper and Pearson."""
    interval = scipy.stats.binomtest(successes, trials).proportion_ci(confidence)
    return Interval(successes / trials, interval.low, interval.high)


def errors_of(chance: float) -> float:
    """Give how many standard errors what comes so often by chance is from nothing; at least 0."""
    likely = min(max(chance, SMALLEST_CHANCE), 0.5)
    return float(scipy.stats.norm.isf(likely))


def errors_of_excess(count: int, trials: int, chance: float) -> float:
    """Give how many standard errors so many are above what comes at each trial by chance."""
    return errors_of(float(scipy.stats.binom.sf(count - 1, trials, chance)))


def rate_bound(trials: int, confidence: float = CONFIDENCE) -> float:
    """Give what the rate of an event does not exceed that never came in so many trials."""
    test = scipy.stats.binomtest(0, trials, alternative="less")
    return float(test.proportion_ci(confidence).high)


def robust_deviation(values: FloatArray) -> float:
    """Give the standard deviation of a normal law with the same median absolute deviation."""
    return float(scipy.stats.median_abs_deviation(values, scale="normal"))


def mean(value: float, deviation: float, count: int, confidence: float = CONFIDENCE) -> Interval:
    """Estimate a mean from that of a sample and from its standard deviation."""
    quantile = scipy.stats.t.ppf((1.0 + confidence) / 2.0, count - 1)
    half = float(quantile) * deviation / math.sqrt(count)
    return Interval(value, value - half, value + half)


def standard_deviation(
    value: float, fourth_moment: float, count: int, confidence: float = CONFIDENCE
) -> Interval:
    """Estimate a standard deviation, whatever the distribution, from a large sample.

    Args:
        value: That of the sample.
        fourth_moment: The fourth central moment of the sample.
        count: Size of the sample.
        confidence: Of the interval, which uses var(s²) = (m₄ − s⁴)/n.
    """
    if value == 0.0:
        return Interval(0.0, 0.0, 0.0)
    error = math.sqrt(max(fourth_moment - value**4, 0.0) / count) / (2.0 * value)
    half = float(scipy.stats.norm.ppf((1.0 + confidence) / 2.0)) * error
    return Interval(value, max(value - half, 0.0), value + half)


def uniform_width(seen: float, count: int, confidence: float = CONFIDENCE) -> Interval:
    """Estimate how wide a uniform distribution is, from the range of a sample.

    The range of a sample falls a little short. As a share of the width it follows a beta
    distribution, so that value and interval are exact.

    Args:
        seen: Greatest minus least value of the sample.
        count: Size of the sample, at least 2.
        confidence: Of the interval.
    """
    low, high = scipy.stats.beta.interval(confidence, count - 1, 2)
    return Interval(seen * (count + 1) / (count - 1), seen / float(high), seen / float(low))
