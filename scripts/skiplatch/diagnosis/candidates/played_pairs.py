"""Plays without and with an effect, with the same random numbers: nothing else differs."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Nominal
from skiplatch.diagnosis.scene.arrivals import as_stamped
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.stand_ins import PLAYED

SEED = 1
CERTAIN = 2
"""Replicates that show that an effect does the same each time."""
PLAYED_TOUCHES = 6_400
FEWEST_REPLICATES, MOST_REPLICATES = 4, 32
FINER, FINER_TICK = 1e-3, 0.125
"""What positions and stamps are rounded to over what is believed, lest rounding hide shifts."""
STRETCH_US = 1_000.0
"""Of travel, by which the speed is measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Plays without and with an effect; arrays of shape (r, n)."""

    scene: Scene
    without: Outcomes
    with_it: Outcomes

    @property
    def contact_us(self) -> FloatArray:
        """By how much the recorded edge comes later; bench only."""
        return self.with_it.edge_us - self.without.edge_us

    @property
    def latch_us(self) -> FloatArray:
        """By how much the latch comes later, after what it is counted from."""
        later = self.with_it.latch_us - self.without.latch_us
        return later if self.scene.is_machine else later - self.contact_us

    @property
    def deviation_um(self) -> FloatArray:
        """By how much the latched position differs."""
        return self.with_it.deviation_um - self.without.deviation_um

    @property
    def position_um(self) -> FloatArray:
        """By how much the position differs beyond the way of the latch's own time."""
        return self.deviation_um - self.scene.speed * self.latch_us

    @property
    def report_us(self) -> FloatArray:
        """By how much the report comes later."""
        return self.with_it.report_us - self.without.report_us

    @property
    def travel_us(self) -> FloatArray:
        """By how much the report takes longer."""
        return self.report_us - (self.with_it.latch_us - self.without.latch_us)

    @property
    def lost(self) -> float:
        """Share of the touches that are missed because of the effect."""
        return max(0.0, float(np.mean(self.without.ok)) - float(np.mean(self.with_it.ok)))


class Player:
    """Plays one effect with one set of parameters."""

    def __init__(self, scene: Scene, effect: Effect) -> None:
        self._scene = scene
        self._effect = effect

    def pair(self, *, all_skip: bool) -> Pair:
        """Play as often as needed: twice what does the same each time, else more often."""
        pair = self.often(CERTAIN, all_skip=all_skip)
        same = all(map(is_same, (pair.latch_us, pair.deviation_um, pair.report_us)))
        if same and np.all(pair.with_it.ok == pair.without.ok):
            return pair
        often = np.clip(PLAYED_TOUCHES // len(self._scene), FEWEST_REPLICATES, MOST_REPLICATES)
        return self.often(int(often), all_skip=all_skip)

    def often(self, replicates: int, *, all_skip: bool = False) -> Pair:
        """Play so many times, as recorded or all touches on the skip path."""
        without = _without(self._scene, replicates, all_skip=all_skip)
        with_it = _play(self._scene, self._effect, replicates, all_skip=all_skip)
        return Pair(self._scene, without, with_it)

    def speed_ratio(self) -> FloatArray:
        """Measure how far the axis goes in a little more time; shape (n,)."""
        near = _play(self._scene, self._effect, 1, all_skip=True)
        far = _play(self._scene, self._effect, 1, all_skip=True, later_us=STRETCH_US)
        way_um = far.deviation_um[0] - near.deviation_um[0]
        ratio = way_um / (far.latch_us[0] - near.latch_us[0]) / self._scene.speed
        return np.asarray(np.nan_to_num(ratio, nan=1.0))


def is_same(differences: FloatArray) -> bool:
    """Tell whether all replicates show the same, but for rounding."""
    known = differences[:, ~np.isnan(differences).any(axis=0)]
    return bool(np.all(np.ptp(known, axis=0) <= 1e-3 * np.abs(known).max(initial=0.0) + 1e-2))


@lru_cache(maxsize=8)
def _without(scene: Scene, replicates: int, *, all_skip: bool) -> Outcomes:
    return _play(scene, None, replicates, all_skip=all_skip)


def _play(
    scene: Scene,
    effect: Effect | None,
    replicates: int,
    *,
    all_skip: bool,
    later_us: float = 0.0,
) -> Outcomes:
    """Play the touches; on the skip path a shift does not have to wait for a scan to be seen."""
    touches = scene.touches
    if all_skip:
        touches = replace(touches, path=np.full_like(touches.path, InputPath.SKIP))
    outcomes = play(
        _finer(scene.nominal, later_us),
        Controller.for_campaign(scene.nominal, touches),
        touches,
        seed=SEED,
        replicates=replicates,
        switched_on=[effect] if effect else [],
    )
    return as_stamped(scene.nominal, outcomes)


def _finer(nominal: Nominal, later_us: float) -> Nominal:
    """Round hardly anything, as far as that can be played."""
    least_um, least_us = PLAYED["axis", "resolution_um"][0], PLAYED["skip", "tick_us"][0]
    resolution_um = max(least_um, FINER * nominal.axis.resolution_um)
    tick_us = max(least_us, FINER_TICK * nominal.skip.tick_us)
    filter_us = nominal.input.filter_us + later_us
    return replace(
        nominal,
        axis=replace(nominal.axis, resolution_um=resolution_um),
        skip=replace(nominal.skip, tick_us=tick_us),
        input=replace(nominal.input, filter_us=filter_us),
    )
