"""Touches that no form of an effect comes near, which are another one's."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import played_again, stamped_machine, values_of
from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import PLAIN_SECOND
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.own_way import gain_beyond_reach
from skiplatch.diagnosis.search.parts import split
from skiplatch.simulator.effects import Effect

LATE = Change(position_extra=(Extra(0.05, offset=60.0, sigma=2.0),))
"""One touch in twenty lies 60 µm further."""


def machine_off_by(shift_um: Callable[[Scene], FloatArray]) -> Scene:
    """A machine without a gap, but that its positions are off."""
    machine = stamped_machine()
    touches = machine.touches
    deviation_um = touches.deviation_um + shift_um(Scene.of(machine))
    return Scene.of(replace(machine, touches=replace(touches, deviation_um=deviation_um)))


def one_in_twenty(scene: Scene) -> FloatArray:
    return np.where(np.arange(len(scene)) % 20 == 0, 60.0, 0.0)


def by_sense(scene: Scene) -> FloatArray:
    return 2.0 * scene.sign


def test_what_is_far_beyond_the_scatter_is_within_no_form() -> None:
    scene = machine_off_by(lambda scene: one_in_twenty(scene) + by_sense(scene))
    sense = Change(position_um=by_sense(scene))

    assert gain_beyond_reach(scene, LATE.joined(sense), sense) > 50.0


@pytest.mark.parametrize(
    "others",
    [
        lambda scene: Change(position_um=60.0 * scene.sign),
        lambda scene: Change(position_sigma_us=30.0 / scene.speed),
    ],
    ids=["shifts as far", "scatters as far"],
)
def test_what_another_form_may_come_near_is_within_it(others: Callable[[Scene], Change]) -> None:
    """A shift of 60 µm may be one of 0 or 120 in another form."""
    scene = machine_off_by(one_in_twenty)
    before = others(scene)

    assert gain_beyond_reach(scene, before.joined(LATE), before) == 0.0


def test_what_comes_seldom_is_beyond_what_always_does() -> None:
    """Nearly all that is gained is the latency's; one contact in sixteen bounces."""
    late = Effect("isr_latency", {"latency_us": 200.0})
    bounce = Effect("contact_bounce", {"probability": 0.06, "mean_us": 100.0, "least_us": 600.0})
    scene = Scene.of(played_again(stamped_machine(), late, bounce))
    judge = Judge(scene, split(len(scene), 1))
    alone, bounced = (judge.score(fitted(scene, late, *more)) for more in ((), (bounce,)))

    assert judge.share(bounced, alone) < PLAIN_SECOND
    assert judge.is_beyond_reach(bounced, alone)


def fitted(scene: Scene, *effects: Effect) -> Fit:
    candidates = tuple(catalogue()[effect.id] for effect in effects)
    return Fit(candidates, tuple(map(values_of, effects)), frozenset(scene.streams))
