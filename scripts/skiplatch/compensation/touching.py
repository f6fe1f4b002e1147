"""Touching an artefact in many directions: from directions and feeds to trigger points.

A direction (α, β) is the one in which the surface pushes the tip. The simulation knows one axis,
along each approach; this module places the approaches in space and turns deviations into points.
"""

from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Nominal, Status, Touches
from skiplatch.compensation.firmware import Side
from skiplatch.simulator.library import SimulationError
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller, Seat
from skiplatch.units import S_PER_MIN, UM_PER_MM

PAUSE_S = 5.0
"""Between two touches, for the way to the next one; and up to so much again at random."""
WAYS = 3.0
"""There and back at the measuring feed, and some."""


@dataclass(frozen=True, slots=True, eq=False)
class Directions:
    """Directions in which the tip is pushed; arrays of shape (n,)."""

    alpha_deg: FloatArray
    beta_deg: FloatArray

    def __len__(self) -> int:
        return len(self.alpha_deg)

    @property
    def unit(self) -> FloatArray:
        """Unit vectors, shape (n, 3)."""
        alpha, beta = np.radians(self.alpha_deg), np.radians(self.beta_deg)
        across = np.cos(beta)
        return np.column_stack([across * np.cos(alpha), across * np.sin(alpha), np.sin(beta)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A ring, a sphere or a hollow artefact, as the centre of the tip sees it."""

    side: Side
    """From which it is touched."""
    radius_mm: float
    """Ring less tip, or sphere and tip: where the tip's centre is at the contact."""
    offset_mm: tuple[float, float, float]
    """Where its centre really is; it is believed to be at 0."""
    is_moved: bool
    """The artefact moves and the tip stands still, else the other way round."""
    clearance_mm: float
    """From the believed centre, or surface of a sphere, to where the measuring move starts."""

    def starts_mm(self, pushed: FloatArray) -> FloatArray:
        """Where the approaches start; `pushed` are unit vectors of shape (n, 3), as is this."""
        if self.side is Side.OUTSIDE:
            return (self.radius_mm + self.clearance_mm) * pushed
        return self.clearance_mm * self.motion(pushed)

    def motion(self, pushed: FloatArray) -> FloatArray:
        """Which way the measuring move goes; shapes (n, 3)."""
        return pushed if self.is_moved else -pushed

    def approach_mm(self, pushed: FloatArray) -> FloatArray:
        """From the start to the real surface; shape (n,)."""
        motion = self.motion(pushed)
        from_centre = self.starts_mm(pushed) - np.asarray(self.offset_mm)
        along = np.einsum("ij,ij->i", from_centre, motion)
        outside_by = np.einsum("ij,ij->i", from_centre, from_centre) - self.radius_mm**2
        root = np.sqrt(along**2 - outside_by)
        return np.asarray(-along - root if self.side is Side.OUTSIDE else -along + root)


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """n directions touched m times each, one run after the other.

    Attributes:
        target: What was touched.
        directions: n of them.
        touches: The n·m touches, run by run, as they were recorded; their `approach_mm` and
            `deviation_um` count from the real surface.
    """

    target: Target
    directions: Directions
    touches: Touches

    @property
    def points_um(self) -> FloatArray:
        """Trigger points, shape (m, n, 3)."""
        pushed = self.directions.unit
        starts_um = self.target.starts_mm(pushed) * UM_PER_MM
        ways_um = self._ways_um[..., np.newaxis]
        return np.asarray(starts_um + ways_um * self.target.motion(pushed))

    def about(self, mean_um: FloatArray) -> Touches:
        """Give the touches as recorded by somebody who has found the artefact's centre.

        Args:
            mean_um: Mean deviation of each direction from where that centre puts the surface;
                shape (n,).
        """
        ways_um = self._ways_um
        approach_um = ways_um.mean(axis=0) - mean_um
        return replace(
            self.touches,
            approach_mm=np.resize(approach_um / UM_PER_MM, ways_um.size),
            deviation_um=(ways_um - approach_um).ravel(),
        )

    @property
    def _ways_um(self) -> FloatArray:
        """From the start of the move to the trigger point, shape (m, n)."""
        ways_um = self.touches.approach_mm * UM_PER_MM + self.touches.deviation_um
        return np.asarray(ways_um.reshape(-1, len(self.directions)))


class Station:
    """A rig ready to touch; its clock runs on from one recording to the next."""

    def __init__(
        self,
        nominal: Nominal,
        seat: Seat | None,
        *,
        path: InputPath,
        seed: int,
        jobs: int = 1,
    ) -> None:
        """Switch it on.

        Args:
            nominal: The chain.
            seat: The probe's mechanics, or None for the same pretravel in all directions.
            path: Which input latches.
            seed: Picks the random numbers.
            jobs: Threads to play on.
        """
        self._nominal = nominal
        self._seat = seat
        self._path = path
        self._seed = seed
        self._jobs = jobs
        self._touches_made = 0
        self._time_s = 0.0

    def touch(
        self, target: Target, directions: Directions, feed_mm_min: FloatArray, *, runs: int
    ) -> Recording:
        """Touch in n directions at a feed each, so many times, through the firmware's latch.

        Raises:
            SimulationError: A touch was not latched, or the simulation refuses the rig.
        """
        conditions = self._conditions(target, directions, feed_mm_min, runs)
        outcomes = play(
            self._nominal,
            Controller.for_campaign(self._nominal, conditions),
            conditions,
            seed=self._seed,
            jobs=self._jobs,
            seat=self._seat,
        )
        missed = int(np.count_nonzero(~outcomes.ok))
        if missed:
            raise SimulationError(f"{missed} of {len(conditions)} touches were not latched")
        touches = replace(
            conditions,
            latch_us=outcomes.latch_us[0],
            report_us=outcomes.report_us[0],
            deviation_um=outcomes.deviation_um[0],
            status=np.full(len(conditions), Status.OK, dtype=np.int8),
        )
        return Recording(target, directions, touches)

    def _conditions(
        self, target: Target, directions: Directions, feed_mm_min: FloatArray, runs: int
    ) -> Touches:
        """Give one run after the other, at random points of the PLC's scan."""
        n = len(directions) * runs
        approach_mm = np.resize(target.approach_mm(directions.unit), n)
        feeds = np.resize(feed_mm_min, n)
        rng = np.random.default_rng((self._seed, self._touches_made))
        taken_s = WAYS * approach_mm / feeds * S_PER_MIN + PAUSE_S * (1.0 + rng.random(n))
        ends_s = self._time_s + np.cumsum(taken_s)
        touches = Touches.from_columns(
            touch=self._touches_made + np.arange(n),
            time_s=np.round(ends_s - taken_s, 6),
            path=np.full(n, self._path),
            alpha_deg=np.resize(directions.alpha_deg, n),
            beta_deg=np.resize(directions.beta_deg, n),
            feed_mm_min=feeds,
            approach_mm=approach_mm,
        )
        self._touches_made += n
        self._time_s = float(ends_s[-1])
        return touches
