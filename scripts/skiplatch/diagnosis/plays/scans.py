"""Plays whose scans begin when recorded ones did.

A play of its own switches the PLC on at some moment. The recorded rig's was switched on at one, and
its stamps show which: they lie on the grid of the scans. What else runs on a clock, its ticks or
the updates of a servo, keeps its distance from that grid. It is chance once, and not in each play.
"""

from dataclasses import dataclass, replace
from typing import Protocol, Self

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Touches
from skiplatch.diagnosis.scene.grid import FEWEST_STAMPS, folded, keep_grid, mean_turn
from skiplatch.simulator.playing import Outcomes
from skiplatch.units import US_PER_S

RESOLVED = 6
"""Decimals of a µs to which ticks and scans are told."""
STAMPS = 256
"""By which the scans of plays are set, at least."""
SETTINGS = 2
"""Of the mean, how often: how a clock rounds depends on when it is read."""
NEARBY = np.linspace(-1.0, 1.0, 33)
"""Phases that are tried at a time, in ticks at first."""
NARROWER = 4.0
"""Times which they lie closer the next time: a few stamps may come out alike by accident."""


@dataclass(frozen=True, slots=True)
class Begins:
    """When scans and moves begin; see `Controller`."""

    scan_phase_us: float = 0.0
    scan_spread_us: float = 0.0
    start_spread_us: float = 0.0


class Player(Protocol):
    """Plays touches on a rig."""

    def __call__(self, touches: Touches, replicates: int, begins: Begins) -> Outcomes:
        """Play them so often."""


