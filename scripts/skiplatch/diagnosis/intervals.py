"""Parameters with their uncertainty: what the touches leave open, all parameters together.

Widths of boxes and steps of grids make a likelihood with corners, where neither a curvature nor a
fixed fall from the peak covers what it should. So the likelihood itself is taken for a density over
the parameters, each within its range, and sampled with weights: quantiles of one parameter then
have all the others free, and are right for corners and for bells alike.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import Fit
from skiplatch.diagnosis.surrogates import highest
from skiplatch.simulator import Effect, Parameter, effects

IndexArray = NDArray[np.intp]

CONFIDENCE = 0.9
FALL = float(stats.chi2.ppf(CONFIDENCE, 1)) / 2.0
"""Nats from the peak to the end of the interval of a parameter that stands at an end."""
A_STEP = 1.0
"""Nats from the peak that make a step, of somewhat more than a standard deviation."""
FIRST_STEP = 1e-3  # of the value
SMALLEST_STEP = 1e-13
STRIDE = 8.0
CLIMBS = 25  # evaluations, a parameter
DEGREES_OF_FREEDOM = 5  # of the sampled distribution, whose tails reach beyond those sought
ROUNDS = (60, 60, 60, 240)
FEW = 3
"""Parameters that as many samples are enough for; for more they are multiplied."""
LEAST_SAMPLES = 4.0  # a parameter, that have to count in effect
TEMPERS = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)
INFLATION = 1.5
RIDGE = 1e-8  # of all variances, so that no direction is quite without one
OFF_THE_TOP = 1.0  # nats that the mean may lie below the peak
ANYWHERE = 0.8  # of its turn, from which on nothing is known of an angle
WORST = -1e300
SEED = 1


@dataclass(frozen=True, slots=True)
class Estimate:
    """An effect with its parameters and what each may be; 90 %, in the parameters' units."""

    effect: Effect
    intervals: Mapping[str, tuple[float, float]]
    """Within the range of the table; but an angle may pass the end of its turn."""


@dataclass(frozen=True, slots=True)
class _Slot:
    """One parameter of one of the effects."""

    effect_id: str
    parameter: Parameter
    value: float

    @property
    def low(self) -> float:
        return self.value - self.turn / 2.0 if self.turn else self.parameter.low

    @property
    def high(self) -> float:
        if self.turn:
            return self.value + self.turn / 2.0
        return highest(self.effect_id, self.parameter)

    @property
    def turn(self) -> float:
        """After which an angle is the same again; 0 for what is no angle."""
        return self.parameter.high if self.parameter.unit == "deg" else 0.0

    @property
    def is_held(self) -> bool:
        """It stands at 0 or at an end, where a search has no use for it."""
        return self.value in (0.0, self.low, self.high)


class _Surface:
    """The log-likelihood over the parameters of all effects, within their ranges."""

    def __init__(self, scene: Scene, found: Fit, admitted: Sequence[Effect]) -> None:
        self._scene = scene
        self._found = found
        self.slots = [
            _Slot(effect.id, parameter, effect.parameters[parameter.name])
            for effect in admitted
            for parameter in effects()[effect.id].parameters
        ]
        self.values = np.array([slot.value for slot in self.slots])
        self._low = np.array([slot.low for slot in self.slots])
        self._high = np.array([slot.high for slot in self.slots])
        self._ends = np.cumsum([len(effect.parameters) for effect in admitted])[:-1]
        self.peak = self(self.values)

    def __call__(self, values: FloatArray) -> float:
        """Give the log-likelihood at parameters, shape (p,)."""
        if np.any(values < self._low) or np.any(values > self._high):
            return WORST
        parts = tuple(np.split(values, self._ends))
        model = Fit(self._found.candidates, parts, self._found.reached, self._found.slack)
        reached = self._found.reached
        total = likelihood(self._scene, model.change(self._scene), reached).total
        return total if np.isfinite(total) else WORST

    def climb(self, free: IndexArray, steps: FloatArray) -> None:
        """Go to the top: these touches need not be those of the fit."""

        def minus(moved: FloatArray) -> float:
            return -self.along(free, steps * moved)

        start: FloatArray = np.zeros(len(free))
        found = optimize.minimize(
            minus,
            start,
            method="Nelder-Mead",
            options={
                "initial_simplex": np.vstack([np.zeros(len(free)), np.eye(len(free))]),
                "maxfev": CLIMBS * len(free),
                "fatol": 0.02,
                "xatol": 0.02,
            },
        )
        if -found.fun > self.peak:
            self.values[free] += steps * found.x
            self.peak = -float(found.fun)

    def along(self, indices: IndexArray, moved: FloatArray) -> float:
        """Give it with some parameters moved."""
        values = self.values.copy()
        values[indices] += moved
        return self(values)

    def fall(self, moved: FloatArray) -> float:
        """Give by how much it falls where all parameters, shape (p,), are moved."""
        return self.peak - self(self.values + moved)


def estimates(scene: Scene, found: Fit, admitted: Sequence[Effect]) -> list[Estimate]:
    """Settle the parameters of effects on touches, and tell what each may be.

    Args:
        scene: The touches.
        found: The fit.
        admitted: The same effects, their parameters brought into the ranges of the table.
    """
    surface = _Surface(scene, found, admitted)
    free, steps = _free(surface)
    if len(free):
        surface.climb(free, steps)
        free, steps = _free(surface)
    values, low, high = surface.values.copy(), surface.values.copy(), surface.values.copy()
    if len(free):
        values[free], low[free], high[free] = _sampled(surface, free, steps)
    for i, slot in enumerate(surface.slots):
        if slot.is_held:
            low[i], high[i] = _reach(surface, i, -1.0), _reach(surface, i, 1.0)
    return _as_estimates(admitted, surface.slots, values, low, high)


