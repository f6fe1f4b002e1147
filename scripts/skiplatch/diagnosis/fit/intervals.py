"""Parameters with their uncertainty: what the touches leave open, all parameters together.

Widths of boxes and steps of grids make a likelihood with corners, where neither a curvature nor a
fixed fall from the peak covers what it should. So the likelihood itself is taken for a density over
the parameters, each within its range, and sampled with weights: quantiles of one parameter then
have all the others free, and are right for corners and for bells alike.

What a search left at 0, or brought to an end of its range, is held there at first, and then sampled
too: a jitter that is said to be none may be small, and the delay it comes with shorter by its mean.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.fit.as_effects import as_effects, rounded
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.surface import A_STEP, CONFIDENCE, Slot, Surface
from skiplatch.diagnosis.fit.weighted_samples import Cloud, sampled
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect

FALL = float(scipy.special.chdtri(1.0, 1.0 - CONFIDENCE)) / 2.0
"""Nats from the peak to the end of the interval of a parameter that stands at an end."""
FIRST_STEP = 1e-3  # of the value
SMALLEST_STEP = 1e-13
STRIDE = 8.0
CLIMBS = 3
"""At most, each from where the sampling has seen something higher."""
ANYWHERE = 0.8  # of its turn, from which on nothing is known of an angle
ROUNDED_US = 5e-4
"""By which the simulator may round a time, to a whole nanosecond."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """An effect with its parameters and what each may be; 90 %, in the parameters' units."""

    effect: Effect
    intervals: Mapping[str, tuple[float, float]]
    """Within the range of the table; but an angle may pass the end of its turn."""
    cloud: Cloud | None = None
    """Its parameters, a row a point; those of several effects have the same points."""


def settled(scene: Scene, found: Fit) -> Fit:
    """Climb to the parameters that touches show, from those of a fit, with steps that these show.

    What a search holds at 0, or at an end, stays there.
    """
    surface = Surface(scene, found, as_effects(found))
    free, steps = _free(surface, np.array([not slot.is_held for slot in surface.slots]))
    if not len(free):
        return found
    surface.climb(free, steps)
    return replace(found, parameters=surface.parts(surface.values))


def estimates(
    scene: Scene, found: Fit, admitted: Sequence[Effect], executor: Executor | None = None
) -> list[Estimate]:
    """Settle the parameters of effects on touches, and tell what each may be.

    Args:
        scene: The touches.
        found: The fit.
        admitted: The same effects, their parameters brought into the ranges of the table.
        executor: Samples side by side.
    """
    surface = Surface(scene, found, admitted, executor)
    held = np.array([slot.is_held for slot in surface.slots])
    values, low, high, cloud = _about(surface, ~held)
    for _ in range(CLIMBS):
        if not surface.rise():
            break
        values, low, high, cloud = _about(surface, ~held)
    cloud = _widen(surface, held, low, high) or cloud
    for i, slot in enumerate(surface.slots):
        rounded = ROUNDED_US if slot.parameter.unit == "µs" else 0.0
        low[i], high[i] = min(low[i], values[i] - rounded), max(high[i], values[i] + rounded)
    low, high = (np.clip(ends, surface.low, surface.high) for ends in (low, high))
    found_at = _as_estimates(admitted, surface.slots, values, low, high)
    return _with_clouds(found_at, surface.slots, cloud, values)


def _about(surface: Surface, asked: BoolArray) -> tuple[FloatArray, FloatArray, FloatArray, Cloud]:
    """Give values, what each that is asked for may be from and to, of shape (p,), and samples."""
    free, steps = _free(surface, asked)
    if len(free):
        surface.climb(free, steps)
    return sampled(surface, *_free(surface, asked))


