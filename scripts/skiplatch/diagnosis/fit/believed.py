"""Effects that a rig is believed to have: what is searched for comes on top of them."""

from dataclasses import replace
from functools import reduce

import numpy as np

from skiplatch.campaign import BelievedEffect, Campaign, DatumFreedom
from skiplatch.campaign.nominal import in_version
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.directions import with_directions
from skiplatch.diagnosis.fit.unstated import with_unstated
from skiplatch.diagnosis.likelihood.laws import law_of
from skiplatch.diagnosis.scene.arrivals import with_arrivals
from skiplatch.diagnosis.scene.lines import with_lines
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import effects


class BelievedEffects:
    """The physics of the effects in a scene's nominal chain."""

    def change(self, scene: Scene) -> Change:
        """Give what they make of the physics of the chain."""
        changes = (_change(scene, effect) for effect in scene.nominal.believed_effects)
        return reduce(Change.joined, changes, NOTHING)

    def law(self, scene: Scene, stream: Stream) -> Law:
        """Give the law of a stream's residuals, all n of them."""
        return law_of(scene, stream, scene.believed)


BELIEVED = BelievedEffects()


def scene_of(campaign: Campaign) -> Scene:
    """Take a campaign's touches in order of time, with the effects believed in."""
    campaign = _unclipped(with_lines(with_arrivals(campaign)))
    known = with_directions(campaign)
    return replace(
        Scene.of(with_unstated(known), BELIEVED),
        stood_in=known.stood_in,
        is_directed=known.nominal == campaign.nominal,
    )


def _unclipped(campaign: Campaign) -> Campaign:
    """Let a pretravel of 0 scatter to either side in format 1 too.

    Nobody calibrated it: it is where an unknown surface is, so that no touch can be at its end.
    """
    nominal = campaign.nominal
    if nominal.datum.free is DatumFreedom.NONE or nominal.probe.pretravel_um > 0.0:
        return campaign
    return replace(campaign, nominal=in_version(nominal, 2))


def _change(scene: Scene, effect: BelievedEffect) -> Change:
    row = effects()[effect.id]
    values = np.array([effect.values.get(p.name, p.when_unset) for p in row.parameters])
    return catalogue()[effect.id].change(scene, values)
