"""Fits that stand at parameters that are given, as if a search had brought them there."""

from dataclasses import replace

import numpy as np

from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.likelihood import affected
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect, effects


def whole(effect: Effect) -> Effect:
    """The effect with all its parameters, those not given at 0."""
    described = effects()[effect.id].parameters
    return Effect(effect.id, {p.name: effect.parameters.get(p.name, 0.0) for p in described})


def standing(scene: Scene, *begun: Effect, slack: float = 0.0) -> Fit:
    """Effects where a search has brought them."""
    found = Fit(
        tuple(CANDIDATES[effect.id] for effect in begun),
        tuple(np.array(list(whole(effect).parameters.values())) for effect in begun),
        frozenset(),
        slack,
    )
    return replace(found, reached=affected(scene, found.change(scene)))
