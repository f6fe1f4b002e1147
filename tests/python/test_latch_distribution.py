"""A distribution taken in by chunks is that of all the numbers together."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from skiplatch.latch.distribution import COARSE_BINS, QUANTILES, Bins, Distribution, Summary

BINS = Bins(low=-0.5, width=0.001, count=2000, limits=(0.0, 1.0))


def summary_of(values: NDArray[np.float64], bins: Bins = BINS, chunks: int = 7) -> Summary:
    distribution = Distribution(bins)
    for chunk in np.array_split(values, chunks):
        distribution.add(chunk)
    return distribution.summary()


@pytest.fixture(scope="module")
def values() -> NDArray[np.float64]:
    """Skewed, so that no odd moment vanishes; and the first are not like the rest."""
    return np.sort(np.random.default_rng(1).beta(2.0, 5.0, 10_000))


def test_moments_and_extremes_are_exact(values: NDArray[np.float64]) -> None:
    summary = summary_of(values)

    assert summary.count == len(values)
    assert summary.mean.value == pytest.approx(values.mean(), rel=1e-12)
    assert summary.standard_deviation.value == pytest.approx(values.std(), rel=1e-12)
    assert summary.minimum.value == values.min()
    assert summary.maximum.value == values.max()
    assert summary.range.value == np.ptp(values)


def test_interval_of_the_standard_deviation_uses_the_true_fourth_moment(
    values: NDArray[np.float64],
) -> None:
    found = summary_of(values).standard_deviation
    error = np.sqrt((stats.moment(values, 4) - values.var() ** 2) / len(values))
    half = stats.norm.isf(0.025) * error / (2.0 * values.std())

    assert found.high - found.value == pytest.approx(half, rel=1e-9)


def test_narrow_distribution_far_from_zero_loses_no_digits() -> None:
    values = 1e6 + np.random.default_rng(2).random(10_000)
    bins = Bins(low=1e6 - 0.5, width=0.001, count=2000, limits=(1e6, 1e6 + 1.0))

    assert summary_of(values, bins).standard_deviation.value == pytest.approx(
        (values - 1e6).std(), rel=1e-9
    )


@pytest.mark.parametrize("chunks", [1, 2, 100])
def test_chunks_do_not_matter(values: NDArray[np.float64], chunks: int) -> None:
    whole, parts = summary_of(values, chunks=1), summary_of(values, chunks=chunks)

    assert parts.quantiles == whole.quantiles
    assert parts.histogram == whole.histogram
    assert parts.mean.value == pytest.approx(whole.mean.value, rel=1e-12)


def test_quantiles_are_good_to_a_bin(values: NDArray[np.float64]) -> None:
    summary = summary_of(values)

    assert summary.resolution == BINS.width
    for share, found in summary.quantiles.items():
        low, high = (np.quantile(values, share, method=side) for side in ("lower", "higher"))
        assert low - BINS.width <= found.value <= high + BINS.width
        assert found.low <= found.value <= found.high


@pytest.mark.long
def test_intervals_of_quantiles_hold_the_true_ones() -> None:
    """Of 1000 samples; false-alarm rate 1e-6 a quantile, fixed seed."""
    samples = np.random.default_rng(3).random((1000, 2000))
    hits = dict.fromkeys(QUANTILES, 0)
    for sample in samples:
        for share, found in summary_of(sample, chunks=1).quantiles.items():
            hits[share] += found.low <= share <= found.high

    least = stats.binom.ppf(1e-6, len(samples), 0.95)
    assert min(hits.values()) >= least, hits


def test_intervals_of_extremes_reach_to_the_limits(values: NDArray[np.float64]) -> None:
    summary = summary_of(values)

    assert (summary.minimum.low, summary.minimum.high) == (0.0, values.min())
    assert (summary.maximum.low, summary.maximum.high) == (values.max(), 1.0)
    assert (summary.range.low, summary.range.high) == (np.ptp(values), 1.0)


@pytest.mark.parametrize("outside", [-0.6, 1.6])
def test_value_outside_the_bins_is_not_lost_in_silence(outside: float) -> None:
    with pytest.raises(ValueError, match="outside"):
        Distribution(BINS).add(np.array([0.5, outside]))


def test_histogram_for_drawing_is_short_and_holds_all(values: NDArray[np.float64]) -> None:
    histogram = summary_of(values).histogram

    assert len(histogram.counts) <= COARSE_BINS
    assert len(histogram.edges) == len(histogram.counts) + 1
    assert sum(histogram.counts) == len(values)
    assert histogram.edges[0] <= values.min()
    assert histogram.edges[-1] >= values.max()
    assert np.all(np.diff(histogram.edges) > 0.0)


def test_values_that_are_all_equal_have_no_spread() -> None:
    summary = summary_of(np.full(100, 0.25))

    assert summary.standard_deviation.value == 0.0
    assert summary.range.value == 0.0
    assert summary.histogram.counts == [100]
