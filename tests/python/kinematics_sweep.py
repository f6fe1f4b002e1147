"""What each mode of cycle 451 leaves on many machines of every type; `make kinematics-sweep`.

Every type is measured twice: as it is, and with one position in thirty wrong, as by a chip.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from measured_machines import ALL_KINDS, described, draw, left_mm, name_of, stations_of
from rotary_machines import Kind, Planted
from skiplatch.commands.kept import Kept
from skiplatch.kinematics.evaluate import evaluate
from skiplatch.kinematics.evaluation import Evaluation
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.stations import Stations
from skiplatch.workers import Workers, in_order, opened

NOISE_MM = 2e-4
SAME_MM = 1e-8
TOUCHES = 2
"""So few that a centre scatters alike in all directions, as the noise here does."""
POSITIONS, ANGLES, ORIGIN = 1, 2, 3
OUTLIERS = 0.03
OUTLIERS_MM = (0.02, 0.2)
"""Least and greatest distance of an outlier from where it belongs."""


@dataclass(frozen=True, slots=True)
class Judged:
    """One machine: what the modes left, and how far the fit is off.

    Attributes:
        more_um: How much more modes 2 and 3 left at the worst axis than mode 1; 0 if not more.
        left_um: What mode 2 left at the worst axis.
        off: Errors of what the positions determine, in standard uncertainties.
    """

    more_um: float
    left_um: float
    off: tuple[float, ...]


def modes_of(kind: Kind) -> tuple[int, ...]:
    """Give the modes that a machine can run: mode 3 needs one axis upon another."""
    stacked = len(kind.table) > 1 or len(kind.head) > 1
    return (POSITIONS, ANGLES, ORIGIN) if stacked else (POSITIONS, ANGLES)


def judge(kind: Kind, seed: int, outliers: float = 0.0) -> Judged:
    """Measure one machine, correct it in every mode, and look with own matrices at what is left."""
    rng = np.random.default_rng(seed)
    planted = draw(kind, rng)
    stations = _with_outliers(stations_of(planted, rng, NOISE_MM), rng, outliers)
    machine = described(planted)
    modes = modes_of(kind)
    found = [evaluate(machine, Truth(), stations, mode, TOUCHES) for mode in modes]
    tip = planted.tip.tolist()
    plain, *angled = (left_mm(kind, tip, one.corrected, stations) for one in found)
    more = max(one[x] - plain[x] for one in angled for x in plain)
    worst = max(angled[0].values())
    return Judged(
        1000.0 * max(0.0, more - SAME_MM), 1000.0 * worst, tuple(_off(planted, found[-1]))
    )


def _with_outliers(stations: Stations, rng: np.random.Generator, share: float) -> Stations:
    """Move this share of the positions in any direction."""
    off_mm = rng.normal(size=stations.centre_mm.shape)
    off_mm *= rng.uniform(*OUTLIERS_MM, (len(off_mm), 1)) / np.linalg.norm(
        off_mm, axis=1, keepdims=True
    )
    hit = rng.random((len(off_mm), 1)) < share
    return replace(stations, centre_mm=stations.centre_mm + hit * off_mm)


def _off(planted: Planted, found: Evaluation) -> list[float]:
    errors = planted.errors
    single = [(e.value - errors[name], e) for name, e in found.fit.parameters.items()]
    sums = [
        (c.estimate.value - sum(a * errors[n] for n, a in c.amounts.items()), c.estimate)
        for c in found.fit.combinations
    ]
    return [off / estimate.uncertainty for off, estimate in [*single, *sums]]


def row_of(kind: Kind, outliers: float, judged: Sequence[Judged]) -> str:
    """Tell the machines of a type in a row of a table."""
    off = np.abs(np.concatenate([one.off for one in judged]))
    more = sum(one.more_um > 0.0 for one in judged)
    left_um = np.median([one.left_um for one in judged])
    cells = (
        name_of(kind),
        f"{100.0 * outliers:g} %",
        f"{more}",
        f"{100.0 * np.mean(off <= 3.0):.2f} %",
        f"{left_um:.2f} µm",
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print a row for each type, with and without outliers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="machines of each type")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--cluster", help="local:N, or the address of a Dask scheduler")
    parser.add_argument("--keep", type=Path, help="folder of what is done; a run goes on from it")
    parser.add_argument("--type", default="", help='only types whose name has this: "head AC"')
    given = parser.parse_args()
    print("| type | outliers | modes 2, 3 leave more | errors within 3u | mode 2 leaves, median |")
    print("|---|---|---|---|---|")
    with opened(Workers(jobs=given.jobs, cluster=given.cluster)) as executor:
        for kind in (kind for kind in ALL_KINDS if given.type in name_of(kind)):
            for outliers in (0.0, OUTLIERS):
                tasks = [(kind, seed, outliers) for seed in range(given.count)]
                names = [f"machine {name_of(kind)} of seed {seed}" for _, seed, _ in tasks]
                judged = list(in_order(executor, judge, tasks, names, Kept(given.keep)))
                print(row_of(kind, outliers, judged), flush=True)


if __name__ == "__main__":
    main()
