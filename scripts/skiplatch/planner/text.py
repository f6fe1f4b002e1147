"""A plan, or why there is none, in words and in JSON."""

import math
from dataclasses import asdict
from typing import Any

from skiplatch.latch.text import TITLES
from skiplatch.planner.model import (
    Limits,
    Strategy,
    cycle_s,
    overtravel_mm,
    range_um,
    standard_uncertainty_um,
)
from skiplatch.planner.obstacles import Obstacle
from skiplatch.planner.plan import Plan
from skiplatch.planner.search import Findings
from skiplatch.planner.trial import Trial
from skiplatch.tables import number, table, whole

TO_STANDARD = 1.0 / math.sqrt(12.0)  # of a full range in which all is equally likely


def as_text(plan: Plan) -> str:
    """Everything, for the terminal."""
    wish = (
        f"wanted on the {TITLES[plan.limits.path]}: a full range of {plan.wanted_um:g} µm, "
        f"which is a standard uncertainty of {number(plan.wanted_um * TO_STANDARD, 3)} µm"
    )
    if plan.best is None or plan.trial is None:
        return f"{wish}\n\n{_refusal(plan.findings)}"
    return "\n\n".join(
        [
            wish,
            _settings(plan.best),
            _outcome(plan, plan.best, plan.trial),
            _reason(plan, plan.best),
            _verdict(plan, plan.trial),
        ]
    )


def as_json(plan: Plan) -> dict[str, Any]:
    """Everything, in plain types."""
    return {
        "format": "skiplatch-plan/1",
        "path": plan.limits.path.name.lower(),
        "wanted_um": plan.wanted_um,
        "wanted_standard_um": plan.wanted_um * TO_STANDARD,
        "feasible": plan.best is not None,
        "best": _found_json(plan, plan.best) if plan.best else None,
        "one_touch": _found_json(plan, plan.findings.one),
        "two_touches": _found_json(plan, plan.findings.two),
        "simulated": _trial_json(plan, plan.trial) if plan.trial else None,
    }


def _found_json(plan: Plan, found: Strategy | Obstacle) -> dict[str, Any]:
    if isinstance(found, Obstacle):
        return {"allowed": False, **asdict(found)}
    return {"allowed": True, **asdict(found), "model": _model(plan.limits, found)}


def _model(limits: Limits, strategy: Strategy) -> dict[str, float | None]:
    feed, fast = strategy.measuring_feed_mm_min, strategy.fast_feed_mm_min
    return {
        "range_um": range_um(limits, feed),
        "standard_uncertainty_um": standard_uncertainty_um(limits, feed),
        "cycle_s": cycle_s(limits, strategy),
        "overtravel_mm": overtravel_mm(limits, feed),
        "fast_overtravel_mm": None if fast is None else overtravel_mm(limits, fast),
    }


def _trial_json(plan: Plan, trial: Trial) -> dict[str, Any]:
    return {**asdict(trial), "confirmed": trial.confirms(plan.limits, plan.wanted_um)}


def _settings(strategy: Strategy) -> str:
    measuring = f"measuring feed {strategy.measuring_feed_mm_min:g} mm/min"
    if strategy.fast_feed_mm_min is None:
        return f"one touch: {measuring}"
    return (
        f"two touches: fast feed {strategy.fast_feed_mm_min:g} mm/min, back-off "
        f"{strategy.back_off_mm:g} mm, {measuring}"
    )


def _outcome(plan: Plan, best: Strategy, trial: Trial) -> str:
    model = _model(plan.limits, best)
    simulated = (
        trial.range_um,
        trial.standard_uncertainty_um.value,
        trial.cycle_s.value,
        trial.overtravel_mm,
        trial.fast_overtravel_mm,
    )
    names = (
        "full range, µm",
        "standard uncertainty, µm",
        "mean cycle, s",
        "overtravel at most, mm",
        "overtravel of the fast touch, mm",
    )
    rows = [
        (name, number(expected), number(found))
        for name, expected, found in zip(names, model.values(), simulated, strict=True)
        if expected is not None and found is not None
    ]
    return table(("", "model", f"{whole(trial.cycles)} cycles simulated"), rows)


def _reason(plan: Plan, best: Strategy) -> str:
    one, two = plan.findings.one, plan.findings.two
    if isinstance(one, Obstacle):
        return one.message
    one_s = number(cycle_s(plan.limits, one), 3)
    if best is one:
        rest = two.message if isinstance(two, Obstacle) else _slower(plan.limits, two)
        return f"one touch at {one.measuring_feed_mm_min:g} mm/min needs {one_s} s; {rest}"
    best_s = number(cycle_s(plan.limits, best), 3)
    return (
        f"one touch would have to crawl at {one.measuring_feed_mm_min:g} mm/min: {one_s} s; "
        f"two touches need {best_s} s"
    )


def _slower(limits: Limits, two: Strategy) -> str:
    return f"two touches would need {number(cycle_s(limits, two), 3)} s"


def _verdict(plan: Plan, trial: Trial) -> str:
    if trial.confirms(plan.limits, plan.wanted_um):
        return "confirmed by simulation: all cycles within what is wanted and allowed"
    return "NOT CONFIRMED: the simulation exceeds what is wanted or allowed"


def _refusal(findings: Findings) -> str:
    obstacles = dict.fromkeys(
        found for found in (findings.one, findings.two) if isinstance(found, Obstacle)
    )
    return "\n".join(
        f"not possible, {obstacle.limit}: {obstacle.message}\nwhat would do: {obstacle.remedy}"
        for obstacle in obstacles
    )
