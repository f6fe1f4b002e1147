"""Baseline: regress every residual on every covariate, and name what the clearest one means."""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from skiplatch.campaign import Campaign, Kind
from tests.withheld.chain import FloatArray
from tests.withheld.covariates import FEWEST, covariates, on_path
from tests.withheld.simulated import recorded_residuals

FALSE_ALARMS = 1e-3
"""Of a campaign without an effect, shared out evenly among all tests."""
CONSTANT = "constant"
MOST_LOST = 0.002


@dataclass(frozen=True, slots=True)
class Rule:
    """If this residual goes with this covariate, then it is this effect.

    Attributes:
        stream: Of the residuals.
        path: ``skip``, ``plc`` or ``both``.
        covariate: Its name, or CONSTANT for a mean other than 0.
        machine: The effect on a machine.
        bench: The effect on a bench, or None if a bench cannot have it.
    """

    stream: str
    path: str
    covariate: str
    machine: str
    bench: str | None = None


_FILTER = "input_filter"
# In the order in which equally clear ones are taken.
RULES = (
    Rule("report", "both", CONSTANT, "report_delay", "report_delay"),
    Rule("latch", "both", "time", "timer_drift", "timer_drift"),
    Rule("latch", "both", "travel", "feed_error"),
    Rule("latch", "both", CONSTANT, "trigger_delay", _FILTER),
    Rule("latch", "skip", CONSTANT, "isr_latency", "isr_latency"),
    Rule("latch", "plc", CONSTANT, "scan_period", "scan_period"),
    Rule("position", "both", "speed", "following_error", "following_error"),
    *(
        Rule(stream, "both", covariate, effect)
        for stream in ("position", "deviation")
        for covariate, effect in (
            ("sense", "backlash"),
            ("place", "scale_error"),
            ("warmth", "thermal_drift"),
            ("cos 3α", "pretravel_lobing"),
            ("sin 3α", "pretravel_lobing"),
            ("table along", "rotary_pivot"),
            ("table across", "rotary_pivot"),
            ("approach", "unfinished_acceleration"),
        )
    ),
    Rule("deviation", "both", "speed", "trigger_delay", _FILTER),
    Rule("deviation", "skip", CONSTANT, "isr_latency", "isr_latency"),
    Rule("deviation", "plc", CONSTANT, "scan_period", "scan_period"),
)


class Regression:
    """Names the effect whose covariate is the most significant."""

    title = "regression"

    def name(self, campaign: Campaign) -> str | None:
        """Name the effect, or None."""
        if campaign.touches.missed.mean() > MOST_LOST:
            return "lost_trigger"
        found = recorded_residuals(campaign.nominal, campaign.touches)
        given = covariates(campaign)
        constant = np.ones(len(campaign.touches))
        clearest, named = 0.0, None
        for rule in RULES:
            effect = rule.machine if campaign.nominal.kind is Kind.MACHINE else rule.bench
            if effect is None:
                continue
            paths = ("skip", "plc") if rule.path == "both" else (rule.path,)
            masks = [on_path(campaign.touches, path) for path in paths]
            clear = min(
                _clearness(found[rule.stream][m], given.get(rule.covariate, constant)[m])
                for m in masks
            )
            if clear > clearest:
                clearest, named = clear, effect
        limit = -np.log(FALSE_ALARMS / len(RULES))
        return named if clearest > limit else None


def _clearness(values: FloatArray, given: FloatArray) -> float:
    """Give −ln p of a slope, or of a mean if the covariate is constant; never infinite."""
    known = ~(np.isnan(values) | np.isnan(given))
    values, given = values[known], given[known]
    if len(values) < FEWEST or values.std() == 0.0:
        return 0.0
    if np.all(given == 1.0):
        t = values.mean() / values.std(ddof=1) * np.sqrt(len(values))
        freedom = len(values) - 1
    else:
        if np.ptp(given) == 0.0:
            return 0.0
        r = float(np.corrcoef(values, given)[0, 1])
        freedom = len(values) - 2
        t = r * np.sqrt(freedom / max(1.0 - r**2, 1e-12))
    return float(-np.log(2.0) - stats.t.logsf(abs(t), freedom))
