"""Intervals hold what they promise. All seeds are fixed.

A coverage is counted over 2000 samples and may lie where a true 95 % puts it but for a chance of
1e-6, which is each test's false-alarm rate.
"""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from skiplatch.statistics import (
    Interval,
    mean,
    proportion,
    rate_bound,
    standard_deviation,
    uniform_width,
)

SAMPLES = 2000
FALSE_ALARM = 1e-6


def uniform_samples(size: int, seed: int) -> NDArray[np.float64]:
    return np.random.default_rng(seed).random((SAMPLES, size))


def covers(intervals: list[Interval], truth: float) -> int:
    return sum(interval.low <= truth <= interval.high for interval in intervals)


def assert_covers_95_percent(hits: int) -> None:
    low, high = stats.binom.interval(1.0 - FALSE_ALARM, SAMPLES, 0.95)
    assert low <= hits <= high


def test_interval_of_a_mean_holds_the_true_one() -> None:
    samples = uniform_samples(50, seed=1)
    intervals = [mean(float(s.mean()), float(s.std(ddof=1)), len(s)) for s in samples]

    assert_covers_95_percent(covers(intervals, 0.5))


def test_interval_of_a_standard_deviation_holds_the_true_one_without_a_normal_law() -> None:
    samples = uniform_samples(1000, seed=2)
    intervals = [
        standard_deviation(float(s.std()), float(stats.moment(s, 4)), len(s)) for s in samples
    ]

    assert_covers_95_percent(covers(intervals, 1.0 / math.sqrt(12.0)))


@pytest.mark.parametrize("size", [2, 10, 1000])
def test_interval_of_a_uniform_width_holds_the_true_one(size: int) -> None:
    samples = 4.0 * uniform_samples(size, seed=3)
    intervals = [uniform_width(float(np.ptp(s)), size) for s in samples]

    assert_covers_95_percent(covers(intervals, 4.0))


def test_uniform_width_is_not_biased() -> None:
    widths = np.array([uniform_width(float(np.ptp(s)), 10).value for s in uniform_samples(10, 4)])
    error = widths.std() / math.sqrt(SAMPLES)

    assert abs(widths.mean() - 1.0) < stats.norm.isf(FALSE_ALARM / 2.0) * error


def test_interval_of_a_proportion_holds_the_true_one_at_least_as_often() -> None:
    found = np.random.default_rng(5).binomial(300, 0.03, SAMPLES)
    intervals = {k: proportion(k, 300) for k in set(found.tolist())}
    hits = covers([intervals[k] for k in found.tolist()], 0.03)

    assert hits >= stats.binom.ppf(FALSE_ALARM, SAMPLES, 0.95)


def test_rate_of_what_never_came_is_bounded_by_three_over_n() -> None:
    assert rate_bound(100_000) == pytest.approx(1.0 - 0.05 ** (1.0 / 100_000), rel=1e-9)


def test_numbers_that_are_all_equal_have_no_interval() -> None:
    assert standard_deviation(0.0, 0.0, 100) == Interval(0.0, 0.0, 0.0)
    assert mean(3.0, 0.0, 100) == Interval(3.0, 3.0, 3.0)


def test_scaling_keeps_the_type_and_scales_all_three() -> None:
    assert Interval(1.0, 0.5, 2.0).scaled(10.0) == Interval(10.0, 5.0, 20.0)