def _as_estimates(
    admitted: Sequence[Effect],
    slots: Sequence[_Slot],
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
            parameters[slot.parameter.name] = value - turns
            ends[slot.parameter.name] = (float(low[i] - turns), float(high[i] - turns))
            if slot.turn and high[i] - low[i] > ANYWHERE * slot.turn:
                ends[slot.parameter.name] = (0.0, slot.turn)
            i += 1
        found.append(Estimate(Effect(effect.id, parameters), ends))
    return found


def _free(surface: _Surface) -> tuple[IndexArray, FloatArray]:
    """Give the parameters that are open, and steps that are worth `A_STEP` each."""
    free = np.array([i for i, slot in enumerate(surface.slots) if not slot.is_held], dtype=np.intp)
    units = np.eye(len(surface.slots))
    steps = np.array([_step(surface, units[i]) for i in free])
    return free[steps > 0.0], steps[steps > 0.0]


def _step(surface: _Surface, direction: FloatArray) -> float:
    """Give how far to go along a direction, shape (p,), for `A_STEP`; 0 for nowhere."""
    sizes = np.abs(surface.values[direction != 0.0])
    room = min(slot.high - slot.low for slot, d in zip(surface.slots, direction, strict=True) if d)
    step, least = FIRST_STEP * float(sizes.min()), SMALLEST_STEP * float(sizes.max())
    while _falls(surface, step * direction) > A_STEP:
        if step < least:
            return 0.0  # it is on a grid, exactly
        step /= STRIDE
    while step < room and _falls(surface, step * direction) < A_STEP:
        step *= 2.0
    return step


def _falls(surface: _Surface, moved: FloatArray) -> float:
    """What the likelihood falls to the gentler side: to the other there may be a cliff."""
    return min(surface.fall(moved), surface.fall(-moved))


def _reach(surface: _Surface, index: int, sense: float) -> float:
    """How far a parameter goes from an end, the others as they are."""
    slot, unit = surface.slots[index], np.eye(len(surface.slots))[index]
    room = (slot.high - slot.value) if sense > 0.0 else (slot.value - slot.low)
    if room <= 0.0 or surface.fall(sense * room * unit) <= FALL:
        return slot.value + sense * max(room, 0.0)
    step = room
    while step > SMALLEST_STEP * room and surface.fall(sense * step / 4.0 * unit) > FALL:
        step /= 4.0
    crossed = optimize.brentq(
        lambda s: surface.fall(sense * s * unit) - FALL, 0.0, step, rtol=1e-2, xtol=1e-2 * step
    )
    return slot.value + sense * float(crossed)


def _sampled(
    surface: _Surface, free: IndexArray, steps: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sample the free parameters, nearer to the likelihood each time: value, low, high."""
    rng = np.random.default_rng(SEED)
    middle = np.zeros(len(free))
    spread = _covariance(surface, free, steps)
    points, weights = np.zeros((1, len(free))), np.ones(1)
    more = int(np.ceil(len(free) / FEW))
    for size in more * np.array(ROUNDS):
        proposal = stats.multivariate_t(middle, spread, DEGREES_OF_FREEDOM, seed=rng)
        points = proposal.rvs(size).reshape(size, len(free))
        heights = np.array([surface.along(free, steps * point) for point in points])
        logs = heights - surface.peak - proposal.logpdf(points).reshape(size)
        weights = _weights(logs)
        calm = _weights(logs, LEAST_SAMPLES * (1 + len(free)))
        middle = calm @ points
        spread = INFLATION * np.cov(points.T, aweights=calm, ddof=0).reshape(len(free), len(free))
        spread += RIDGE * max(1.0, float(np.trace(spread))) * np.eye(len(free))
    ends = (1.0 - CONFIDENCE) / 2.0
    low, high = (_quantiles(points, weights, q) for q in (ends, 1.0 - ends))
    best = weights @ points  # on a plateau the middle is nearer to the truth than any peak
    if surface.peak - surface.along(free, steps * best) > OFF_THE_TOP:
        best = np.zeros(len(free))
    middle = surface.values[free]
    low, high = np.minimum(low, best), np.maximum(high, best)
    return middle + steps * best, middle + steps * low, middle + steps * high


def _covariance(surface: _Surface, free: IndexArray, steps: FloatArray) -> FloatArray:
    """Give a first guess, in units of the steps: how far each parameter goes, and pairs together.

    Two ends of a box are sharp each, but where one moves by as much as the other moves back, the
    likelihood may be level over far more.
    """
    units = np.eye(len(surface.slots))
    directions = [
        units[i] + sense * units[j]
        for i, j in combinations(free, 2)
        if surface.slots[i].parameter.unit == surface.slots[j].parameter.unit
        for sense in (1.0, -1.0)
    ]
    lengths = [_step(surface, direction) for direction in directions]
    moves = [length * d[free] / steps for length, d in zip(lengths, directions, strict=True)]
    return np.asarray(sum((np.outer(move, move) for move in moves), np.eye(len(free))))


def _weights(logs: FloatArray, least: float = 0.0) -> FloatArray:
    """Normalise weights, evened out until so many of them count."""
    weights = np.ones_like(logs)
    for temper in TEMPERS:
        weights = np.exp(temper * (logs - logs.max()))
        weights /= weights.sum()
        if 1.0 / np.sum(weights**2) >= least:
            break
    return weights


def _quantiles(points: FloatArray, weights: FloatArray, share: float) -> FloatArray:
    """Give a weighted quantile of each column; shape (p,)."""
    return np.array(
        [np.quantile(c, share, weights=weights, method="inverted_cdf") for c in points.T]
    )
