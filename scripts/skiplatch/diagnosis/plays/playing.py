"""Plays of conditions on the rig that is believed in, its datum where it was fitted."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray
from skiplatch.campaign import Nominal, Touches
from skiplatch.diagnosis.plays.scans import Begins, Player, Scans
from skiplatch.diagnosis.plays.surfaces import FittedDatum, within_reach
from skiplatch.diagnosis.scene.arrivals import as_stamped
from skiplatch.diagnosis.scene.grid import WRITTEN_US, keep_grid, mean_turn
from skiplatch.diagnosis.scene.lines import above_line_um
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import Outcomes, play, spliced
from skiplatch.simulator.rig import Controller
from skiplatch.span import ALWAYS, Span
from skiplatch.units import UM_PER_MM

ENCODER, TICK = "encoder_quantisation", "timer_quantisation"
SCAN_LOCK, SCAN_PERIOD, SLOTS = "scan_phase_lock", "scan_period", "link_slotting"


@dataclass(frozen=True, slots=True)
class Rig:
    """A rig to play on: what is believed of it, what it has besides, and where its surfaces are."""

    nominal: Nominal
    effects: Sequence[Effect] = ()
    datum: FittedDatum = field(default_factory=FittedDatum)
    scans: Mapping[float, Scans] = field(default_factory=dict)
    """Those of which stamps tell when they began, by their period in µs."""

    @property
    def spans(self) -> list[Span]:
        """Give those of effects that begin or end."""
        return [span for span in dict.fromkeys(e.span for e in self.effects) if span != ALWAYS]

    @property
    def resolution_um(self) -> float:
        """What it rounds positions to, believed or found."""
        coarse = (e.parameters.get("resolution_um", 0.0) for e in self.effects if e.id == ENCODER)
        return max([self.nominal.axis.resolution_um, *coarse])

    @property
    def scan_us(self) -> float:
        """Period of its scans: the believed one, and what an effect that is always there adds."""
        lasting = (e for e in self.effects if e.id == SCAN_PERIOD and e.span == ALWAYS)
        return self.nominal.plc.scan_us + sum(e.parameters["period_us"] for e in lasting)

    @property
    def longest_scan_us(self) -> float:
        """The same where it is longest, by what begins or ends."""
        passing = [e for e in self.effects if e.id == SCAN_PERIOD and e.span != ALWAYS]
        return self.scan_us + sum(max(e.parameters["period_us"], 0.0) for e in passing)

    @property
    def tick_us(self) -> float:
        """What its clock rounds stamps to, believed or found."""
        coarse = (e.parameters["tick_us"] for e in self.effects if e.id == TICK)
        return max([self.nominal.skip.tick_us, *coarse])

    def whose_scans_are(self, recorded: Touches, *, seed: int) -> Self:
        """Give it with the scans that touches of its own tell; the seed is that of trial plays."""
        if self.nominal.arrival_us is not None:
            return self
        scans = {}
        for rig, rows in self._steady(recorded):
            trial = partial(rig.played, seed=seed, jobs=1)
            there = rig.counted(recorded.select(rows))
            scans[rig.scan_us] = Scans.of(there, rig.scan_us, rig.tick_us, trial)
        return replace(self, scans={us: told for us, told in scans.items() if told is not None})

    def _steady(self, touches: Touches) -> Iterator[tuple[Self, BoolArray]]:
        """Give it from one change of the scan period to the next, and the n touches made then."""
        changing = [e for e in self.effects if e.id == SCAN_PERIOD and e.span != ALWAYS]
        if not changing:
            yield self, np.full(len(touches), fill_value=True)
            return
        others = [effect for effect in self.effects if effect not in changing]
        held = np.array([effect.span.holds(touches.touch) for effect in changing])
        sets, which = np.unique(held, axis=1, return_inverse=True)
        for number, there in enumerate(sets.T):
            acting = [
                replace(e, span=ALWAYS) for e, acts in zip(changing, there, strict=True) if acts
            ]
            yield replace(self, effects=[*others, *acting]), which.ravel() == number

    @property
    def has_coarse_tick(self) -> bool:
        """Its clock ticks more coarsely than believed."""
        return self.tick_us > self.nominal.skip.tick_us > 0.0

    def counted(self, touches: Touches) -> Touches:
        """Give touches with their stamps as plays make them: these count in believed ticks."""
        if not self.has_coarse_tick:
            return touches
        tick_us = self.nominal.skip.tick_us
        return replace(touches, latch_us=(touches.latch_us + WRITTEN_US) // tick_us * tick_us)

    @property
    def keeps_scan_grid(self) -> bool:
        """Its scans come evenly. Where touches are bound to the scan, plays move it to them."""
        return all(effect.id != SCAN_LOCK for effect in self.effects)

    def play(
        self,
        touches: Touches,
        *,
        seed: int,
        replicates: int,
        jobs: int = 1,
        in_phase: bool = False,
    ) -> Outcomes:
        """Play the conditions of touches so often, each replicate a rig switched on anew.

        Args:
            touches: The conditions, n.
            seed: Picks the random numbers.
            replicates: How often.
            jobs: Threads; the result does not depend on it.
            in_phase: Where it is known when scans began, let each touch wait for one as long as it
                would have; else it falls anywhere before the scan that its stamp tells.
        """
        steady = list(self._steady(touches))
        # A controller that goes on at another period goes on from the same scan.
        longest_us = max(rig.scan_us for rig, _ in steady)
        begins = Begins(longest_us, longest_us) if len(steady) > 1 else Begins()
        plays = []
        for rig, rows in steady:
            alone = partial(rig.played, seed=seed, jobs=jobs)
            is_bound = self.keeps_scan_grid and touches.on_plc[rows].any()
            scans = self.scans.get(rig.scan_us) if is_bound else None
            bound = partial(alone, begins=begins)
            if scans is not None:
                bound = partial(self._bound(scans, in_phase=in_phase), alone)
            plays.append(bound(touches, replicates))
        if len(plays) == 1:
            return plays[0]
        return spliced(plays, np.argmax([rows for _, rows in steady], axis=0))

    def _bound(self, scans: Scans, *, in_phase: bool) -> Callable[[Player, Touches, int], Outcomes]:
        """Give how touches are bound to scans.

        Slots of a link run on a clock of their own: an edge passes them in its slot alone, and
        reaches no other scan at the same distance.
        """
        if in_phase:
            return scans.in_phase
        is_slotted = any(effect.id == SLOTS for effect in self.effects)
        return scans.anywhere if is_slotted else scans.at_recorded

    def played(
        self, touches: Touches, replicates: int, begins: Begins, *, seed: int, jobs: int
    ) -> Outcomes:
        """Play touches so often on a controller that begins as told; see `play`."""
        surface_um, coordinate_um = self.datum.sizes_um(self.nominal, touches)
        surface_um, line_um = within_reach(touches, surface_um), np.zeros(len(touches))
        if all(effect.id != ENCODER for effect in self.effects):  # which has lines of its own
            line_um = above_line_um(self.nominal, touches)
        controller = Controller.for_campaign(self.nominal, touches)
        farther_mm = float(surface_um.max(initial=0.0)) / UM_PER_MM
        controller = replace(
            controller,
            overtravel_mm=controller.overtravel_mm + farther_mm,
            scan_phase_us=begins.scan_phase_us,
            scan_spread_us=begins.scan_spread_us,
            start_spread_us=begins.start_spread_us,
        )
        outcomes = play(
            self.nominal,
            controller,
            touches,
            seed=seed,
            replicates=replicates,
            jobs=jobs,
            datum_um=coordinate_um + line_um,
            surface_um=surface_um,
            switched_on=self.effects,
        )
        from_surface = replace(outcomes, deviation_um=outcomes.deviation_um - line_um)
        return as_stamped(self.nominal, from_surface)


@dataclass(frozen=True, slots=True, eq=False)
class Folds:
    """Rigs of one finding, each of which plays the touches that it was not fitted to.

    Attributes:
        rigs: One for each fold.
        fold: Number of that of each touch; shape (n,).
    """

    rigs: Sequence[Rig]
    fold: NDArray[np.intp]

    @property
    def spans(self) -> list[Span]:
        """Give those of effects that begin or end."""
        return self.rigs[0].spans

    @property
    def scan_us(self) -> float:
        """Period of their scans."""
        return self.rigs[0].scan_us

    @property
    def resolution_um(self) -> float:
        """What they round positions to."""
        return self.rigs[0].resolution_um

    @property
    def keeps_scan_grid(self) -> bool:
        """Its scans come evenly."""
        return self.rigs[0].keeps_scan_grid

    def play(self, touches: Touches, *, seed: int, replicates: int, jobs: int = 1) -> Outcomes:
        """Play the conditions of the n touches so often."""
        plays = [
            rig.play(touches, seed=seed, replicates=replicates, jobs=jobs) for rig in self.rigs
        ]
        return spliced(plays, self.fold)


def has_like_grid(rig: Rig | Folds, recorded: Touches) -> bool:
    """Tell whether stamps of plays lie on the grid of the scans as those recorded do.

    Scans that plays move to touches keep no grid; the record of such a rig may all the same.
    """
    if rig.keeps_scan_grid:
        return True
    return not keep_grid(complex(mean_turn(recorded.latch_us[recorded.on_plc], rig.scan_us)))
