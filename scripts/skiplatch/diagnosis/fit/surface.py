"""The log-likelihood over the parameters of all effects, and its top."""

from collections.abc import Sequence
from concurrent.futures import Executor
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
import scipy

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.diagnosis.candidates.surrogates import SWITCHES, highest, turn_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.side_by_side import side_by_side
from skiplatch.simulator.effects import Effect, Parameter, effects

CONFIDENCE = 0.9
A_STEP = 1.0
"""Nats from the peak that make a step, of somewhat more than a standard deviation."""
EVALUATIONS = 25  # of a climb, a parameter
CLOSE = 0.02
"""Nats, and steps, by which a climb's last points may differ."""
WORST = -1e300
PARTS = 8
"""That many points are taken in, to be looked at side by side."""


@dataclass(frozen=True, slots=True)
class Slot:
    """One parameter of one of the effects."""

    effect_id: str
    parameter: Parameter
    value: float
    is_taken_up: bool = False
    """The datum does what it does."""

    @property
    def low(self) -> float:
        """Lower end of its range; half a turn below a place."""
        return self.value - self.turn / 2.0 if self.turn else self.parameter.low

    @property
    def high(self) -> float:
        """Upper end of its range, as far as it is searched; half a turn above a place."""
        if self.turn:
            return self.value + self.turn / 2.0
        return highest(self.effect_id, self.parameter)

    @property
    def turn(self) -> float:
        """After which an angle or a place in a period is the same again; 0 for others."""
        return turn_of(self.parameter)

    @property
    def is_held(self) -> bool:
        """It stands at 0 or at an end, or is a switch, where a search has no use for it."""
        return self.is_switch or self.value in (0.0, self.low, self.high)

    @property
    def is_switch(self) -> bool:
        """Nothing but whole numbers of it have a meaning."""
        return self.parameter.name in SWITCHES

    @property
    def shares(self) -> tuple[float, float]:
        """Shares of the density below each end of the interval; an end of the range ends it."""
        if self.value == self.low:
            return 0.0, CONFIDENCE
        if self.value == self.high:
            return 1.0 - CONFIDENCE, 1.0
        return (1.0 - CONFIDENCE) / 2.0, (1.0 + CONFIDENCE) / 2.0


class Surface:
    """The log-likelihood over the parameters of all effects, within their ranges."""

    def __init__(
        self,
        scene: Scene,
        found: Fit,
        admitted: Sequence[Effect],
        executor: Executor | None = None,
    ) -> None:
        self._executor = executor
        self._scene = scene
        self._found = found
        self._ends = np.cumsum([len(effect.parameters) for effect in admitted])[:-1]
        self.highest, self.top = np.zeros(0), np.inf
        self._stand_at(
            [
                Slot(effect.id, parameter, effect.parameters[parameter.name], i in taken)
                for effect, candidate in zip(admitted, found.candidates, strict=True)
                for taken in [candidate.taken_up(scene)]
                for i, parameter in enumerate(effects()[effect.id].parameters)
            ]
        )

    def _stand_at(self, slots: Sequence[Slot]) -> None:
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
        if not np.isfinite(total):
            return WORST
        if total > self.top:
            self.top, self.highest = total, values
        return total

    def at_each(self, points: FloatArray) -> FloatArray:
        """Give it at points, shape (k, p), side by side; shape (k,)."""
        alone = copy(self)
        alone._executor = None  # noqa: SLF001 - it does not travel
        parts = side_by_side(self._executor, alone._in_turn, np.array_split(points, PARTS))  # noqa: SLF001
        heights = np.concatenate(parts)
        best = int(np.argmax(heights))
        if heights[best] > self.top:
            self.top, self.highest = float(heights[best]), points[best]
        return heights

    def _in_turn(self, points: FloatArray) -> FloatArray:
        return np.array([self(point) for point in points])

    def parts(self, values: FloatArray) -> tuple[FloatArray, ...]:
        """Take parameters, shape (p,), apart by effect."""
        return tuple(np.split(values, self._ends))

    def climb(self, free: IndexArray, steps: FloatArray) -> None:
        """Go to the top: these touches need not be those of the fit."""

        def minus(moved: FloatArray) -> float:
            return -self.along(free, steps * moved)

        start: FloatArray = np.zeros(len(free))
        found = scipy.optimize.minimize(
            minus,
            start,
            method="Nelder-Mead",
            options={
                "initial_simplex": np.vstack([np.zeros(len(free)), np.eye(len(free))]),
                "maxfev": EVALUATIONS * len(free),
                "fatol": CLOSE,
                "xatol": CLOSE,
            },
        )
        # On a flat top a start is as good as any: its edge is no place for touches to come.
        if -found.fun > self.peak + CLOSE:
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
