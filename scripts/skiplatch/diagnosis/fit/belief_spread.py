"""What the uncertainty of beliefs leaves open of the parameters of effects."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.surrogates import turn_of
from skiplatch.diagnosis.fit.beliefs import Belief, believing, value_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.intervals import Estimate, settled
from skiplatch.diagnosis.fit.surface import CONFIDENCE
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects

NORMAL = float(scipy.special.ndtri((1.0 + CONFIDENCE) / 2.0))
SEED = 1
A_FALL = 2.0
"""Nats, of both ways together, up to which a likelihood falls as a normal law does."""
SEEN = 0.2
"""Nats from which on it is seen to fall."""
ROUNDS = 8
"""In which a step is found that costs so much, and no more."""


def beside_beliefs(
    scene: Scene, found: Fit, estimated: Sequence[Estimate], beliefs: Sequence[Belief]
) -> list[Estimate]:
    """Let what parameters of effects may be depend on what beliefs may be.

    Beliefs stay where they are unless that costs too much: what is likelier is in the intervals.

    Args:
        scene: The touches, under the chain with the beliefs where they stand.
        found: The effects, as they were fitted.
        estimated: The same, settled, with what each parameter may be beside just that chain.
        beliefs: As they stand in nominal.toml.
    """
    values = tuple(np.array(list(one.effect.parameters.values())) for one in estimated)
    settled_there = replace(found, parameters=values)
    # Noise moves hardly any parameter.
    moved = [_moved(scene, settled_there, belief) for belief in beliefs if not belief.is_noise]
    if not moved:
        return list(estimated)
    ends = np.cumsum([len(one) for one in values])[:-1]
    shifts, spreads = (np.split(np.array(rows), ends, axis=1) for rows in zip(*moved, strict=True))
    points = max((len(one.cloud.points) for one in estimated if one.cloud), default=0)
    drawn = np.random.default_rng(SEED).standard_normal((points, len(moved)))
    return [_widened(*one, drawn) for one in zip(estimated, shifts, spreads, strict=True)]


def _widened(one: Estimate, shifts: FloatArray, spreads: FloatArray, drawn: FloatArray) -> Estimate:
    """Move the interval by the likelier values of beliefs, and widen it by what these may be.

    Args:
        one: The effect.
        shifts: Shape (beliefs, p).
        spreads: Standard deviations, shape (beliefs, p).
        drawn: Normal ones, of each belief for each point.
    """
    table = effects()[one.effect.id].parameters
    value = np.array(list(one.effect.parameters.values()))
    ends, off = np.array(list(one.intervals.values())), shifts.sum(axis=0)
    half = NORMAL * np.sqrt(np.sum(spreads**2, axis=0))
    least = [-np.inf if turn_of(p) else p.low for p in table]
    most = [np.inf if turn_of(p) else p.high for p in table]
    low = value + np.minimum(off - np.hypot(value - ends[:, 0], half), 0.0)
    high = value + np.maximum(off + np.hypot(ends[:, 1] - value, half), 0.0)
    low, high = np.clip(low, least, most), np.clip(high, least, most)
    intervals = dict(zip(one.intervals, zip(low.tolist(), high.tolist(), strict=True), strict=True))
    if one.cloud is None:
        return replace(one, intervals=intervals)
    points = np.clip(one.cloud.points + off + drawn @ spreads, least, most)
    return replace(one, intervals=intervals, cloud=replace(one.cloud, points=points))


def _moved(scene: Scene, found: Fit, belief: Belief) -> tuple[FloatArray, FloatArray]:
    """Give what a belief moves parameters by, shape (p,): to its mean, and by its deviation there.

    By touches and belief together, whose law is taken for a normal one; the parameters are fitted
    anew beside each value (GUM, section 5.1).
    """
    place = belief.uncertainties(value_of(scene.nominal, belief.key))
    _, here = _beside(scene, found, belief, place)

    def across(step: float) -> tuple[FloatArray, float, float]:
        """Give half of what differs between both sides, parameters and nats; and what nats fall."""
        above, up = _beside(scene, found, belief, place + step)
        below, down = _beside(scene, found, belief, place - step)
        return (above - below) / 2.0, (up - down) / 2.0, 2.0 * here - up - down

    step, cheap, dear = 1.0, 0.0, np.inf
    moved, rise, fall = across(step)
    for _ in range(ROUNDS):
        cheap, dear = (cheap, step) if fall > A_FALL else (step, dear)
        if cheap and (fall > SEEN or np.isinf(dear)):
            break
        step = float(np.sqrt(cheap * dear)) if cheap else step / float(np.sqrt(fall))
        moved, rise, fall = across(step)
    fall = max(fall, step**2)  # no less sharp than by the belief's own law
    farthest = dear / step
    mean, deviation = np.clip(rise / fall, -farthest, farthest), min(1.0 / np.sqrt(fall), farthest)
    return moved * mean, moved * deviation


def _beside(scene: Scene, found: Fit, belief: Belief, place: float) -> tuple[FloatArray, float]:
    """Fit parameters, shape (p,), beside a belief so many uncertainties away; and give the nats."""
    nominal = believing(scene.nominal, {belief.key: belief.moved(place)})
    there = scene.with_nominal(nominal)
    fit = settled(there, found)
    nats = likelihood(there, fit.change(there)).total
    return np.concatenate(fit.parameters), nats - 0.5 * place**2
