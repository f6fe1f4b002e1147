"""A probe's trigger radius over directions before and after compensation, and what it rests on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from skiplatch.arrays import FloatArray, spaced
from skiplatch.figures import colours
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.tables import number

COLORS = (colours.SKIP, colours.PLC, colours.THIRD, colours.FOURTH)
MARKS = ("o", "s", "^", "D")
HOLE = 0.6
"""Width of the empty middle, as a share of the scale: no radius in a picture is below nothing."""
MARGIN = 0.08
TICKS = 3
LABEL_DEG = 15.0
"""Where around the axis the scale is written, above all curves."""
LEAST_SPAN_UM = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Polar:
    """A quantity over directions.

    Attributes:
        alpha_deg: Shape (n,).
        beta_deg: Shape (n,).
        value: Shape (n,).
        unit: Its unit.
    """

    alpha_deg: FloatArray
    beta_deg: FloatArray
    value: FloatArray
    unit: str


def shown_rings(beta_deg: FloatArray) -> list[float]:
    """The rings that a picture shows: all, or four from the first to the last.

    The pole is no ring: it has no azimuth.
    """
    rings = [float(beta) for beta in np.unique(beta_deg) if (beta_deg == beta).sum() > 1]
    return [rings[i] for i in spaced(len(rings), len(COLORS))]


def scale(parts: Sequence[FloatArray]) -> tuple[float, float]:
    """Give the least and the greatest value that pictures with one scale have to show."""
    low = min(float(part.min()) for part in parts)
    high = max(float(part.max()) for part in parts)
    margin = MARGIN * max(high - low, LEAST_SPAN_UM)
    return low - margin, high + margin


def draw_polar(
    name: str, seen: Polar, limits: tuple[float, float], caption: str, *, what: str
) -> Drawing:
    """Draw a curve for each ring around the probe axis; a dot is a direction."""
    low, high = limits
    with panel(3.6) as figure:
        axes = figure.add_subplot(projection="polar")
        assert isinstance(axes, PolarAxes)  # noqa: S101  for the type checker
        for beta, color, mark in zip(shown_rings(seen.beta_deg), COLORS, MARKS, strict=False):
            ring = seen.beta_deg == beta
            order = np.argsort(seen.alpha_deg[ring])
            angle = np.radians(seen.alpha_deg[ring][order])
            value = seen.value[ring][order]
            axes.plot(
                np.append(angle, angle[0]),
                np.append(value, value[0]),
                color=color,
                marker=mark,
                ms=2.6,
                lw=1.2,
                label=f"β {beta:g}°",
            )
        axes.set_rlim(low, high)
        axes.set_rorigin(low - HOLE * (high - low))
        _dress(axes, seen.unit)
        figure.legend(
            *axes.get_legend_handles_labels(),
            loc="outside lower center",
            ncols=len(COLORS),
            frameon=False,
            columnspacing=1.2,
            handlelength=1.5,
        )
        span = float(np.ptp(seen.value))
        description = (
            f"{what} in {seen.unit} over the azimuth, a curve for each of the rings at β "
            f"{', '.join(f'{beta:g}°' for beta in shown_rings(seen.beta_deg))}. Over all "
            f"directions it goes from {number(float(seen.value.min()))} to "
            f"{number(float(seen.value.max()))} {seen.unit}, a range of {number(span, 3)}."
        )
        return drawing(figure, name, caption, description)


def _dress(axes: PolarAxes, unit: str) -> None:
    axes.set_thetagrids(np.arange(0.0, 360.0, 30.0))
    axes.tick_params(axis="x", pad=0, labelsize=7.5)
    low, high = axes.get_ylim()
    ticks = MaxNLocator(TICKS).tick_values(low, high)
    shown = [float(tick) for tick in ticks if low <= tick <= high]
    axes.set_yticks(shown, [""] * len(shown))
    for tick in shown:
        words = f"{tick:g} {unit}" if tick == shown[-1] else f"{tick:g}"
        box = {"facecolor": colours.PAPER, "edgecolor": "none", "pad": 0.6}
        angle = float(np.radians(LABEL_DEG))
        axes.text(angle, tick, words, fontsize=7.0, ha="center", va="center", bbox=box)
    axes.spines["polar"].set_color(colours.GRID)


def draw_delay(
    name: str, feed_mm_min: FloatArray, radius_um: FloatArray, slope: float, caption: str
) -> Drawing:
    """Draw mean radii over feeds with the line whose slope is the delay.

    Args:
        name: Unique in the page.
        feed_mm_min: Shape (n,).
        radius_um: As it was measured, shape (n,).
        slope: In µm per mm/min, with the sign as it was measured.
        caption: What stands below.
    """
    with panel(2.6) as figure:
        axes = figure.subplots()
        ends = np.array([feed_mm_min.min(), feed_mm_min.max()])
        middle_um, middle = radius_um.mean(), feed_mm_min.mean()
        axes.plot(ends, slope * (ends - middle), color=colours.SKIP, lw=1.4)
        axes.plot(feed_mm_min, radius_um - middle_um, "o", ms=3.5, mfc="none", mec=colours.INK)
        axes.set_xlabel("feed, mm/min")
        axes.set_ylabel("mean radius − its mean, µm")
        description = (
            f"Mean trigger radius over the feed, {len(feed_mm_min)} runs at "
            f"{len(np.unique(feed_mm_min))} feeds from {ends[0]:g} to {ends[1]:g} mm/min, and the "
            f"straight line through them, which changes by {slope * float(np.ptp(ends)):.3g} µm."
        )
        return drawing(figure, name, caption, description)


def draw_draws(
    name: str, draws: FloatArray, normal: tuple[float, float], caption: str, *, label: str
) -> Drawing:
    """Draw the distribution of Monte Carlo draws beside the normal one of the GUM.

    Args:
        name: Unique in the page.
        draws: Shape (n,).
        normal: Its mean and standard deviation.
        caption: What stands below.
        label: Of the horizontal axis, with its unit.
    """
    mean, deviation = normal
    with panel(2.6) as figure:
        axes = figure.subplots()
        counts, edges = np.histogram(draws, bins=40, density=True)
        axes.stairs(counts, edges, fill=True, color=colours.PLC_LIGHT)
        axes.stairs(counts, edges, color=colours.PLC, lw=1.0, label="Monte Carlo")
        x = np.linspace(mean - 4.0 * deviation, mean + 4.0 * deviation, 201)
        density = np.exp(-0.5 * ((x - mean) / deviation) ** 2)
        density /= deviation * np.sqrt(2.0 * np.pi)
        axes.plot(x, density, color=colours.INK, lw=1.3, label="GUM, normal")
        axes.set_xlabel(label)
        axes.set_ylabel("density")
        axes.set_yticks([])
        figure.legend(
            *axes.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False
        )
        low, high = np.quantile(draws, [0.025, 0.975])
        description = (
            f"Distribution of {label}: 95 % of the Monte Carlo draws lie between "
            f"{number(float(low), 3)} and {number(float(high), 3)}; the normal distribution of the "
            f"GUM budget beside it has the mean {number(mean, 3)} and the standard uncertainty "
            f"{number(deviation, 3)}."
        )
        return drawing(figure, name, caption, description)
