"""What a quiet bench shows of itself: nominal figures out of a recorded campaign.

The figures are those that reproduce the middle of what was recorded, from the 5 % to the 95 %
quantile. What comes now and then is no nominal figure: it is left to a diagnosis.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Kind, Nominal
from skiplatch.errors import InputError
from skiplatch.statistics import CONFIDENCE, Interval

TOUCHES_MIN = 50
MIDDLE = np.linspace(0.05, 0.95, 19)  # the quantiles that are believed
RESAMPLES = 200
DIGITS = 1  # of µs: a tenth is the tick of the Linux port
SPAN_MIN_US = 1e-3


@dataclass(frozen=True, slots=True)
class Belief:
    """Figures of nominal.toml with their 95 % intervals, µs.

    Attributes:
        skip_latency_us, skip_jitter_us: From edge to latch on the skip path, beyond the filter.
        report_latency_us, report_jitter_us: From latch to report, both paths.
        reference_jitter_us: Noise of the reference, 1 sigma.
        skip_touches, reports: How many touches they were taken from.
    """

    skip_latency_us: Interval
    skip_jitter_us: Interval
    report_latency_us: Interval
    report_jitter_us: Interval
    reference_jitter_us: Interval
    skip_touches: int
    reports: int

    def in_place_of(self, nominal: Nominal) -> Nominal:
        """Give a nominal with these figures, rounded to a tenth of a µs, and its own others."""

        def of(interval: Interval) -> float:
            return round(interval.value, DIGITS)

        return replace(
            nominal,
            skip=replace(
                nominal.skip,
                latency_us=of(self.skip_latency_us),
                jitter_us=of(self.skip_jitter_us),
            ),
            report=replace(
                nominal.report,
                latency_us=of(self.report_latency_us),
                jitter_us=of(self.report_jitter_us),
            ),
            bench=replace(nominal.bench, reference_jitter_us=of(self.reference_jitter_us)),
        )

    def as_json(self) -> dict[str, object]:
        """Give the figures for a file."""
        return {"format": "skiplatch-bench-belief/1", **asdict(self)}


def believe(campaign: Campaign, seed: int) -> Belief:
    """Take the figures from a campaign on which nothing disturbed the bench.

    Args:
        campaign: Of a bench, with `edge_us`, `latch_us` and `report_us`.
        seed: Of the resamples behind the intervals.

    Raises:
        InputError: It is no bench, or has too few touches with those times.
    """
    if campaign.nominal.kind is not Kind.BENCH:
        message = "recorded on a machine, but only a bench knows the true edge time"
        raise InputError(campaign.path, None, None, message)
    touches = campaign.touches
    latched_us = (touches.latch_us - touches.edge_us)[touches.on_skip & touches.ok]
    reported_us = (touches.report_us - touches.latch_us)[touches.ok]
    latched_us = _recorded(campaign, latched_us, "edge_us and latch_us on the skip path")
    reported_us = _recorded(campaign, reported_us, "latch_us and report_us")
    filtered_us = latched_us - campaign.nominal.input.filter_us
    latency, jitter, noise = _with_intervals(_noisy_box, filtered_us, seed)
    report_latency, report_jitter = _with_intervals(_box, reported_us, seed)
    return Belief(
        skip_latency_us=latency,
        skip_jitter_us=jitter,
        report_latency_us=report_latency,
        report_jitter_us=report_jitter,
        reference_jitter_us=noise,
        skip_touches=len(latched_us),
        reports=len(reported_us),
    )


def _recorded(campaign: Campaign, times_us: FloatArray, what: str) -> FloatArray:
    times_us = times_us[~np.isnan(times_us)]
    if len(times_us) < TOUCHES_MIN:
        message = f"{len(times_us)} touches with {what}, at least {TOUCHES_MIN} are needed"
        raise InputError(campaign.path, None, None, message)
    return times_us


def _box(times_us: FloatArray) -> FloatArray:
    """Give latency and jitter of the box with the 5 % and the 95 % quantile of the times."""
    low, high = np.quantile(times_us, MIDDLE[[0, -1]])
    jitter = (high - low) / (MIDDLE[-1] - MIDDLE[0])
    latency = max(low - MIDDLE[0] * jitter, 0.0)
    return np.array([latency, jitter])


def _noisy_box(times_us: FloatArray) -> FloatArray:
    """Give latency, jitter and sigma of a box with noise whose quantiles come nearest."""
    seen_us = np.quantile(times_us, MIDDLE)
    latency, jitter = _box(times_us)
    start = np.array([latency, max(jitter, SPAN_MIN_US) / 2.0, max(jitter, SPAN_MIN_US) / 4.0])

    def misfit(figures: FloatArray) -> FloatArray:
        return _share_below(seen_us, *figures) - MIDDLE

    found = scipy.optimize.least_squares(
        misfit,
        start,
        bounds=([0.0, SPAN_MIN_US, SPAN_MIN_US], np.inf),
        x_scale=max(jitter, SPAN_MIN_US),
    )
    figures: FloatArray = found.x
    return figures


def _share_below(times_us: FloatArray, latency: float, jitter: float, sigma: float) -> FloatArray:
    """Give P(latency + U(0, jitter) + N(0, sigma) < t): the integral of Φ over the box."""

    def ramp(x: FloatArray) -> FloatArray:
        z = x / sigma
        density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
        value: FloatArray = x * scipy.special.ndtr(z) + sigma * density
        return value

    return (ramp(times_us - latency) - ramp(times_us - latency - jitter)) / jitter


def _with_intervals(
    estimate: Callable[[FloatArray], FloatArray], times_us: FloatArray, seed: int
) -> list[Interval]:
    """Estimate, with percentile intervals of the bootstrap."""
    values = estimate(times_us)
    found = scipy.stats.bootstrap(
        (times_us,),
        estimate,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        vectorized=False,
        rng=np.random.default_rng(seed),
    ).confidence_interval
    figures = np.column_stack([values, found.low, found.high]).tolist()
    return [Interval(value, low, high) for value, low, high in figures]
