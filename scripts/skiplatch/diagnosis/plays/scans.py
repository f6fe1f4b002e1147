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
from skiplatch.diagnosis.scene.grid import mean_turn
from skiplatch.simulator.playing import Outcomes
from skiplatch.units import US_PER_S

KEPT = 0.5
"""Mean of the stamps as turns of the scan, from which on they keep to its grid."""
FEWEST_STAMPS = 16
RESOLVED = 6
"""Decimals of a µs to which ticks and scans are told."""
DRAWN = 16
"""Replicates by which the scans of plays are set, at least, and stamps of all of them together."""
STAMPS = 256
SETTINGS = 2
"""How often: how a clock rounds depends on when it is read."""


@dataclass(frozen=True, slots=True)
class Begins:
    """When scans and moves begin; see `Controller`."""

    scan_phase_us: float = 0.0
    scan_spread_us: float = 0.0
    start_spread_us: float = 0.0


def keep_grid(turn: complex) -> bool:
    """Tell by the mean of stamps as turns of the scan whether they lie on its grid."""
    return bool(abs(turn) >= KEPT)


class Player(Protocol):
    """Plays touches on a rig."""

    def __call__(self, touches: Touches, replicates: int, begins: Begins) -> Outcomes:
        """Play them so often."""


@dataclass(frozen=True, slots=True)
class Scans:
    """Scans that were recorded.

    Attributes:
        stamp_us: Of one of them.
        period_us: From one to the next.
        open_us: By which they may be moved before a stamp shows it, for stamps are rounded.
    """

    stamp_us: float
    period_us: float
    open_us: float

    @classmethod
    def of(cls, recorded: Touches, period_us: float, tick_us: float) -> Self | None:
        """Find them by the stamps of touches; None where these keep no grid."""
        stamps = recorded.latch_us[recorded.on_plc]
        turn = complex(mean_turn(stamps, period_us))
        if not keep_grid(turn) or np.isfinite(stamps).sum() < FEWEST_STAMPS:
            return None
        stamp_us = float(np.angle(turn)) / (2.0 * np.pi) * period_us
        turns = np.rint((stamps[np.isfinite(stamps)] - stamp_us) / period_us)
        rests_us = np.unique(np.round(turns * period_us % tick_us, RESOLVED)) % tick_us
        gaps_us = np.diff(np.append(rests_us, rests_us[0] + tick_us))
        return cls(stamp_us, period_us, float(gaps_us.max()))

    def in_phase(self, play: Player, touches: Touches, replicates: int) -> Outcomes:
        """Play touches so that each waits as long for a scan as it would have."""
        begins = Begins(self._phase_us(play, touches), self.open_us)
        return play(touches, replicates, begins)

    def at_recorded(self, play: Player, touches: Touches, replicates: int) -> Outcomes:
        """Play touches so that each falls anywhere before the scan that its stamp tells.

        What has no stamp falls anywhere before some scan.
        """
        phase_us = self._phase_us(play, touches)
        begins = Begins(phase_us, self.open_us, self.period_us)
        later_us = self._later_us(play, touches, begins)
        begun_s = touches.time_s + later_us / US_PER_S
        before, after = (np.argsort(times, kind="stable") for times in (touches.time_s, begun_s))
        if not np.array_equal(before, after):
            later_us, begun_s = np.zeros(len(touches)), touches.time_s
        outcomes = play(replace(touches, time_s=begun_s), replicates, begins)
        return replace(outcomes, start_delay_us=outcomes.start_delay_us + later_us)

    def _phase_us(self, play: Player, touches: Touches) -> float:
        """Find when scans begin whose stamps are those recorded: a clock may read late."""
        plc = np.flatnonzero(touches.on_plc)
        some = touches.select(plc[:: max(1, len(plc) // FEWEST_STAMPS)])
        replicates = max(DRAWN, STAMPS // len(some))
        phase_us = self._within(self.stamp_us)
        for _ in range(SETTINGS):
            begins = Begins(phase_us, self.open_us, self.period_us)
            stamps = play(some, replicates, begins).latch_us
            phase_us = self._within(phase_us - self._off_us(stamps))
        return phase_us

    def _within(self, phase_us: float) -> float:
        """Bring a phase into a period, but to no 0, which leaves scans anywhere."""
        return phase_us % self.period_us or self.period_us

    def _off_us(self, stamps: FloatArray) -> float:
        """Give by how much scans are stamped later than these, within half a period."""
        own = np.exp(2j * np.pi * self.stamp_us / self.period_us)
        off = np.angle(mean_turn(stamps.ravel(), self.period_us) * np.conj(own))
        return float(off / (2.0 * np.pi) * self.period_us)

    def _later_us(self, play: Player, touches: Touches, begins: Begins) -> FloatArray:
        """Give by how much moves have to begin later to wait the most for the recorded scans."""
        phase_us, plc = begins.scan_phase_us, touches.on_plc
        plays = play(touches, 1 + STAMPS // int(plc.sum()), begins)
        edges_us = np.nanmean(plays.true_edge_us - plays.start_delay_us, axis=0)
        waits_us = self._begun_us(plays.latch_us, phase_us) - plays.true_edge_us
        longest_us = np.nanmin(waits_us[:, plc]) + self.period_us
        later_us = self._begun_us(touches.latch_us, phase_us) - longest_us - edges_us
        later_us = np.where(plc, np.nan_to_num(later_us), 0.0)
        # No time is before 0, where a campaign may begin: there the move waits for a later scan.
        early_us = np.maximum(-later_us - touches.time_s * US_PER_S, 0.0)
        return np.asarray(later_us + np.ceil(early_us / self.period_us) * self.period_us)

    def _begun_us(self, stamps: FloatArray, phase_us: float) -> FloatArray:
        """Give when scans began by their stamps."""
        turns = np.rint((stamps - self.stamp_us) / self.period_us)
        return np.asarray(phase_us + turns * self.period_us)
