"""How fast a probe's map and its speed table are computed, with the tables for the controller."""

import time
from collections.abc import Callable
from statistics import median

import numpy as np

from skiplatch.compensation.firmware import Plan, speed_table
from skiplatch.compensation.radius_map import Map

AZIMUTHS = np.arange(0.0, 360.0, 10.0)
ALPHA = np.concatenate([np.tile(AZIMUTHS, 3), [0.0]])
BETA = np.concatenate([np.repeat([0.0, 30.0, 60.0], len(AZIMUTHS)), [90.0]])
RUNS = 10
ROUNDS = 21
AIM_MS = 50.0
DIVISIONS = 16
SEED = 1


def readings() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Three lobes and noise, run after run; three arrays of shape (1090,)."""
    rng = np.random.default_rng(SEED)
    lobes = 20.0 + 4.3 * np.cos(np.radians(3.0 * ALPHA)) * np.cos(np.radians(BETA))
    radii = lobes + rng.normal(0.0, 0.5, (RUNS, len(ALPHA)))
    return np.tile(ALPHA, RUNS), np.tile(BETA, RUNS), radii.ravel()


def _median_ms(run: Callable[[], object]) -> float:
    taken = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        run()
        taken.append(1e3 * (time.perf_counter() - begin))
    return median(taken)


def bench_compensation() -> None:
    """Time everything and print it."""
    alpha, beta, radii = readings()
    plan = Plan(tau_ms=12.68)

    def map_and_table() -> np.ndarray:
        found = Map.from_readings(alpha, beta, radii)
        found.check()
        return speed_table(found.radius_um, 50.0, plan).speed_mm_min

    found, speeds = Map.from_readings(alpha, beta, radii), map_and_table()
    table_ms = _median_ms(map_and_table)
    lookup_ms = _median_ms(lambda: found.lookup(speeds, divisions=DIVISIONS))
    print(f"compensation of a probe, {len(ALPHA)} points, {RUNS} runs, medians of {ROUNDS} rounds")
    print(f"  map and speed table  {table_ms:14.2f} ms   aim: at most {AIM_MS:.0f}")
    print(f"  controller's table   {lookup_ms:14.2f} ms, M = {DIVISIONS}")


if __name__ == "__main__":
    bench_compensation()
