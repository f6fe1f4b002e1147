"""Effects that were found, as they are reported: sizes, intervals, when they act."""

from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.diagnosis.candidates.axes import idle
from skiplatch.diagnosis.candidates.surrogates import SWITCHES, highest, turn_of
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.belief_spread import beside_beliefs
from skiplatch.diagnosis.fit.beliefs import Belief
from skiplatch.diagnosis.fit.intervals import estimates
from skiplatch.diagnosis.fit.weighted_samples import Cloud
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.verdict.reliability import reliability
from skiplatch.simulator.effects import Effect, Parameter, effects
from skiplatch.span import Span

MOST_OF_RANGE = 0.9
"""Share of a range that an interval leaves open, from which on it tells nothing."""
TURNS_SEEN = 1.5
"""Periods of a wave that positions have to show: half of it comes again."""


@dataclass(frozen=True, slots=True)
class Named:
    """An effect that was found."""

    effect: Effect
    stage: str
    intervals: Mapping[str, tuple[float, float]]
    """Of 90 %, the other parameters being as open."""
    alternatives: tuple[str, ...]
    confidence: float
    at_limit: frozenset[str] = frozenset()
    """Parameters at an end of their range."""
    when: str = ""
    """Since or until which touch it acts, in words; empty for one that always does."""
    idle: frozenset[str] = frozenset()
    """Parameters by which no touch of the campaign differs, or none that one datum has."""
    cloud: Cloud | None = None
    """Samples of its parameters, in their order; those of all effects have the same points."""


def named(
    scene: Scene, finding: Finding, beliefs: Sequence[Belief], executor: Executor | None = None
) -> list[Named]:
    """Give the effects of a finding on a scene; none if nothing was found.

    Args:
        scene: The touches, under the chain with the beliefs where they fit.
        finding: What was found.
        beliefs: As they stand in nominal.toml.
        executor: Works on the intervals side by side.
    """
    if finding.model is None:
        return []
    fit = finding.model.fit
    found = []
    alone = estimates(scene, fit, as_effects(fit), executor)
    for i, estimate in enumerate(beside_beliefs(scene, fit, alone, beliefs)):
        effect, candidate = estimate.effect, fit.candidates[i]
        taken_up = {candidate.names[number] for number in candidate.taken_up(scene)}
        moves_nothing = idle(scene.touches, effect) | taken_up
        one = Named(
            effect=effect,
            stage=effects()[effect.id].stage,
            intervals={**estimate.intervals, **_anywhere(effect, moves_nothing | _unset(effect))},
            alternatives=finding.alternatives[i],
            confidence=finding.confidences[i],
            at_limit=_at_limit(effect) | _unrepeated(scene, effect),
            when=_when(scene, effect.span),
            idle=moves_nothing,
            cloud=estimate.cloud,
        )
        found.append(one)
    return found


def _anywhere(effect: Effect, names: Collection[str]) -> dict[str, tuple[float, float]]:
    """Give the range of each parameter of which the touches tell nothing."""
    parameters = effects()[effect.id].parameters
    return {p.name: (p.low, p.high) for p in parameters if p.name in names}


def _unset(effect: Effect) -> frozenset[str]:
    """Name the places in a period that are left open: 0 says that none is told."""
    names = (p.name for p in effects()[effect.id].parameters if turn_of(p))
    return frozenset(name for name in names if effect.parameters[name] == 0.0)


def _when(scene: Scene, span: Span) -> str:
    """Say when an effect begins or ends: by the touch, and the time of it in the campaign."""

    def at(touch: int) -> str:
        (row,) = np.flatnonzero(scene.touches.touch == touch)[:1]
        return f"touch {touch}, at {scene.touches.time_s[row]:.6g} s"

    words = [] if span.since is None else [f"since {at(span.since)}"]
    return ", ".join(words if span.until is None else [*words, f"until {at(span.until)}"])


def _at_limit(effect: Effect) -> frozenset[str]:
    """Name the sizes that stand where their search ends; no angle does, none, or all."""

    def is_end(p: Parameter) -> bool:
        value = effect.parameters[p.name]
        is_all = p.unit == "1" and value == 1.0
        is_natural = value == 0.0 or is_all or p.unit == "deg" or p.name in SWITCHES
        return value in (p.low, p.high, highest(effect.id, p)) and not is_natural

    return frozenset(p.name for p in effects()[effect.id].parameters if is_end(p))


def _unrepeated(scene: Scene, effect: Effect) -> frozenset[str]:
    """Name the period of a wave that the positions do not show again: any smooth curve has one."""
    period_mm = effect.parameters.get("period_mm", 0.0)
    seen_mm = scene.latched_mm[~np.isnan(scene.latched_mm)]
    is_seen = not period_mm or (len(seen_mm) and np.ptp(seen_mm) >= TURNS_SEEN * period_mm)
    return frozenset() if is_seen else frozenset({"period_mm"})


def open_sizes(one: Named) -> list[str]:
    """Name the sizes of which the interval leaves open most of the range."""
    found = []
    for p in effects()[one.effect.id].parameters:
        low, high = one.intervals[p.name]
        if one.effect.parameters[p.name] and high - low >= MOST_OF_RANGE * (p.high - p.low):
            found.append(p.name)
    return found


def is_vague(one: Named) -> bool:
    """Tell whether most of the sizes that an effect has may be anything."""
    return 2 * len(open_sizes(one)) > sum(map(bool, one.effect.parameters.values()))


def sure(one: Named, standing: str) -> Named:
    """Give the confidence in an effect the share of those of its standing that are right."""
    share = reliability(standing)
    return replace(one, confidence=one.confidence * share)
