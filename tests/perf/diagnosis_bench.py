"""How fast the diagnosis is, and how a general tool fares at the same task.

The general tool is pyABC: approximate Bayesian computation with sequential Monte Carlo, choosing
among a handful of effects with the same simulator. The diagnosis chooses among all of them.
"""

import logging
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import (
    Axis,
    InputPath,
    Nominal,
    Status,
    Touches,
    read_campaign,
    read_nominal,
    write_campaign,
)
from skiplatch.diagnosis import diagnose
from skiplatch.simulator.effects import Effect, effects
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

pyabc: Any
try:
    pyabc = import_module("pyabc")
except ImportError:  # scripts/requirements-bench.lock is not installed
    pyabc = None

Model = Callable[[Mapping[str, float]], dict[str, FloatArray]]
SKIPLATCH = Path(sys.executable).with_name("skiplatch")
NOMINAL = Path(__file__).parents[2] / "scripts" / "samples" / "machine_no_gap" / "nominal.toml"
SEED = 1
JOBS = 2
SMALL, LARGE = 400, 100_000
ROUNDS = 3
AIMS_S = {SMALL: 5, LARGE: 60}

# What pyABC chooses among, and the ranges of its priors; the planted ones lie within.
PRIORS: Mapping[str, Mapping[str, tuple[float, float]]] = {
    "trigger_delay": {"delay_us": (-400.0, 400.0)},
    "isr_latency": {"latency_us": (0.0, 400.0), "jitter_us": (0.0, 100.0)},
    "following_error": {"lag_us": (-400.0, 400.0)},
    "backlash": {"backlash_um": (-20.0, 20.0)},
    "scale_error": {"scale_ppm": (-200.0, 200.0)},
}
PLANTED = (
    Effect("trigger_delay", {"delay_us": 60.0}),
    Effect("isr_latency", {"latency_us": 50.0, "jitter_us": 20.0}),
    Effect("backlash", {"backlash_um": 2.0}),
    Effect("scale_error", {"scale_ppm": 15.0}),
)
PARTICLES = 100
GENERATIONS = 6
MOST_SIMULATIONS = 8_000


def conditions(n: int) -> Touches:
    """Random feeds, directions, positions and instants of a machine, in order of time."""
    rng = np.random.default_rng(SEED)
    sign = rng.choice([-1.0, 1.0], n)
    return Touches.from_columns(
        touch=np.arange(n),
        time_s=10.0 * np.arange(n) + rng.random(n),
        path=rng.choice([InputPath.SKIP, InputPath.PLC], n),
        axis=np.full(n, Axis.X),
        sign=sign,
        alpha_deg=np.where(sign > 0, 0.0, 180.0),
        beta_deg=np.zeros(n),
        feed_mm_min=rng.choice([100.0, 300.0, 1000.0, 3000.0], n),
        approach_mm=rng.uniform(2.0, 4.0, n),
        position_mm=rng.uniform(-200.0, 200.0, n),
        temp_c=20.0 + rng.normal(0.0, 0.5, n),
    )


def played(nominal: Nominal, touches: Touches, effect: Effect, seed: int) -> Touches:
    """Play a campaign with one effect."""
    controller = Controller.for_campaign(nominal, touches)
    outcomes = play(nominal, controller, touches, seed=seed, switched_on=[effect], jobs=JOBS)
    columns = touches.columns()
    for name in ("latch_us", "report_us", "deviation_um"):
        columns[name] = getattr(outcomes, name)[0]
    columns["status"] = np.where(outcomes.ok[0], Status.OK, Status.MISSED)
    return Touches.from_columns(**columns)


def time_diagnosis(campaign: Path) -> float:
    """Seconds of a whole `skiplatch diagnose`, with its start."""
    command = [str(SKIPLATCH), "diagnose", str(campaign), "--jobs", str(JOBS)]
    begin = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def bench_sizes(nominal: Nominal, folder: Path) -> None:
    """Time a small and a large campaign."""
    effect = Effect("trigger_delay", {"delay_us": 60.0})
    print(f"skiplatch diagnose, whole catalogue, {JOBS} processes")
    for touches, rounds in ((SMALL, ROUNDS), (LARGE, 1)):
        path = folder / f"touches_{touches}"
        write_campaign(path, nominal, played(nominal, conditions(touches), effect, SEED))
        seconds = median(time_diagnosis(path) for _ in range(rounds))
        print(f"  {touches:7,} touches {seconds:9.1f} s   aim: at most {AIMS_S[touches]} s")


# ---- the general tool ----------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Task:
    """One recorded campaign, as approximate Bayesian computation sees it."""

    nominal: Nominal
    touches: Touches

    def summary(self, touches: Touches) -> FloatArray:
        """Means and spreads by path, feed and sense, in units of their own spread below."""
        figures = []
        for path in InputPath:
            for feed in np.unique(touches.feed_mm_min):
                for sign in (-1.0, 1.0):
                    rows = (touches.path == path) & (touches.feed_mm_min == feed)
                    figures += _figures(touches.select(rows & (touches.sign == sign)))
        return np.array(figures)

    def simulate(self, effect: Effect, rng: np.random.Generator) -> FloatArray:
        """Play the same touches with an effect, and sum that up."""
        seed = int(rng.integers(2**31))
        return self.summary(played(self.nominal, self.touches, effect, seed))


