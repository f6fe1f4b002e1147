"""A compensation as one page of HTML: no script, nothing from elsewhere, light and dark."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.compensation import text
from skiplatch.compensation.compensate import Compensation
from skiplatch.compensation.probe_figures import ProbeFigures
from skiplatch.compensation.probe_map import ProbeMap
from skiplatch.compensation.uncertainty import Uncertainty
from skiplatch.figures.compensation import (
    Polar,
    draw_delay,
    draw_draws,
    draw_polar,
    scale,
)
from skiplatch.figures.inline import Drawing
from skiplatch.report.layout import Table, render
from skiplatch.units import PER_CENT, S_PER_MIN

TEMPLATE = "compensation.html"


@dataclass(frozen=True, slots=True, eq=False)
class After:
    """What was measured with a table."""

    probe_map: ProbeMap
    figures: ProbeFigures


def as_html(
    done: Compensation, found: ProbeFigures, known: Uncertainty, after: After | None, *, name: str
) -> str:
    """Lay out a compensation.

    Args:
        done: The table and what it was made of.
        found: Figures of the probe before.
        known: Its uncertainty.
        after: What was measured with the table, if it was.
        name: What the map is called.
    """
    return render(
        TEMPLATE,
        name=name,
        directions=len(done.probe_map),
        runs=done.probe_map.runs,
        headline=_headline(done, known, after),
        lead=_lead(done),
        radii=_radii(done, known, after),
        feeds=_feeds(done),
        summary=Table(("figure", "value"), text.summary_rows(done, known)),
        repeatability=text.repeatability_line(found),
        forms=Table(text.FORM_HEADER, text.form_rows(found)),
        after=_after(after),
        budget=Table(text.BUDGET_HEADER, text.budget_rows(known.budget)),
        budget_line=text.budget_line(known.budget, known.monte_carlo),
        simulated=Table(text.SIMULATED_HEADER, text.simulated_rows(known.monte_carlo)),
        draws=_draws(known),
        notes=text.notes(done, known),
    )


def _headline(done: Compensation, known: Uncertainty, after: After | None) -> str:
    if after is not None:
        left = f"{np.ptp(after.probe_map.mean_um):.1f} µm, as measured"
    else:
        left = f"{known.monte_carlo.vr_after_um.value:.1f} µm, as predicted"
    return f"Trigger radius varies by {done.vr_before_um:.1f} µm; with the speed table, {left}"


def _lead(done: Compensation) -> str:
    return (
        f"Feeds from {done.feed_mm_min.min():.1f} to {done.feed_mm_min.max():.1f} mm/min make the "
        f"pretravel the same in {len(done.probe_map)} directions. All approaches together take "
        f"{PER_CENT * done.time_increase:+.1f} % of time."
    )


def _after(after: After | None) -> dict[str, Any] | None:
    if after is None:
        return None
    forms = Table(text.FORM_HEADER, text.form_rows(after.figures))
    return {"repeatability": text.repeatability_line(after.figures), "forms": forms}


def _polar(probe_map: ProbeMap, value: FloatArray, unit: str) -> Polar:
    cells = probe_map.cells
    return Polar(cells.alpha_deg, cells.beta_deg, value, unit)


def _less_target(done: Compensation, radius_um: FloatArray, sign: float) -> FloatArray:
    return np.asarray(sign * (radius_um - done.target_um))


def _radii(done: Compensation, known: Uncertainty, after: After | None) -> list[Drawing]:
    sign = done.probe_map.sign
    before_um = _less_target(done, done.probe_map.mean_um, sign)
    predicted_um = _less_target(done, known.monte_carlo.example_um, sign)
    span_um = float(np.ptp(predicted_um))
    expected = f"predicted with the table, one draw of the random error: V_r {span_um:.1f} µm"
    shown = [
        ("before", done.probe_map, before_um, f"before: V_r {done.vr_before_um:.1f} µm"),
        ("predicted", done.probe_map, predicted_um, expected),
    ]
    if after is not None:
        own = after.probe_map
        again_um = own.sign * (own.mean_um - own.mean_um.mean())
        caption = f"measured with the table, less its mean: V_r {np.ptp(again_um):.1f} µm"
        shown.append(("measured", own, again_um, caption))
    limits = scale([value for _, _, value, _ in shown])
    return [
        draw_polar(
            key, _polar(own, value, "µm"), limits, caption, what=f"Trigger radius less W, {key}"
        )
        for key, own, value, caption in shown
    ]


def _feeds(done: Compensation) -> list[Drawing]:
    polar = _polar(done.probe_map, done.feed_mm_min, "mm/min")
    drawn = [
        draw_polar(
            "feeds",
            polar,
            scale([done.feed_mm_min]),
            "measuring feed over directions, mm/min",
            what="Measuring feed",
        )
    ]
    delay = done.delay
    if delay.speeds is not None:
        slope = delay.speeds.side * delay.tau_ms / S_PER_MIN
        caption = f"the delay is the slope: τ = {delay.tau_ms:.2f} ms"
        drawn.append(
            draw_delay("delay", delay.speeds.feed_mm_min, delay.speeds.radius_um, slope, caption)
        )
    return drawn


def _draws(known: Uncertainty) -> list[Drawing]:
    """Draw what was drawn, unless there is nothing random in it."""
    drawn = known.monte_carlo
    if known.budget.combined_um <= 0.0 or drawn.touch_deviation_um <= 0.0:
        return []
    return [
        draw_draws(
            "touch",
            drawn.touch_um,
            (0.0, known.budget.combined_um),
            "one touch with the table: the budget's normal distribution beside the draws",
            label="radius less W, µm",
        )
    ]