def _widen(surface: Surface, held: BoolArray, low: FloatArray, high: FloatArray) -> Cloud | None:
    """Let go what is held, and move the ends, shape (p,), as far as that lets any of them.

    Gives the samples with that let go, if any was.
    """
    cloud = None
    closed = np.array([slot.is_switch or slot.is_taken_up for slot in surface.slots])
    free, steps = _free(surface, ~closed)
    if held[free].any():
        _, lower, higher, cloud = sampled(surface, free, steps)
        np.minimum(low, lower, out=low)
        np.maximum(high, higher, out=high)
    for i, slot in enumerate(surface.slots):
        if slot.is_held and not slot.is_taken_up and i not in free:
            low[i], high[i] = _reach(surface, i, -1.0), _reach(surface, i, 1.0)
            if slot.is_switch:
                low[i], high[i] = np.ceil(low[i]), np.floor(high[i])
    return cloud


def _as_estimates(
    admitted: Sequence[Effect],
    slots: Sequence[Slot],
    values: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> list[Estimate]:
    found, i = [], 0
    for effect in admitted:
        parameters, ends = {}, {}
        for _ in effect.parameters:
            slot, value = slots[i], float(values[i])
            turns = slot.turn * np.floor(value / slot.turn) if slot.turn else 0.0
            parameters[slot.parameter.name] = rounded(value - turns)
            ends[slot.parameter.name] = (float(low[i] - turns), float(high[i] - turns))
            if slot.turn and high[i] - low[i] > ANYWHERE * slot.turn:
                ends[slot.parameter.name] = (0.0, slot.turn)
            i += 1
        found.append(Estimate(replace(effect, parameters=parameters), ends))
    return found


def _with_clouds(
    found: Sequence[Estimate], slots: Sequence[Slot], cloud: Cloud, values: FloatArray
) -> list[Estimate]:
    """Give each effect the samples of its parameters, turned as they are."""
    turn = np.array([slot.turn for slot in slots])
    at = cloud.points - turn * np.floor(np.divide(values, turn, where=turn > 0.0, out=0.0 * values))
    with_clouds, begin = [], 0
    for one in found:
        end = begin + len(one.effect.parameters)
        own = frozenset(i - begin for i in cloud.sampled if begin <= i < end)
        with_clouds.append(replace(one, cloud=Cloud(at[:, begin:end], cloud.weights, own)))
        begin = end
    return with_clouds


def _free(surface: Surface, asked: BoolArray) -> tuple[IndexArray, FloatArray]:
    """Give the parameters, of those asked for, that are open, and steps worth `A_STEP` each.

    What is held and makes no difference all over its range is not among them.
    """
    steps = np.array([_step(surface, i) if wanted else 0.0 for i, wanted in enumerate(asked)])
    room = np.where([slot.is_held for slot in surface.slots], surface.high - surface.low, np.inf)
    free = np.flatnonzero((steps > 0.0) & (steps < room))
    return free, steps[free]


def _step(surface: Surface, index: int) -> float:
    """Give how far to move a parameter for `A_STEP`; 0 for nowhere."""
    unit = np.eye(len(surface.slots))[index]
    room = float(surface.high[index] - surface.low[index])
    size = abs(float(surface.values[index])) or room
    step = FIRST_STEP * size
    while _falls(surface, step * unit) > A_STEP:
        if step < SMALLEST_STEP * size:
            return 0.0  # it is on a grid, exactly
        step /= STRIDE
    while step < room and _falls(surface, step * unit) < A_STEP:
        step *= 2.0
    return step


def _falls(surface: Surface, moved: FloatArray) -> float:
    """What the likelihood falls to the gentler side: to the other there may be a cliff."""
    return min(surface.fall(moved), surface.fall(-moved))


def _reach(surface: Surface, index: int, sense: float) -> float:
    """How far a parameter goes from an end, the others as they are."""
    slot, unit = surface.slots[index], np.eye(len(surface.slots))[index]
    room = (slot.high - slot.value) if sense > 0.0 else (slot.value - slot.low)
    if room <= 0.0 or surface.fall(sense * room * unit) <= FALL:
        return slot.value + sense * max(room, 0.0)
    step = room
    while step > SMALLEST_STEP * room and surface.fall(sense * step / 4.0 * unit) > FALL:
        step /= 4.0
    crossed = scipy.optimize.brentq(
        lambda s: surface.fall(sense * s * unit) - FALL, 0.0, step, rtol=1e-2, xtol=1e-2 * step
    )
    return slot.value + sense * float(crossed)
