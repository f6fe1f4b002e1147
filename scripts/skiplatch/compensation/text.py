"""What came of a compensation, in words and plain types."""

import math
from dataclasses import asdict
from typing import Any

from skiplatch.compensation.budget import COVERAGE, Budget
from skiplatch.compensation.compensate import Compensation, Times
from skiplatch.compensation.monte_carlo import MonteCarlo
from skiplatch.compensation.probe_figures import Form, ProbeFigures
from skiplatch.compensation.uncertainty import Uncertainty
from skiplatch.statistics import Interval
from skiplatch.tables import listing, number, table, whole, with_interval
from skiplatch.units import PER_CENT

BUDGET_HEADER = ("source", "type", "distribution", "u", "unit", "c, µm per unit", "u·c, µm")
FORM_HEADER = (
    "V_r, µm",
    "points",
    "mean of the runs",
    "about its best-fit centre",
    "worst run",
    "all touches",
)
SIMULATED_HEADER = ("", "mean", "95 % interval")


def as_text(
    done: Compensation, found: ProbeFigures, known: Uncertainty, after: ProbeFigures | None
) -> str:
    """Everything, for the terminal."""
    parts = [
        listing(summary_rows(done, known)),
        "Probe, in the style of ISO 230-10\n" + _figures_text(found),
        *(["Measured again with a table\n" + _figures_text(after)] if after else []),
        "Radius of one touch with the table, GUM budget\n"
        + table(BUDGET_HEADER, budget_rows(known.budget))
        + "\n"
        + budget_line(known.budget, known.monte_carlo),
        f"Monte Carlo, {whole(known.monte_carlo.draws)} tables\n"
        + table(SIMULATED_HEADER, simulated_rows(known.monte_carlo)),
    ]
    return "\n\n".join(parts + notes(done, known))


def summary_rows(done: Compensation, known: Uncertainty) -> list[tuple[str, str]]:
    """Give the main figures, a name and a value each."""
    probe_map = done.probe_map
    after = known.monte_carlo.vr_after_um
    delay = done.delay
    source = "given"
    if delay.speeds is not None:
        source = f"standard uncertainty {number(delay.uncertainty_ms, 2)} ms, "
        source += f"{len(delay.speeds.feed_mm_min)} runs"
    elif delay.uncertainty_ms > 0.0:
        source = f"given, standard uncertainty {number(delay.uncertainty_ms, 2)} ms"
    predicted = f"{after.value:.2f} µm ({after.low:.2f} … {after.high:.2f})"
    feeds = f"{done.feed_mm_min.min():.2f} … {done.feed_mm_min.max():.2f} mm/min"
    before = f"{done.vr_before_um:.2f} µm, U = {known.vr_before_expanded_um:.2f} µm (k = 2)"
    runs = "1 run" if probe_map.runs == 1 else f"{probe_map.runs} runs"
    return [
        ("map", f"{len(probe_map)} directions, {runs}"),
        ("delay tau", f"{number(delay.tau_ms)} ms ({source})"),
        ("common radius W", f"{number(probe_map.sign * done.target_um, 5)} µm"),
        ("V_r before", before),
        ("V_r predicted", f"{predicted}, mean of {runs}"),
        ("feeds", f"{feeds}, before {_span(done)} mm/min"),
        ("longer approaches", f"{PER_CENT * done.time_increase:+.2f} %"),
        *_times_rows(done.times),
    ]


def _times_rows(times: Times | None) -> list[tuple[str, str]]:
    if times is None:
        return []
    touch = f"{times.touch_least_s:.3f} … {times.touch_greatest_s:.3f} s"
    return [
        ("one approach t_s", f"{touch}, before {times.touch_before_s:.3f} s"),
        ("all approaches t_M", f"{times.total_s:.3f} s, before {times.total_before_s:.3f} s"),
    ]


def _span(done: Compensation) -> str:
    low, high = done.before_mm_min.min(), done.before_mm_min.max()
    return f"{low:g}" if low == high else f"{low:.2f} … {high:.2f}"


def _figures_text(found: ProbeFigures) -> str:
    lines = [repeatability_line(found), *lobes_lines(found)]
    return "\n".join([*lines, table(FORM_HEADER, form_rows(found))])


def lobes_lines(found: ProbeFigures) -> list[str]:
    """Say how large three lobes are, wherever the artefact stood; nothing where none are told."""
    if (lobes := found.lobes) is None:
        return []
    off_um = ", ".join(f"{x} {um:+.2f}" for x, um in zip("XYZ", lobes.off_centre_um, strict=True))
    amplitude = f"{lobes.amplitude_um:.2f} µm ({lobes.low_um:.2f} … {lobes.high_um:.2f})"
    where = f"a crest at {lobes.azimuth_deg:.1f}°; the best-fit centre is off by {off_um} µm"
    return [f"three lobes: amplitude {amplitude}, {where}"]


