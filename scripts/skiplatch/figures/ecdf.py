"""Distributions as their cumulative shares, which need no bins."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from skiplatch.arrays import FloatArray

MOST_STEPS = 200
"""Of a curve; a larger sample is drawn by so many of its quantiles."""


def draw_ecdf(axes: Axes, sample: FloatArray, **style: Any) -> None:  # noqa: ANN401
    """Draw the share of a sample (n,) that lies at or below each value."""
    shares = np.linspace(0.0, 1.0, min(len(sample), MOST_STEPS) + 1)
    values = np.quantile(sample, shares, method="inverted_cdf")
    axes.step(values, shares, where="post", **style)


def label_shares(axes: Axes) -> None:
    """Make the axis of shares one of per cent."""
    axes.set_ylim(-0.02, 1.02)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
