"""The pictures of a diagnosis, one small panel each, for its page."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import InputPath
from skiplatch.comparison.model import feed_words
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.figures import colours
from skiplatch.figures.ecdf import draw_ecdf, label_shares
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.figures.latch_errors import COLORS
from skiplatch.latch.text import TITLES
from skiplatch.report.conditions import Condition, bins_of
from skiplatch.report.evidence import Evidence, Seen
from skiplatch.tables import number

BEFORE, AFTER = colours.MUTED, colours.FOURTH
PANEL_IN = 2.1
RESIDUAL_IN = 2.3
TAIL = 0.002
"""Share of the touches on either side that a picture may leave outside."""
MARGIN = 0.06  # of the range, on both sides
LEAST_RANGE = 0.1  # µm, arcsec or µs
MOST_POINTS = 300
WIDE = 8.0  # greatest over least value, for a logarithmic axis
MOST_LEVELS = 6
"""Values of a condition that each have a tick."""
DIGITS = 3
SHRINK_IN = 0.42  # a row
SHRINK_FOOT_IN = 0.6


def draw_distribution(
    name: str, seen: Seen, evidence: Evidence, path: InputPath, feed_mm_min: float
) -> Drawing | None:
    """Draw what was recorded and played on one path at one feed; None where nothing was."""
    touches = evidence.touches
    rows = (touches.path == path) & (touches.feed_mm_min == feed_mm_min)
    samples = {
        "recorded": _finite(seen.recorded[rows]),
        "nominal simulation": _finite(seen.before[:, rows]),
    }
    if seen.after is not None:
        samples["simulation with the effects"] = _finite(seen.after[:, rows])
    if not all(map(len, samples.values())):
        return None
    recorded, before, *after = samples.values()
    color, _ = COLORS[path]
    with panel(PANEL_IN) as figure:
        axes = figure.subplots()
        draw_ecdf(axes, recorded, color=color, lw=2.4)
        draw_ecdf(axes, before, color=BEFORE, lw=1.4, ls=(0, (3, 2)))
        for sample in after:
            draw_ecdf(axes, sample, color=AFTER, lw=1.4)
        axes.set_xlim(*_range(*samples.values()))
        axes.set_xlabel(f"{seen.title}, {seen.unit}")
        axes.set_ylabel("share up to there")
        _plain_axes(axes)
        label_shares(axes)
    is_known, unit = "feed_mm_min" not in evidence.stood_in, seen.observable.feed_unit
    where = f"{TITLES[path]}, {feed_words(feed_mm_min, is_known=is_known, unit=unit)}"
    figures = "; ".join(f"{title} {_middle(sample)}" for title, sample in samples.items())
    description = (
        f"Cumulative distribution of {seen.title} in {seen.unit}, {where}, "
        f"{len(recorded)} touches. "
        f"Median and the range of nine tenths: {figures}."
    )
    return drawing(figure, name, f"{where}: {seen.title}", description)


def draw_residuals(name: str, seen: Seen, evidence: Evidence, condition: Condition) -> Drawing:
    """Draw what both simulations leave of an observable against a condition."""
    rows = (evidence.touches.path == evidence.path) & np.isfinite(seen.left_before)
    rows &= np.isfinite(condition.values)
    left = {"nominal simulation": (seen.left_before, BEFORE)}
    if seen.left_after is not None:
        left["simulation with the effects"] = (seen.left_after, AFTER)
    low, high = _range(*(_finite(values[rows]) for values, _ in left.values()))
    with panel(RESIDUAL_IN) as figure:
        axes = figure.subplots()
        axes.axhline(0.0, color=colours.INK, lw=0.8)
        for values, color in left.values():
            _draw_left(axes, condition.values, np.clip(values, low, high), rows, color)
        axes.set_ylim(low, high)
        axes.set_xlabel(condition.label)
        axes.set_ylabel(f"recorded − simulated, {seen.unit}")
        _plain_axes(axes)
        _scale_condition(axes, condition.values[rows])
    described = "; ".join(
        f"{title}: {_trend(condition, values, rows, seen.unit)}"
        for title, (values, _) in left.items()
    )
    caption = f"{seen.title} against {condition.title}, {TITLES[evidence.path]}"
    description = (
        f"Recorded minus simulated {seen.title} in {seen.unit} against {condition.label}, "
        f"{TITLES[evidence.path]}. Means from the least to the greatest value, {described}."
    )
    return drawing(figure, name, caption, description)


def draw_shrink(name: str, gaps: Sequence[Gap]) -> Drawing:
    """Draw by which share the gap of each observable shrinks, with its interval."""
    with panel(SHRINK_FOOT_IN + SHRINK_IN * len(gaps)) as figure:
        axes = figure.subplots()
        for row, gap in enumerate(gaps):
            axes.plot([gap.shrink.low, gap.shrink.high], [row, row], color=AFTER, lw=5, alpha=0.4)
            axes.plot([gap.shrink.value], [row], "o", color=AFTER, ms=7, mec=colours.PAPER)
        axes.axvline(0.0, color=colours.INK, lw=0.8)
        least = min(gap.shrink.low for gap in gaps)
        axes.set_xlim(min(least, 0.0) - 0.03, 1.03)
        axes.set_ylim(len(gaps) - 0.5, -0.5)
        axes.set_yticks(range(len(gaps)), [gap.title for gap in gaps])
        axes.grid(visible=False, axis="y")
        axes.xaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
        axes.set_xlabel("share gone, 95 % interval")
    described = "; ".join(
        f"{gap.title} {gap.shrink.value:.0%} ({gap.shrink.low:.0%} to {gap.shrink.high:.0%})"
        for gap in gaps
    )
    return drawing(
        figure,
        name,
        "How much of the gap is gone once the effects are simulated",
        f"Share of the gap that is gone with the effects, with its 95 % interval: {described}.",
    )


def _draw_left(axes: Axes, at: FloatArray, left: FloatArray, rows: BoolArray, color: str) -> None:
    chosen = np.flatnonzero(rows)
    chosen = chosen[np.linspace(0, len(chosen) - 1, min(len(chosen), MOST_POINTS)).astype(int)]
    axes.plot(at[chosen], left[chosen], "o", color=color, ms=2.6, mew=0.0, alpha=0.35)
    middles, means = _means(at, left, rows)
    axes.plot(middles, means, "-o", color=color, lw=1.8, ms=4.0, mec=colours.PAPER, mew=0.6)


def _means(at: FloatArray, left: FloatArray, rows: BoolArray) -> tuple[list[float], list[float]]:
    masks = [mask & rows for mask in bins_of(np.where(rows, at, np.nan))]
    return [float(at[m].mean()) for m in masks], [float(left[m].mean()) for m in masks]


def _trend(condition: Condition, left: FloatArray, rows: BoolArray, unit: str) -> str:
    middles, means = _means(condition.values, left, rows)
    if not means:
        return "too few touches for a trend"
    shown = sorted({0, len(means) // 2, len(means) - 1})
    return ", ".join(
        f"{number(means[i], DIGITS)} {unit} at {number(middles[i], DIGITS)}" for i in shown
    )


def _scale_condition(axes: Axes, values: FloatArray) -> None:
    """Give few values their own ticks, and feeds far apart a logarithmic axis."""
    levels = np.unique(values)
    wide = bool(levels[0] > 0.0 and levels[-1] / levels[0] > WIDE)
    few = len(levels) <= MOST_LEVELS
    if few and wide:
        axes.set_xscale("log")
    if few:
        axes.set_xticks(levels, [f"{level:g}" for level in levels])
        axes.set_xticks([], minor=True)


def _plain_axes(axes: Axes) -> None:
    axes.locator_params(nbins=5)
    axes.ticklabel_format(axis="x", useOffset=False, style="plain")


def _finite(values: FloatArray) -> FloatArray:
    return np.asarray(values[np.isfinite(values)])


def _range(*samples: FloatArray) -> tuple[float, float]:
    """Give what holds nearly all of each sample."""
    ends = np.array([np.quantile(sample, [TAIL, 1.0 - TAIL]) for sample in samples if len(sample)])
    low, high = (float(ends[:, 0].min()), float(ends[:, 1].max())) if len(ends) else (0.0, 0.0)
    margin = MARGIN * max(high - low, LEAST_RANGE)
    return low - margin, high + margin


def _middle(sample: FloatArray) -> str:
    low, middle, high = np.quantile(sample, [0.05, 0.5, 0.95])
    return f"{number(middle, DIGITS)} ({number(low, DIGITS)} to {number(high, DIGITS)})"
