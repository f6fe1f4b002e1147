"""Parameters with their uncertainty: what the touches leave open, all parameters together.

Widths of boxes and steps of grids make a likelihood with corners, where neither a curvature nor a
fixed fall from the peak covers what it should. So the likelihood itself is taken for a density over
the parameters, each within its range, and sampled with weights: quantiles of one parameter then
have all the others free, and are right for corners and for bells alike.

What a search left at 0, or brought to an end of its range, is held there at first, and then sampled
too: a jitter that is said to be none may be small, and the delay it comes with shorter by its mean.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.as_effects import as_effects, rounded
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import Fit
from skiplatch.diagnosis.surrogates import SWITCHES, highest
from skiplatch.simulator.effects import Effect, Parameter, effects

IndexArray = NDArray[np.intp]

CONFIDENCE = 0.9
FALL = float(stats.chi2.ppf(CONFIDENCE, 1)) / 2.0
"""Nats from the peak to the end of the interval of a parameter that stands at an end."""
A_STEP = 1.0
"""Nats from the peak that make a step, of somewhat more than a standard deviation."""
FIRST_STEP = 1e-3  # of the value
SMALLEST_STEP = 1e-13
STRIDE = 8.0
LONGEST = 1e6  # steps along a ridge
CLIMBS = 3
"""At most, each from where the sampling has seen something higher."""
EVALUATIONS = 25  # of a climb, a parameter
DEGREES_OF_FREEDOM = 5  # of the sampled distribution, whose tails reach beyond those sought
ACROSS = 2e-9
"""Share of the largest variance by which every parameter varies at least, whatever others do: some
ten times what scipy takes for 0, by the largest eigenvalue."""
ROUNDS = (60, 60, 60, 240)
MORE_ROUNDS = 4
"""Of the size of the last one, at most, until enough samples count."""
ENOUGH = 60.0
BATCHES, BATCH = 50, 20
"""Tries, and draws a sample in each, to find samples within all ranges."""
FEW = 3
"""Parameters that as many samples are enough for; for more they are multiplied."""
LEAST_SAMPLES = 4.0  # a parameter, that have to count in effect
TEMPERS = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)
INFLATION = 1.5
RIDGE = 1e-8  # of all variances, so that no direction is quite without one
OFF_THE_TOP = 1.0  # nats that the mean may lie below the peak
ANYWHERE = 0.8  # of its turn, from which on nothing is known of an angle
WORST = -1e300
ROUNDED_US = 5e-4
"""By which the simulator may round a time, to a whole nanosecond."""
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
    is_taken_up: bool = False
    """The datum does what it does."""

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

    @property
    def is_switch(self) -> bool:
        return self.parameter.name in SWITCHES

    @property
    def shares(self) -> tuple[float, float]:
        """Shares of the density below each end of the interval; an end of the range ends it."""
        if self.value == self.low:
            return 0.0, CONFIDENCE
        if self.value == self.high:
            return 1.0 - CONFIDENCE, 1.0
        return (1.0 - CONFIDENCE) / 2.0, (1.0 + CONFIDENCE) / 2.0


class _Surface:
    """The log-likelihood over the parameters of all effects, within their ranges."""

    def __init__(self, scene: Scene, found: Fit, admitted: Sequence[Effect]) -> None:
        self._scene = scene
        self._found = found
        self._ends = np.cumsum([len(effect.parameters) for effect in admitted])[:-1]
        self.highest, self.top = np.zeros(0), np.inf
        self._stand_at(
            [
                _Slot(effect.id, parameter, effect.parameters[parameter.name], i in taken)
                for effect, candidate in zip(admitted, found.candidates, strict=True)
                for taken in [candidate.taken_up(scene)]
                for i, parameter in enumerate(effects()[effect.id].parameters)
            ]
        )

    def _stand_at(self, slots: Sequence[_Slot]) -> None:
        self.slots = slots
        self.values = np.array([slot.value for slot in slots])
        self.low = np.array([slot.low for slot in slots])
        self.high = np.array([slot.high for slot in slots])
        self.peak = self.top = self(self.values)

    def rise(self) -> bool:
        """Go to the highest point seen, if that is a step above this one."""
        if self.top < self.peak + A_STEP:
            return False
        values = self.highest.tolist()
        self._stand_at([replace(s, value=v) for s, v in zip(self.slots, values, strict=True)])
        return True

    def __call__(self, values: FloatArray) -> float:
        """Give the log-likelihood at parameters, shape (p,)."""
        if np.any(values < self.low) or np.any(values > self.high):
            return WORST
        reached = self._found.reached
        change = replace(self._found, parameters=self.parts(values)).change(self._scene)
        total = likelihood(self._scene, change, reached).total
        if total > self.top:
            self.top, self.highest = total, values
        return total if np.isfinite(total) else WORST

    def parts(self, values: FloatArray) -> tuple[FloatArray, ...]:
        """Take parameters, shape (p,), apart by effect."""
        return tuple(np.split(values, self._ends))

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
                "maxfev": EVALUATIONS * len(free),
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


def settled(scene: Scene, found: Fit) -> Fit:
    """Climb to the parameters that touches show, from those of a fit, with steps that these show.

    What a search holds at 0, or at an end, stays there.
    """
    surface = _Surface(scene, found, as_effects(found))
    free, steps = _free(surface, np.array([not slot.is_held for slot in surface.slots]))
    if not len(free):
        return found
    surface.climb(free, steps)
    return replace(found, parameters=surface.parts(surface.values))


def estimates(scene: Scene, found: Fit, admitted: Sequence[Effect]) -> list[Estimate]:
    """Settle the parameters of effects on touches, and tell what each may be.

    Args:
        scene: The touches.
        found: The fit.
        admitted: The same effects, their parameters brought into the ranges of the table.
    """
    surface = _Surface(scene, found, admitted)
    held = np.array([slot.is_held for slot in surface.slots])
    values, low, high = _about(surface, ~held)
    for _ in range(CLIMBS):
        if not surface.rise():
            break
        values, low, high = _about(surface, ~held)
    _widen(surface, held, low, high)
    for i, slot in enumerate(surface.slots):
        rounded = ROUNDED_US if slot.parameter.unit == "µs" else 0.0
        low[i], high[i] = min(low[i], values[i] - rounded), max(high[i], values[i] + rounded)
    low, high = (np.clip(ends, surface.low, surface.high) for ends in (low, high))
    return _as_estimates(admitted, surface.slots, values, low, high)


def _about(surface: _Surface, asked: BoolArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Give values, and what each that is asked for may be from and to; shape (p,)."""
    free, steps = _free(surface, asked)
    if len(free):
        surface.climb(free, steps)
    return _sampled(surface, *_free(surface, asked))


