"""Touches without end on a bench: one path, one feed, edges at random times."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import (
    AxisNominal,
    BenchNominal,
    InputNominal,
    InputPath,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
    Touches,
)
from skiplatch.campaign.datum import Datum
from skiplatch.latch.effort import Effort
from skiplatch.latch.reaction import reaction_of
from skiplatch.simulator.library import SimulationError
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.units import S_PER_MIN, UM_PER_MM, US_PER_S

NO_PROBE = ProbeNominal(
    pretravel_um=0.0, lobe_um=0.0, lobe_phase_deg=0.0, repeatability_um=0.0, delay_us=0.0
)
DEFAULT_RIG = Nominal(
    kind=Kind.BENCH,
    probe=NO_PROBE,
    input=InputNominal(filter_us=5.0),
    skip=SkipNominal(latency_us=2.0, jitter_us=1.0, tick_us=0.1),
    plc=PlcNominal(scan_us=4000.0),
    axis=AxisNominal(resolution_um=0.01, accel_mm_s2=3000.0),
    report=ReportNominal(latency_us=0.0, jitter_us=0.0),
    bench=BenchNominal(reference_jitter_us=0.0),
)

CHUNK_TOUCHES = 65_536  # in memory at once
STEADY_MM = 1.0  # at the feed before the contact
SEARCH_MM = 1.0  # past the latest latch
STARTS, SURFACES = (), (1,)
"""Lanes of random numbers."""
MOST_COUNTS = 2**28  # of the axis, in the firmware


def on_bench(nominal: Nominal) -> Nominal:
    """Take the probe away, so that nothing but the input is late."""
    datum = Datum.of_kind(Kind.BENCH)
    return replace(nominal, kind=Kind.BENCH, probe=NO_PROBE, datum=datum, version=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Probing:
    """One way to probe, which can be repeated at will."""

    nominal: Nominal
    controller: Controller
    path: InputPath
    feed_mm_min: float
    """Of the measuring touch."""
    approach_mm: float

    def __post_init__(self) -> None:
        travel_mm = self.approach_mm + self.controller.overtravel_mm
        resolution_um = self.nominal.axis.resolution_um
        if travel_mm * UM_PER_MM / resolution_um >= MOST_COUNTS:
            raise SimulationError(
                f"{travel_mm:.4g} mm of travel are too many counts of {resolution_um:g} µm each"
            )

    @property
    def feed_um_us(self) -> float:
        """The feed in µm/µs, which is also in mm/ms."""
        return self.feed_mm_min / S_PER_MIN / 1e3

    def at(self, start_s: FloatArray, first_touch: int = 0) -> Touches:
        """Give touches, numbered from `first_touch`, that start at these times, shape (n,)."""
        n = len(start_s)
        return Touches.from_columns(
            touch=first_touch + np.arange(n),
            time_s=start_s,
            path=np.full(n, self.path),
            feed_mm_min=np.full(n, self.feed_mm_min),
            approach_mm=np.full(n, self.approach_mm),
        )

    def play(
        self,
        touches: Touches,
        *,
        seed: int,
        jobs: int = 1,
        pulse_us: float = 0.0,
        off_line_um: FloatArray | float = 0.0,
    ) -> Outcomes:
        """Play touches of this kind; the outcomes are of shape (1, n).

        Args:
            touches: Which.
            seed: Picks their random numbers.
            jobs: Threads.
            pulse_us: See `skiplatch.simulator.playing.play`.
            off_line_um: How far past a line of the axis the surface is; shape (n,) or one for all.
        """
        outcomes = play(
            self.nominal,
            self.controller,
            touches,
            seed=seed,
            jobs=jobs,
            pulse_us=pulse_us,
            datum_um=off_line_um,
        )
        return replace(outcomes, deviation_um=outcomes.deviation_um - off_line_um)

    def outcomes(self, effort: Effort, *, pulse_us: float = 0.0) -> Iterator[Outcomes]:
        """Play so many touches, a chunk at a time, their edges spread evenly over the scan.

        Each starts at a random time in a scan of its own, and its surface lies anywhere between
        two lines of the axis. The firmware of a touch that begins before the end of the one before
        is set up anew, so that they are independent.
        """
        for first in range(0, effort.touches, CHUNK_TOUCHES):
            yield self.chunk(effort, first, pulse_us=pulse_us)

    def chunk(self, effort: Effort, first: int, *, pulse_us: float = 0.0) -> Outcomes:
        """Play the chunk that begins with this touch; no other chunk has to be played for it."""
        count = min(CHUNK_TOUCHES, effort.touches - first)
        scan_s = self.nominal.plc.scan_us / US_PER_S
        starts = self._drawn(effort, first, count, STARTS)
        surfaces = self._drawn(effort, first, count, SURFACES) - 0.5
        return self.play(
            self.at(scan_s * (np.arange(count) + starts), first),
            seed=effort.seed,
            jobs=effort.jobs,
            pulse_us=pulse_us,
            off_line_um=self.nominal.axis.resolution_um * surfaces,
        )

    def _drawn(self, effort: Effort, first: int, count: int, lane: tuple[int, ...]) -> FloatArray:
        """Give numbers from 0 to 1 of touches, shape (count,), whichever chunk they are in."""
        source = np.random.PCG64((effort.seed, self.path, *lane)).advance(first)
        return np.random.Generator(source).random(count)

    def latched(self, effort: Effort) -> Iterator[Outcomes]:
        """Play as `outcomes` does, where every touch has to be latched and its cycle to end well.

        Raises:
            SimulationError: One was not.
        """
        return map(all_latched, self.outcomes(effort))


def all_latched(outcomes: Outcomes) -> Outcomes:
    """Pass on what was played; raises SimulationError if a touch failed."""
    failed = int(np.count_nonzero(outcomes.error))
    if failed:
        code = int(outcomes.error[outcomes.error != 0][0])
        raise SimulationError(
            f"the firmware refused or failed {failed} of {outcomes.error.size} touches "
            f"(touch_error_t {code}): the rig or the feed is out of its range"
        )
    return outcomes


def one_touch(nominal: Nominal, path: InputPath, feed_mm_min: float) -> Probing:
    """Probe with one touch that has reached its feed before the contact."""
    speed_mm_s = feed_mm_min / S_PER_MIN
    ramp_mm = speed_mm_s**2 / (2.0 * nominal.axis.accel_mm_s2)
    latest_mm = speed_mm_s * reaction_of(nominal, path).latest_us / US_PER_S
    return Probing(
        nominal=nominal,
        controller=Controller(overtravel_mm=latest_mm + ramp_mm + SEARCH_MM),
        path=path,
        feed_mm_min=feed_mm_min,
        approach_mm=ramp_mm + STEADY_MM,
    )


def chunks(effort: Effort) -> int:
    """Tell how many chunks so many touches are played in."""
    return -(-effort.touches // CHUNK_TOUCHES)
