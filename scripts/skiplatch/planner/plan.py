"""From a wish to a plan that was tried out."""

from dataclasses import dataclass

from skiplatch.latch.effort import Effort
from skiplatch.planner.model import Limits, Strategy
from skiplatch.planner.search import Findings, find_plan
from skiplatch.planner.trial import Trial, try_out


@dataclass(frozen=True, slots=True)
class Plan:
    """What was found for a wish, and how the best of it did."""

    limits: Limits
    wanted_um: float
    findings: Findings
    best: Strategy | None
    trial: Trial | None
    """None where nothing is allowed."""


def make_plan(limits: Limits, wanted_um: float, effort: Effort) -> Plan:
    """Find the fastest strategy whose full range is no greater than wanted, and try it out."""
    findings = find_plan(limits, wanted_um)
    best = findings.best(limits)
    trial = try_out(limits, best, effort) if best else None
    return Plan(limits, wanted_um, findings, best, trial)