def _widen(surface: _Surface, held: BoolArray, low: FloatArray, high: FloatArray) -> None:
    """Let go what is held, and move the ends, shape (p,), as far as that lets any of them."""
    closed = np.array([slot.is_switch or slot.is_taken_up for slot in surface.slots])
    free, steps = _free(surface, ~closed)
    if held[free].any():
        _, lower, higher = _sampled(surface, free, steps)
        np.minimum(low, lower, out=low)
        np.maximum(high, higher, out=high)
    for i, slot in enumerate(surface.slots):
        if slot.is_held and not slot.is_taken_up and i not in free:
            low[i], high[i] = _reach(surface, i, -1.0), _reach(surface, i, 1.0)
            if slot.is_switch:
                low[i], high[i] = np.ceil(low[i]), np.floor(high[i])


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
            parameters[slot.parameter.name] = rounded(value - turns)
            ends[slot.parameter.name] = (float(low[i] - turns), float(high[i] - turns))
            if slot.turn and high[i] - low[i] > ANYWHERE * slot.turn:
                ends[slot.parameter.name] = (0.0, slot.turn)
            i += 1
        found.append(Estimate(replace(effect, parameters=parameters), ends))
    return found


def _free(surface: _Surface, asked: BoolArray) -> tuple[IndexArray, FloatArray]:
    """Give the parameters, of those asked for, that are open, and steps worth `A_STEP` each.

    What is held and makes no difference all over its range is not among them.
    """
    steps = np.array([_step(surface, i) if wanted else 0.0 for i, wanted in enumerate(asked)])
    room = np.where([slot.is_held for slot in surface.slots], surface.high - surface.low, np.inf)
    free = np.flatnonzero((steps > 0.0) & (steps < room))
    return free, steps[free]


