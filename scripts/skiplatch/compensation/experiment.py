"""The document's experiment, touch by touch: delay, map, feeds, and the map once more.

Every radius comes out of touches that the firmware latched; what is computed of them, the firmware
computes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Nominal
from skiplatch.compensation import firmware
from skiplatch.compensation.rigs import Rig
from skiplatch.compensation.touching import Recording, Station, Target
from skiplatch.simulator.library import SimulationError
from skiplatch.simulator.rig import Seat
from skiplatch.units import UM_PER_MM, US_PER_MS

FEED_MAX_MM_MIN = 1000.0
"""What a probe may touch with; no rig here comes near it."""
EVEN_PRETRAVEL_UM = 20.0


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """Trigger radii of n directions in m runs, as pretravels: they grow with the feed.

    Attributes:
        recording: The touches.
        feed_mm_min: Shape (n,).
        mean_um: Of the mean trigger points about their own centre; shape (n,).
        single_um: Of each run about its own centre; shape (m, n).
        all_um: Of each run about the centre of the mean; shape (m, n).
    """

    recording: Recording
    feed_mm_min: FloatArray
    mean_um: FloatArray
    single_um: FloatArray
    all_um: FloatArray

    @property
    def vr_um(self) -> float:
        """V_r of the means over the runs."""
        return firmware.range_um(self.mean_um)

    @property
    def single_vr_um(self) -> float:
        """The largest V_r of a single run."""
        return max(firmware.range_um(run) for run in self.single_um)

    @property
    def all_vr_um(self) -> float:
        """V_r of all touches together."""
        return firmware.range_um(self.all_um.ravel())

    def row_vr_um(self, beta_deg: float) -> float:
        """V_r of the means at one β."""
        row = self.recording.directions.beta_deg == beta_deg
        return firmware.range_um(self.mean_um[row])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Result:
    """What came of an experiment."""

    rig: Rig
    rings: Sequence[Recording]
    """At one feed each."""
    tau: firmware.Tau
    before: Survey
    after: Survey
    """With the feeds of the last iteration."""
    time_increase: float
    systematic_before_um: float
    """V_r without any random error, at the feed before."""
    systematic_after_um: float
    """The same at the feeds of the table, which came from a map with random error."""
    floor_um: float
    """V_r that random error alone leaves: a probe of even pretravel, as many runs."""

    @property
    def tau_error(self) -> float:
        """Of the delay found, as a share of the one that was simulated."""
        return self.tau.tau_ms * US_PER_MS / self.rig.nominal.probe.delay_us - 1.0

    @property
    def reduction(self) -> float:
        """V_r before over V_r after."""
        return self.before.vr_um / self.after.vr_um

    @property
    def systematic_reduction(self) -> float:
        """The same without random error in either."""
        return self.systematic_before_um / self.systematic_after_um


class Session:
    """Measurements on one rig, one after the other."""

    def __init__(self, rig: Rig, station: Station) -> None:
        self.rig = rig
        self._station = station

    def ring(self) -> list[Recording]:
        """Touch the ring, so often at each of its feeds."""
        rig = self.rig
        return [
            self._station.touch(
                rig.ring,
                rig.ring_directions,
                np.full(len(rig.ring_directions), feed_mm_min),
                runs=rig.ring_runs,
            )
            for feed_mm_min in rig.ring_feeds_mm_min
        ]

    def survey(self, feed_mm_min: FloatArray, *, runs: int) -> Survey:
        """Map the trigger radii at a feed for each direction."""
        rig = self.rig
        recording = self._station.touch(rig.target, rig.directions, feed_mm_min, runs=runs)
        return evaluate(recording, feed_mm_min)


def ring_radii_um(rings: Sequence[Recording]) -> FloatArray:
    """Give the mean trigger radius of each run on the ring; shape (feeds, runs)."""
    return np.array(
        [
            [firmware.fit(points, firmware.Shape.CIRCLE).radius_um for points in ring.points_um]
            for ring in rings
        ]
    )


def delay(rings: Sequence[Recording], feeds_mm_min: Sequence[float]) -> firmware.Tau:
    """Find the delay: the slope of the ring's mean trigger radius over the feed, run by run."""
    radii_um = ring_radii_um(rings)
    feeds = np.repeat(feeds_mm_min, radii_um.shape[1])
    return firmware.estimate_tau(feeds, radii_um.ravel(), rings[0].target.side)


