"""Effects fitted together with the beliefs that they stand beside.

In turn, each is fitted to where the other one is: an effect and a belief that do nearly the same
share a ridge, along which turns get nowhere, and the effect is held against a belief that suits
another one.
"""

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Nominal
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.belief_fit import FARTHEST
from skiplatch.diagnosis.fit.beliefs import Belief, believing, value_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.least_squares import by_least_squares
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene


def together(scene: Scene, found: Fit, beliefs: Sequence[Belief]) -> tuple[Fit, Nominal]:
    """Fit effects and beliefs, from where both are; in the form that the effects have.

    Args:
        scene: The touches, under the chain as it is believed now.
        found: The effects.
        beliefs: As they stand in nominal.toml.
    """
    ridge = _Together(scene, found, beliefs)
    best = by_least_squares(ridge, ridge.start)
    there, _ = ridge.at(best)
    return ridge.fit(best), there.nominal


class _Together:
    """Parameters of effects, and after them the places of beliefs in standard uncertainties."""

    def __init__(self, scene: Scene, found: Fit, beliefs: Sequence[Belief]) -> None:
        self._scene, self._found, self._beliefs = scene, found, beliefs
        self._ends = np.cumsum([len(values) for values in found.parameters])
        places = [b.uncertainties(value_of(scene.nominal, b.key)) for b in beliefs]
        self.start: FloatArray = np.concatenate([*found.parameters, places])

    @property
    def reached(self) -> AbstractSet[str]:
        return self._scene.streams.keys()

    def believed(self, values: FloatArray) -> BoolArray:
        return np.asarray(np.arange(len(values)) >= self._ends[-1])

    def fit(self, values: FloatArray) -> Fit:
        *parameters, _ = np.split(values, self._ends)
        return replace(self._found, parameters=tuple(parameters))

    def at(self, values: FloatArray) -> tuple[Scene, Change]:
        places = np.clip(values[self._ends[-1] :], -FARTHEST, FARTHEST).tolist()
        moved = zip(self._beliefs, places, strict=True)
        nominal = believing(self._scene.nominal, {b.key: b.moved(place) for b, place in moved})
        there = self._scene.with_nominal(nominal)
        return there, self.fit(values).change(there)

    def __call__(self, values: FloatArray) -> float:
        places = values[self._ends[-1] :]
        return 0.5 * float(places @ places) - likelihood(*self.at(values)).total