def _step(surface: _Surface, index: int) -> float:
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
    """Sample the free parameters, nearer to the likelihood each time.

    Gives values, and what each may be from and to; shape (p,).
    """
    values, lower, higher = surface.values.copy(), surface.values.copy(), surface.values.copy()
    if not len(free):
        return values, lower, higher
    rng = np.random.default_rng(SEED)
    slots = [surface.slots[i] for i in free]
    low, high = ((end - surface.values)[free] / steps for end in (surface.low, surface.high))

    def are_within(points: FloatArray) -> BoolArray:
        return np.asarray(np.all((points >= low) & (points <= high), axis=1))

    middle = np.zeros(len(free))
    spread = _covariance(surface, free, steps)
    points, weights = np.zeros((1, len(free))), np.ones(1)
    more = int(np.ceil(len(free) / FEW))
    for i, count in enumerate(ROUNDS + MORE_ROUNDS * ROUNDS[-1:]):
        if i >= len(ROUNDS) and _counting(weights) >= ENOUGH:
            break
        size = more * count
        proposal = stats.multivariate_t(middle, _firm(spread), DEGREES_OF_FREEDOM, seed=rng)
        drawn = _drawn(proposal.rvs, size, are_within)
        if not len(drawn):
            break
        points = drawn
        heights = np.array([surface.along(free, steps * point) for point in points])
        logs = heights - surface.peak - proposal.logpdf(points).reshape(len(points))
        weights = _weights(logs)
        calm = _weights(logs, LEAST_SAMPLES * (1 + len(free)))
        middle = calm @ points
        spread = _spread(points, calm)
    best = weights @ points  # on a plateau the middle is nearer to the truth than any peak
    if surface.peak - surface.along(free, steps * best) > OFF_THE_TOP:
        best = np.zeros(len(free))
    shares = np.array([slot.shares for slot in slots])
    first, last = (_quantiles(points, weights, share) for share in shares.T)
    values[free] += steps * best
    lower[free] += steps * np.minimum(first, best)
    higher[free] += steps * np.maximum(last, best)
    return values, lower, higher


def _drawn(
    draw: Callable[[int], FloatArray], size: int, are_within: Callable[[FloatArray], BoolArray]
) -> FloatArray:
    """Draw points within all ranges, shape (size, p), or fewer where there are next to none."""
    tried = (draw(BATCH * size).reshape(BATCH * size, -1) for _ in range(BATCHES))
    kept: list[FloatArray] = []
    while sum(map(len, kept)) < size and (points := next(tried, None)) is not None:
        kept.append(points[are_within(points)])
    return np.vstack(kept)[:size]


def _firm(spread: FloatArray) -> FloatArray:
    """Leave some variance across a ridge along which parameters make up for each other.

    A range may be a hundred thousand times as long as a parameter is known to beside the others.
    """
    return spread + ACROSS * float(np.diag(spread).max()) * np.eye(len(spread))


def _spread(points: FloatArray, weights: FloatArray) -> FloatArray:
    """Give the covariance for the next samples, somewhat larger than of these; shape (p, p)."""
    count = points.shape[1]
    spread = INFLATION * np.cov(points.T, aweights=weights, ddof=0).reshape(count, count)
    return np.asarray(spread + RIDGE * max(1.0, float(np.trace(spread))) * np.eye(count))


def _counting(weights: FloatArray) -> float:
    """Give how many samples count in effect."""
    return 1.0 / float(np.sum(weights**2))


def _covariance(surface: _Surface, free: IndexArray, steps: FloatArray) -> FloatArray:
    """Give a first guess, in units of the steps: how far each parameter goes, and pairs together.

    Where one parameter makes up for another, a step of the one undoes a step of the other, and the
    likelihood may be level for many of both.
    """
    units = np.eye(len(free))
    moves = [one + sense * other for one, other in combinations(units, 2) for sense in (1.0, -1.0)]
    parts = [np.outer(move, move) * _stretch(surface, free, steps * move) ** 2 for move in moves]
    return np.asarray(sum(parts, units))


def _stretch(surface: _Surface, free: IndexArray, moved: FloatArray) -> float:
    """Give how often parameters may be moved before that is worth `A_STEP`: a power of 2, or 0."""

    def fall(times: float) -> float:
        return surface.peak - max(surface.along(free, sense * times * moved) for sense in (-1, 1))

    times = 1.0
    while times < LONGEST and fall(times) < A_STEP:
        times *= 2.0
    return times / 2.0 if times > 1.0 else 0.0


def _weights(logs: FloatArray, least: float = 0.0) -> FloatArray:
    """Normalise weights, evened out until so many of them count."""
    weights = np.ones_like(logs)
    for temper in TEMPERS:
        weights = np.exp(temper * (logs - logs.max()))
        weights /= weights.sum()
        if _counting(weights) >= least:
            break
    return weights


def _quantiles(points: FloatArray, weights: FloatArray, shares: FloatArray) -> FloatArray:
    """Give a weighted quantile of each column; shape (p,)."""
    return np.array(
        [
            np.quantile(column, share, weights=weights, method="inverted_cdf")
            for column, share in zip(points.T, shares, strict=True)
        ]
    )
