"""Candidates for effects that have no surrogate: their row in the simulator's table is enough.

The campaign's conditions are played with and without the effect, with the same random numbers, so
that the difference of two plays is what the effect does to each touch and nothing else.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

import numpy as np
import scipy

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.played_changes import changed
from skiplatch.diagnosis.candidates.surrogates import Parameters
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import EffectDescription, Parameter, effects
from skiplatch.span import ALWAYS, Span

STARTS = 24
"""Points over the ranges of the parameters, for each of up to two of these."""
DECADES = 4.0
"""Of sizes below the largest admitted one, where a range has no smallest."""
DIGITS = 5
"""To which parameters are told apart, so that no play is repeated."""
MOST_PLAYED = 4_000
"""Touches; of a larger campaign only the part is played that was drawn from it."""


@dataclass(frozen=True, slots=True)
class Simulated(Candidate):
    """An effect whose every change is played."""

    def __reduce__(self) -> tuple[Callable[[str, Span], Candidate], tuple[str, Span]]:
        """Travel to another process as the id and the span alone."""
        return _simulated_at, (self.id, self.span)


def catalogue() -> Mapping[str, Candidate]:
    """Give a candidate for every effect of the simulator's table, by id."""
    own = {name: simulated(name) for name in effects() if name not in CANDIDATES}
    return {**CANDIDATES, **own}


def _simulated_at(effect_id: str, span: Span) -> Candidate:
    always = simulated(effect_id)
    return always if span == ALWAYS else replace(always, span=span)


@cache
def simulated(effect_id: str) -> Candidate:
    """Make a candidate of a row of the table alone."""
    row = effects()[effect_id]
    starts = _starts(row.parameters)

    def change(scene: Scene, values: Parameters) -> Change:
        admitted = tuple(admitted_values(row, values).values())
        # What an effect does to a touch may depend on those before it.
        played, chosen = scene.in_sequence(MOST_PLAYED)
        return _selected(changed(played, effect_id, admitted), chosen)

    def applies(scene: Scene) -> bool:
        return scene.is_machine or row.stage not in ("probe", "link")

    return Simulated(
        id=effect_id,
        change=change,
        starts=lambda _scene, _given: starts,
        applies=applies,
    )


def admitted_values(
    row: EffectDescription, values: Sequence[float] | Parameters
) -> dict[str, float]:
    """Bring parameters that a search came upon into their ranges; by name."""
    return {
        parameter.name: _admitted(parameter, float(value))
        for parameter, value in zip(row.parameters, values, strict=True)
    }


def _admitted(parameter: Parameter, value: float) -> float:
    if parameter.unit == "deg":
        value = parameter.low + (value - parameter.low) % (parameter.high - parameter.low)
    elif parameter.low >= 0.0:
        value = abs(value)
    return float(np.clip(float(f"{value:.{DIGITS}g}"), parameter.low, parameter.high))


def _starts(parameters: Sequence[Parameter]) -> list[list[float]]:
    """Spread points evenly over the ranges, sizes on a logarithmic scale."""
    if not parameters:
        return [[]]
    count = STARTS * min(len(parameters), 2)
    points = scipy.stats.qmc.Halton(len(parameters), scramble=False).random(count + 1)[1:]
    return [[_start(p, u) for p, u in zip(parameters, point, strict=True)] for point in points]


def _start(parameter: Parameter, share: float) -> float:
    """Give the value a share of the way through a range; never 0, where a search would stay."""
    low, high = parameter.low, parameter.high
    if parameter.unit == "deg":
        return low + share * (high - low)
    if low < 0.0 < high:
        end = low if share < 0.5 else high
        return float(end * 10.0 ** (-DECADES * (1.0 - 2.0 * share % 1.0)))
    near, far = (low, high) if abs(low) < abs(high) else (high, low)
    near = near or far * 10.0**-DECADES
    return float(near * (far / near) ** share)


def _selected(change: Change, chosen: IndexArray) -> Change:
    """Give the part of a change that belongs to some of the touches."""

    def part(value: FloatArray | float) -> FloatArray | float:
        return value[chosen] if isinstance(value, np.ndarray) else value

    parts: dict[str, Any] = {}
    for field in fields(change):
        value = getattr(change, field.name)
        if isinstance(value, tuple):
            parts[field.name] = tuple(replace(e, sigma=part(e.sigma)) for e in value)
        elif isinstance(value, np.ndarray):
            parts[field.name] = value[chosen]
    return replace(change, **parts)
