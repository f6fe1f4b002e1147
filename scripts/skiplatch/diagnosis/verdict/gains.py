"""Whether each effect of a finding gains on the record what it gains where it is the truth.

Any shape that resembles what was recorded makes it likelier. The effect itself would make it
likelier by what it does to plays of the finding (a posterior predictive check: Rubin, Annals of
Statistics 12 (1984) 1151); one that only resembles it gains less than on any of them. The laws of
the likelihood may be off, but then they are for the plays as well.
"""

from collections.abc import Mapping

import numpy as np

from skiplatch.arrays import BoolArray
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.laws import LATTICE
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import replayed
from skiplatch.diagnosis.scene.scene import Scene

PLAYS = 20
"""Of which none gains as little by chance, once in twenty findings."""
LEAST = 1.0
"""Nats that an effect has to gain where it is there."""


def shares_gained(
    scene: Scene, rows: BoolArray, rigs: tuple[Rig, Rig], fit: Fit, *, seed: int
) -> Mapping[str, float]:
    """Give what effects gain on the record over what they gain on plays; 1 if some gains as little.

    Args:
        scene: All touches.
        rows: Those that count; shape (n,).
        rigs: As it is believed to be, and as it is found.
        fit: What it is found to have besides, as it was fitted with its beliefs.
        seed: Of the plays.

    Returns:
        By the id of each effect.
    """
    believed, found = rigs
    plays = replayed(scene, rows, found, seed=seed, campaigns=PLAYS)
    # Plays that move scans to the touches show no grid; the record of such a rig may.
    unasked = frozenset() if found.keeps_scan_grid else frozenset({LATTICE})

    campaigns = (scene.select(rows), *plays)
    whole = [nats_of(one, found, fit, unasked) for one in campaigns]

    def share(i: int) -> float:
        fewer = fit.without(i) if len(fit.candidates) > 1 else None
        start = found if fewer else believed
        record, *gains = (
            nats - nats_of(one, start, fewer, unasked)
            for nats, one in zip(whole, campaigns, strict=True)
        )
        usual = float(np.mean(gains))
        if usual < LEAST:
            return 0.0
        return 1.0 if min(gains) <= record else record / usual

    return {candidate.id: share(i) for i, candidate in enumerate(fit.candidates)}


def nats_of(
    scene: Scene, rig: Rig, fit: Fit | None, unasked: frozenset[str] = frozenset()
) -> float:
    """Give the log-likelihood of a scene on a rig, with what it has besides or without.

    Args:
        scene: The touches.
        rig: What they are held against.
        fit: What it has besides.
        unasked: Names of streams that do not count.
    """
    believed = scene.with_nominal(rig.nominal)
    found = likelihood(believed, fit.change(believed) if fit else NOTHING)
    return float(sum(nats.sum() for name, nats in found.streams.items() if name not in unasked))