def pretravels_um(target: Target, points_um: FloatArray, centre: firmware.Fit) -> FloatArray:
    """Give the radii of n trigger points, shape (n, 3), as pretravels about a centre."""
    nominal_um = target.radius_mm * UM_PER_MM
    radii_um = firmware.radii_um(points_um, centre)
    return np.array([firmware.from_radius_um(r, nominal_um, target.side) for r in radii_um])


def evaluate(recording: Recording, feed_mm_min: FloatArray) -> Survey:
    """Work out the radii of a map."""
    target, points_um = recording.target, recording.points_um
    mean_um = points_um.mean(axis=0)
    centre = firmware.fit(mean_um, firmware.Shape.SPHERE)
    return Survey(
        recording=recording,
        feed_mm_min=feed_mm_min,
        mean_um=pretravels_um(target, mean_um, centre),
        single_um=np.stack(
            [pretravels_um(target, p, firmware.fit(p, firmware.Shape.SPHERE)) for p in points_um]
        ),
        all_um=np.stack([pretravels_um(target, p, centre) for p in points_um]),
    )


def run(
    rig: Rig,
    *,
    seed: int,
    jobs: int = 1,
    path: InputPath = InputPath.SKIP,
    iterations: int = 1,
    table_mm_min: FloatArray | None = None,
) -> Result:
    """Make the whole experiment on a rig.

    Args:
        rig: Which.
        seed: Picks the random numbers.
        jobs: Threads to simulate on.
        path: Which input latches.
        iterations: How often the feeds are worked out and measured again.
        table_mm_min: Feeds to measure at in place of those, shape (n,).

    Raises:
        SimulationError: A touch was not latched, or the firmware's mathematics refuses what was
            measured.
    """
    try:
        return _run(rig, path, seed, jobs, iterations, table_mm_min)
    except firmware.PretravelError as error:
        raise SimulationError(f"{rig.title}: {error}") from error


def _run(
    rig: Rig, path: InputPath, seed: int, jobs: int, iterations: int, table: FloatArray | None
) -> Result:
    def session(nominal: Nominal, seat: Seat | None) -> Session:
        return Session(rig, Station(nominal, seat, path=path, seed=seed, jobs=jobs))

    noisy = session(rig.nominal, rig.seat)
    rings = noisy.ring()
    tau = delay(rings, rig.ring_feeds_mm_min)
    constant = np.full(len(rig.directions), rig.feed_mm_min)
    before = noisy.survey(constant, runs=rig.runs)
    if table is None:
        after = _iterated(noisy, before, tau.tau_ms, iterations)
    else:
        after = noisy.survey(table, runs=rig.runs)
    silent = _with_probe(rig.nominal, repeatability_um=0.0)
    even = _with_probe(rig.nominal, pretravel_um=EVEN_PRETRAVEL_UM)
    return Result(
        rig=rig,
        rings=rings,
        tau=tau,
        before=before,
        after=after,
        time_increase=firmware.time_increase(constant, after.feed_mm_min),
        systematic_before_um=session(silent, rig.seat).survey(constant, runs=1).vr_um,
        systematic_after_um=session(silent, rig.seat).survey(after.feed_mm_min, runs=1).vr_um,
        floor_um=session(even, None).survey(constant, runs=rig.runs).vr_um,
    )


def _iterated(session: Session, before: Survey, tau_ms: float, iterations: int) -> Survey:
    target_um = float(before.mean_um.mean())
    survey = before
    for _ in range(iterations):
        survey = session.survey(
            feeds(session.rig, survey, tau_ms, target_um), runs=session.rig.runs
        )
    return survey


def feeds(rig: Rig, survey: Survey, tau_ms: float, target_um: float) -> FloatArray:
    """Give the feeds at which every direction has the same radius; shape (n,)."""
    plan = firmware.Plan(
        tau_ms=tau_ms,
        target=firmware.Target.GIVEN,
        target_um=target_um,
        speed_max_mm_min=FEED_MAX_MM_MIN,
        accel_mm_s2=rig.nominal.axis.accel_mm_s2,
        approach_mm=float(rig.target.approach_mm(rig.directions.unit).min()),
    )
    return firmware.speed_table(survey.mean_um, survey.feed_mm_min, plan).speed_mm_min


def _with_probe(nominal: Nominal, **changes: float) -> Nominal:
    return replace(nominal, probe=replace(nominal.probe, **changes))