def _figures(touches: Touches) -> list[float]:
    """Mean and spread of deviation and latch, and how the deviation goes with the position."""
    moved_s = touches.latch_us * 1e-6 - touches.time_s
    deviation = touches.deviation_um
    place = touches.position_mm - touches.position_mm.mean()
    slope = float(place @ (deviation - deviation.mean()) / (place @ place))
    level = moved_s - 60.0 * touches.approach_mm / touches.feed_mm_min  # s, without the way
    latch_ms = level * 1e3
    return [deviation.mean(), deviation.std(), latch_ms.mean(), latch_ms.std(), 100.0 * slope]


def name_with_pyabc(task: Task, folder: Path) -> str:
    """Let pyABC choose among the effects; gives the most probable one."""
    rng = np.random.default_rng(SEED)
    scale = _scatter(task, rng)

    def distance(a: Mapping[str, FloatArray], b: Mapping[str, FloatArray]) -> float:
        return float(np.sqrt(np.mean(((a["y"] - b["y"]) / scale) ** 2)))

    def model(effect_id: str) -> Model:
        def run(parameters: Mapping[str, float]) -> dict[str, FloatArray]:
            return {"y": task.simulate(Effect(effect_id, dict(parameters)), rng)}

        return run

    search = pyabc.ABCSMC(
        [model(effect_id) for effect_id in PRIORS],
        [_prior(ranges) for ranges in PRIORS.values()],
        distance,
        population_size=PARTICLES,
        sampler=pyabc.sampler.SingleCoreSampler(),
    )
    search.new(f"sqlite:///{folder / 'abc.db'}", {"y": task.summary(task.touches)})
    history = search.run(max_nr_populations=GENERATIONS, max_total_nr_simulations=MOST_SIMULATIONS)
    return list(PRIORS)[int(history.get_model_probabilities(history.max_t)["p"].idxmax())]


def _prior(ranges: Mapping[str, tuple[float, float]]) -> object:
    uniform = {name: pyabc.RV("uniform", low, high - low) for name, (low, high) in ranges.items()}
    return pyabc.Distribution(**uniform)


def _scatter(task: Task, rng: np.random.Generator) -> FloatArray:
    """How much each figure scatters when nothing is switched on."""
    nothing = Effect("trigger_delay", {"delay_us": 0.0})
    figures = np.array([task.simulate(nothing, rng) for _ in range(20)])
    return np.asarray(np.maximum(figures.std(axis=0), 1e-6))


def bench_general(nominal: Nominal, folder: Path) -> None:
    """Let both name the effects of a few campaigns."""
    ours, theirs = [], []
    for i, effect in enumerate(PLANTED):
        touches = played(nominal, conditions(SMALL), effect, SEED + 1 + i)
        path = folder / f"planted_{i}"
        write_campaign(path, nominal, touches)
        task = Task(nominal, read_campaign(path).touches)
        ours.append((*_timed(partial(_name, path)), effect.id))
        theirs.append((*_timed(partial(name_with_pyabc, task, folder)), effect.id))
    print(f"naming one of {len(PLANTED)} planted effects, {SMALL} touches, one process")
    for title, results, among in (
        ("skiplatch", ours, len(effects())),
        ("pyABC", theirs, len(PRIORS)),
    ):
        right = sum(truth in named for named, _, truth in results)
        seconds = median(took for _, took, _ in results)
        print(f"  {title:9} {right}/{len(results)} right among {among:2}, {seconds:6.1f} s each")
    ratio = median(b[1] / a[1] for a, b in zip(ours, theirs, strict=True))
    print(f"  time, pyABC over skiplatch {ratio:8.1f}")


def _name(path: Path) -> str:
    """Give what the diagnosis names, or the group if it cannot tell."""
    found = diagnose(read_campaign(path), seed=SEED)
    return " ".join(i for n in found.effects for i in (n.effect.id, *n.alternatives))


def _timed(run: Callable[[], str]) -> tuple[str, float]:
    begin = time.perf_counter()
    result = run()
    return result, time.perf_counter() - begin


def bench_diagnosis() -> None:
    """Run everything."""
    nominal = read_nominal(NOMINAL)
    with tempfile.TemporaryDirectory() as temporary:
        bench_sizes(nominal, Path(temporary))
        if pyabc is None:
            print("naming an effect beside pyABC: skipped, pyABC is not installed")
            return
        logging.getLogger("ABC").setLevel(logging.ERROR)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            bench_general(nominal, Path(temporary))


if __name__ == "__main__":
    bench_diagnosis()
