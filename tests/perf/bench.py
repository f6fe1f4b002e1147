"""``make bench``: how fast the simulation is, beside a bare loop and beside SimPy, in one run.

Then how fast a probe is compensated, see ``compensation_bench``, and how fast the diagnosis is,
beside pyABC, see ``diagnosis_bench``. Then how fast a fleet is kept, see ``fleet_bench``, and
spread over workers, see ``spread_bench``, and how fast the firmware measures transmission error,
see ``transmission_bench``.

Absolute times depend on the machine and on its mood. What counts are the ratios of things timed in
turn, and their medians.
"""

import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import compensation_bench
import diagnosis_bench
import fleet_bench
import numpy as np
import simpy_chain
import spread_bench
import transmission_bench

from skiplatch.campaign import InputPath, Nominal, Touches, read_nominal
from skiplatch.simulator.library import CData, connection, declarations, layout
from skiplatch.simulator.playing import touch_rows
from skiplatch.simulator.rig import Controller, filled_rig

ROOT = Path(__file__).parents[2]
FLOOR_LIBRARY = ROOT / "build" / "perf" / "libfloor.so"
FLOOR_HEADER = ROOT / "tests" / "perf" / "floor.h"
NOMINAL = ROOT / "scripts" / "samples" / "machine_no_gap" / "nominal.toml"

TOUCHES = 400_000
SIMPY_TOUCHES = 1_000
ROUNDS = 7
SEED = 1
GAP_S = 20.0  # from touch to touch: more than the slowest cycle

AIMS = {
    ("skip", "floor"): "at most 3",
    ("plc", "floor"): "at most 4",
    ("skip", "simpy"): "at least 200",
    ("plc", "simpy"): "at least 200",
}


class Timed:
    """One thing to time: the seconds per touch of each round."""

    def __init__(self, run: Callable[[], object], touches: int) -> None:
        self.run = run
        self.touches = touches
        self.seconds: list[float] = []

    def time_once(self) -> None:
        start = time.perf_counter()
        self.run()
        self.seconds.append((time.perf_counter() - start) / self.touches)

    def over(self, other: "Timed") -> float:
        """Median of the ratios, round by round, of the time of this one to that of another."""
        return median(a / b for a, b in zip(self.seconds, other.seconds, strict=True))

    @property
    def rate(self) -> float:
        """Touches per second, in the median."""
        return 1.0 / median(self.seconds)


def conditions(n: int, path: InputPath) -> Touches:
    """Random feeds, directions and instants; in order of time."""
    rng = np.random.default_rng(SEED)
    return Touches.from_columns(
        touch=np.arange(n),
        time_s=GAP_S * (np.arange(n) + 0.5 * rng.random(n)),
        path=np.full(n, path),
        feed_mm_min=rng.choice([100.0, 300.0, 1000.0, 3000.0], n),
        approach_mm=rng.uniform(2.0, 4.0, n),
        alpha_deg=rng.uniform(0.0, 360.0, n),
        beta_deg=rng.choice([0.0, 30.0, 60.0], n),
    )


class Rows:
    """The touches as the C side wants them, so that no Python is in what is timed."""

    def __init__(self, nominal: Nominal, touches: Touches) -> None:
        self.ffi, self.library = connection()
        self.n = len(touches)
        controller = Controller.for_campaign(nominal, touches)
        self.rig = filled_rig(nominal, controller, seed=SEED)
        self._touches = touch_rows(nominal, touches, 0.0)
        self._outcomes = np.zeros(self.n, dtype=layout("sim_outcome_t"))
        self.touches = self.ffi.from_buffer("sim_touch_t[]", self._touches)
        self.outcomes = self.ffi.from_buffer("sim_outcome_t[]", self._outcomes)

    def play(self, n: int, jobs: int) -> None:
        self.library.sim_play(
            self.rig.structure,
            self.touches,
            n,
            1,
            jobs,
            self.outcomes,
        )

    def floor(self, library: CData) -> None:
        library.floor_play(self.rig.chain, self.touches, self.n, SEED, self.outcomes)


def floor_library() -> CData:
    """Open the bare loop with the same structures."""
    ffi = connection()[0]
    ffi.cdef(declarations(FLOOR_HEADER))
    return ffi.dlopen(str(FLOOR_LIBRARY))


def bench_path(path: InputPath, nominal: Nominal, floor: CData) -> None:
    """Time everything for one input path, in turn."""
    rows = Rows(nominal, conditions(TOUCHES, path))
    few = conditions(SIMPY_TOUCHES, path)
    ours = Timed(lambda: rows.play(TOUCHES, 1), TOUCHES)
    tenth = Timed(lambda: rows.play(TOUCHES // 10, 1), TOUCHES // 10)
    cores = Timed(lambda: rows.play(TOUCHES, 2), TOUCHES)
    bare = Timed(lambda: rows.floor(floor), TOUCHES)
    general = Timed(lambda: simpy_chain.play(nominal, few, SEED), SIMPY_TOUCHES)
    everything = (ours, tenth, cores, bare, general)
    for _ in range(ROUNDS):
        for timed in everything:
            timed.time_once()

    name = path.name.lower()
    sizes = f"{TOUCHES:,} touches over {TOUCHES // 10:,}"
    print(f"{name} path, medians of {ROUNDS} rounds")
    print(f"  firmware in the loop {ours.rate:14,.0f} touches/s on one core")
    print(f"  (a) bare loop        {bare.rate:14,.0f} touches/s on one core")
    print(f"  (b) SimPy            {general.rate:14,.0f} touches/s on one core")
    print(f"  time of a touch, ours over (a) {ours.over(bare):9.2f}   aim: {AIMS[name, 'floor']}")
    print(
        f"  time of a touch, (b) over ours {general.over(ours):9.0f}   aim: {AIMS[name, 'simpy']}"
    )
    print(f"  time of a touch, {sizes} {ours.over(tenth):.2f}   aim: 1")
    print(f"  speed, two cores over one {ours.over(cores):14.2f}   aim: 2")


def main() -> None:
    """Run the benchmarks: both paths, compensation, diagnosis, fleet, transmission error."""
    nominal = read_nominal(NOMINAL)
    floor = floor_library()
    for path in InputPath:
        bench_path(path, nominal, floor)
    compensation_bench.bench_compensation()
    diagnosis_bench.bench_diagnosis()
    fleet_bench.bench_fleet()
    spread_bench.bench_spread()
    transmission_bench.bench_transmission()


if __name__ == "__main__":
    main()