def repeatability_line(found: ProbeFigures) -> str:
    """Say how well touches of one direction repeat."""
    if found.repeatability_um is None or found.worst_range_um is None:
        return "repeatability: unknown, there is a single run"
    return (
        f"repeatability of one touch: {number(found.repeatability_um, 3)} µm standard deviation; "
        f"largest range in one direction {number(found.worst_range_um, 3)} µm"
    )


def form_rows(found: ProbeFigures) -> list[tuple[str, ...]]:
    """Give a row for each ring and one for the sphere."""
    everything = [*found.rings, *([found.sphere] if found.sphere else [])]
    return [_form_row(form) for form in everything]


def _form_row(form: Form) -> tuple[str, ...]:
    name = "sphere" if form.beta_deg is None else f"ring, β {form.beta_deg:g}°"
    figures = (form.mean_um, form.fitted_um, form.worst_run_um, form.all_um)
    return (name, str(form.points), *(f"{figure:.2f}" for figure in figures))


def budget_rows(budget: Budget) -> list[tuple[str, ...]]:
    """Give a row for each source."""
    return [
        (
            part.name,
            part.kind,
            part.distribution,
            number(part.uncertainty, 3),
            part.unit,
            number(part.sensitivity, 3),
            f"{part.contribution_um:.3f}",
        )
        for part in budget.parts
    ]


def budget_line(budget: Budget, drawn: MonteCarlo) -> str:
    """Sum the budget up, beside the Monte Carlo."""
    freedom = "∞" if math.isinf(budget.freedom) else f"{budget.freedom:.0f}"
    return (
        f"combined {budget.combined_um:.3f} µm ({freedom} degrees of freedom), "
        f"U = {budget.expanded_um:.3f} µm (k = {COVERAGE:g}); "
        f"Monte Carlo: standard deviation {drawn.touch_deviation_um:.3f} µm"
    )


def simulated_rows(drawn: MonteCarlo) -> list[tuple[str, ...]]:
    """Give a row for each figure that only the Monte Carlo has an interval of."""
    rows: list[tuple[str, ...]] = [
        ("V_r before, of a new map, µm", *with_interval(drawn.vr_before_um)),
        ("V_r with the table, µm", *with_interval(drawn.vr_after_um)),
        ("worst single run with the table, µm", *with_interval(drawn.vr_single_run_um)),
    ]
    if drawn.tau_ms is not None:
        rows.append(("delay tau, ms", *with_interval(drawn.tau_ms)))
    return rows


def notes(done: Compensation, known: Uncertainty) -> list[str]:
    """Say what the figures leave out."""
    said = []
    if done.probe_map.runs == 1:
        said.append(
            "One run says nothing of random error: unless --repeatability is given, V_r predicted "
            "is its systematic part only."
        )
    if known.monte_carlo.failed:
        said.append(
            f"In {known.monte_carlo.failed} draws no table could be made, because a feed would "
            "have had to be 0 or less; they are left out."
        )
    return said


def as_json(
    done: Compensation, found: ProbeFigures, known: Uncertainty, after: ProbeFigures | None
) -> dict[str, Any]:
    """Everything, in plain types."""
    drawn = known.monte_carlo
    return {
        "format": "skiplatch-compensation/1",
        "tau_ms": done.delay.tau_ms,
        "tau_uncertainty_ms": done.delay.uncertainty_ms,
        "vr_before_um": done.vr_before_um,
        "vr_predicted_um": drawn.vr_after_um.value,
        "feed_min_mm_min": float(done.feed_mm_min.min()),
        "feed_max_mm_min": float(done.feed_mm_min.max()),
        "time_increase": done.time_increase,
        "times": None if done.times is None else asdict(done.times),
        "directions": len(done.probe_map),
        "runs": done.probe_map.runs,
        "target_um": done.probe_map.sign * done.target_um,
        "vr_before_expanded_um": known.vr_before_expanded_um,
        "vr_predicted_interval_um": _pair(drawn.vr_after_um),
        "vr_systematic_um": done.vr_systematic_um,
        "vr_single_run_predicted_um": asdict(drawn.vr_single_run_um),
        "probe": asdict(found),
        "after": None if after is None else asdict(after),
        "budget": {
            "combined_um": known.budget.combined_um,
            "expanded_um": known.budget.expanded_um,
            "freedom": _finite(known.budget.freedom),
            "parts": [
                asdict(part)
                | {"freedom": _finite(part.freedom), "contribution_um": part.contribution_um}
                for part in known.budget.parts
            ],
        },
        "monte_carlo": {
            "draws": drawn.draws,
            "failed": drawn.failed,
            "touch_deviation_um": drawn.touch_deviation_um,
            "vr_before_um": asdict(drawn.vr_before_um),
            "vr_after_um": asdict(drawn.vr_after_um),
            "tau_ms": None if drawn.tau_ms is None else asdict(drawn.tau_ms),
        },
        "notes": notes(done, known),
    }


def _pair(interval: Interval) -> list[float]:
    return [interval.low, interval.high]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