@dataclass(frozen=True, slots=True)
class Scans:
    """Scans that were recorded.

    Attributes:
        recorded: The touches that tell them.
        stamp_us: Of one of them.
        period_us: From one to the next.
        phase_us: When scans begin whose stamps are those recorded: a clock may read late.
        open_us: By which they may be moved before a stamp shows it, for stamps are rounded.
    """

    recorded: Touches
    stamp_us: float
    period_us: float
    phase_us: float
    open_us: float

    @classmethod
    def of(cls, recorded: Touches, period_us: float, tick_us: float, play: Player) -> Self | None:
        """Find them by the stamps of touches, and by plays of these; None where they keep no grid.

        Args:
            recorded: The touches.
            period_us: From one scan to the next.
            tick_us: To which stamps are rounded.
            play: Plays touches on the rig that recorded them.
        """
        recorded = recorded.select(recorded.on_plc & np.isfinite(recorded.latch_us))
        stamps = recorded.latch_us
        turn = complex(mean_turn(stamps, period_us))
        if not keep_grid(turn) or len(stamps) < FEWEST_STAMPS:
            return None
        stamp_us = _within_turn(turn, period_us)
        turns = np.rint((stamps - stamp_us) / period_us)
        open_us = tick_us - float(np.ptp(stamps - turns * period_us))
        if open_us <= 0.0:  # scans are late by more than a tick, some of them
            rests_us = np.unique(np.round(turns * period_us % tick_us, RESOLVED)) % tick_us
            open_us = float(np.diff(np.append(rests_us, rests_us[0] + tick_us)).max())
        scans = cls(recorded, stamp_us, period_us, stamp_us, open_us)
        return replace(scans, phase_us=scans._alike(play, scans._by_mean(play), tick_us))

    def in_phase(self, play: Player, touches: Touches, replicates: int) -> Outcomes:
        """Play touches so that each waits as long for a scan as it would have."""
        begins = Begins(self.phase_us, self.open_us)
        return play(touches, replicates, begins)

    def at_recorded(self, play: Player, touches: Touches, replicates: int) -> Outcomes:
        """Play touches so that each falls anywhere before the scan that its stamp tells.

        What has no stamp falls anywhere before some scan.
        """
        begins = Begins(self.phase_us, self.open_us, self.period_us)
        later_us = self._later_us(play, touches, begins)
        outcomes = play(_begun_later(touches, later_us), replicates, begins)
        return replace(outcomes, start_delay_us=outcomes.start_delay_us + later_us)

    def anywhere(self, play: Player, touches: Touches, replicates: int) -> Outcomes:
        """Play touches so that each falls anywhere in the scans, which keep their grid."""
        begins = Begins(self.phase_us, self.open_us, self.period_us)
        return play(touches, replicates, begins)

    def _by_mean(self, play: Player) -> float:
        """Find the phase by the mean of what stamps of plays are late."""
        phase_us = self._within(self.stamp_us)
        for _ in range(SETTINGS):
            turn = complex(mean_turn(self._off_us(play, phase_us, self.open_us), self.period_us))
            phase_us = self._within(phase_us - _within_turn(turn, self.period_us))
        return phase_us

    def _alike(self, play: Player, phase_us: float, tick_us: float) -> float:
        """Give the phase near one at which the most stamps come out as recorded.

        Of coarse ticks each stamp says no more than before or after, which no mean of them tells.
        """

        def misfit_us(phase_us: float) -> float:
            return float(np.nanmean(np.abs(self._off_us(play, self._within(phase_us), 0.0))))

        reach_us = tick_us if misfit_us(phase_us) < tick_us else 0.0
        while reach_us > self.open_us / 2.0:
            phases_us = phase_us + reach_us * NEARBY
            misfits_us = np.array([misfit_us(each) for each in phases_us.tolist()])
            phase_us = float(phases_us[np.isclose(misfits_us, misfits_us.min())].mean())
            reach_us /= NARROWER
        return self._within(phase_us - self.open_us / 2.0)

    def _off_us(self, play: Player, phase_us: float, spread_us: float) -> FloatArray:
        """Give how late stamps of plays are whose scans begin at a phase, touch by touch."""
        begins = Begins(phase_us, spread_us, self.period_us)
        moves = _begun_later(self.recorded, self._later_us(play, self.recorded, begins))
        plays = play(moves, 1 + STAMPS // len(self.recorded), begins)
        return folded(plays.latch_us - self.recorded.latch_us, self.period_us).ravel()

    def _within(self, phase_us: float) -> float:
        """Bring a phase into a period, but to no 0, which leaves scans anywhere."""
        return phase_us % self.period_us or self.period_us

    def _later_us(self, play: Player, touches: Touches, begins: Begins) -> FloatArray:
        """Give by how much moves have to begin later to wait the most for the recorded scans.

        All of them by nothing, where the order of the touches would be another one.
        """
        phase_us, plc = begins.scan_phase_us, touches.on_plc
        plays = play(touches, 1 + STAMPS // int(plc.sum()), begins)
        edges_us = np.nanmean(plays.true_edge_us - plays.start_delay_us, axis=0)
        waits_us = self._begun_us(plays.latch_us, phase_us) - plays.true_edge_us
        longest_us = np.nanmin(waits_us[:, plc]) + self.period_us
        later_us = self._begun_us(touches.latch_us, phase_us) - longest_us - edges_us
        later_us = np.where(plc, np.nan_to_num(later_us), 0.0)
        # No time is before 0, where a campaign may begin: there the move waits for a later scan.
        early_us = np.maximum(-later_us - touches.time_s * US_PER_S, 0.0)
        later_us += np.ceil(early_us / self.period_us) * self.period_us
        times = touches.time_s, _begun_later(touches, later_us).time_s
        before, after = (np.argsort(each, kind="stable") for each in times)
        return later_us if np.array_equal(before, after) else np.zeros(len(touches))

    def _begun_us(self, stamps: FloatArray, phase_us: float) -> FloatArray:
        """Give when scans began by their stamps."""
        turns = np.rint((stamps - self.stamp_us) / self.period_us)
        return np.asarray(phase_us + turns * self.period_us)


def _begun_later(touches: Touches, later_us: FloatArray) -> Touches:
    """Give touches whose moves begin so much later; shape (n,)."""
    return replace(touches, time_s=touches.time_s + later_us / US_PER_S)


def _within_turn(turn: complex, period_us: float) -> float:
    """Give a mean turn of the period as a time, within half a period."""
    return float(np.angle(turn)) / (2.0 * np.pi) * period_us
