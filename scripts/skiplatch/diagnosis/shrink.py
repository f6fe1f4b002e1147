"""How far the gap shrinks, on touches that served neither fitting nor naming.

The simulator decides: the held-out touches are played with and without the effects, and the
distance of the recorded ones from both is measured per path and feed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.campaign import InputPath
from skiplatch.comparison.gap import RESOLVABLE, distance_to, quantiles_of
from skiplatch.comparison.observables import OBSERVABLES, Observable
from skiplatch.diagnosis.law import FloatArray
from skiplatch.diagnosis.scene import BoolArray, Scene
from skiplatch.simulator import Controller, Effect, Outcomes, play
from skiplatch.statistics import CONFIDENCE, Interval

PLAYED_TOUCHES = 40_000
FEWEST_REPLICATES = 16
MOST_REPLICATES = 100
FEWEST_TOUCHES = 3  # in a cell
RESAMPLES = 199


@dataclass(frozen=True, slots=True)
class Gap:
    """The gap of one observable before and after, in its unit."""

    unit: str
    before: float
    after: float
    noise_floor: float
    """The distance of the simulation with the effects from itself."""
    shrink: Interval
    """Share of what lay above the noise floor that is gone."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cell:
    """Held-out touches of one path and feed: residuals from both simulations and quantiles."""

    before: FloatArray
    after: FloatArray
    floor: FloatArray
    quantiles_before: FloatArray
    quantiles_after: FloatArray


def shrink(
    scene: Scene, held_out: BoolArray, switched_on: Sequence[Effect], *, seed: int, jobs: int
) -> Mapping[str, Gap]:
    """Measure every observable that was recorded; by name."""
    nominal = _play(scene, (), seed, jobs)
    changed = _play(scene, switched_on, seed, jobs)
    gaps = {}
    for observable in OBSERVABLES:
        cells = _cells(scene, held_out, observable, nominal, changed)
        if cells:
            gaps[observable.name] = _gap(observable.unit, cells, seed)
    return gaps


def _play(scene: Scene, switched_on: Sequence[Effect], seed: int, jobs: int) -> Outcomes:
    replicates = int(np.clip(PLAYED_TOUCHES // len(scene), FEWEST_REPLICATES, MOST_REPLICATES))
    return play(
        scene.nominal,
        Controller.for_campaign(scene.nominal, scene.touches),
        scene.touches,
        seed=seed,
        replicates=replicates,
        jobs=jobs,
        switched_on=switched_on,
    )


def _cells(
    scene: Scene,
    held_out: BoolArray,
    observable: Observable,
    nominal: Outcomes,
    changed: Outcomes,
) -> list[_Cell]:
    recorded = observable.values(scene.touches, scene.contact)
    before = observable.values(nominal, scene.contact)
    after = observable.values(changed, scene.contact)
    known = held_out & ~np.isnan(recorded)
    cells = []
    for path in InputPath:
        for feed in np.unique(scene.touches.feed_mm_min):
            rows = known & (scene.touches.path == path) & (scene.touches.feed_mm_min == feed)
            if rows.sum() >= FEWEST_TOUCHES:
                cells.append(_cell(recorded[rows], before[:, rows], after[:, rows]))
    return cells


def _cell(recorded: FloatArray, before: FloatArray, after: FloatArray) -> _Cell:
    mean_before, mean_after = np.nanmean(before, axis=0), np.nanmean(after, axis=0)
    after = np.where(np.isnan(after), mean_after, after)
    before = np.where(np.isnan(before), mean_before, before)
    return _Cell(
        before=recorded - mean_before,
        after=recorded - mean_after,
        floor=after - mean_after,
        quantiles_before=quantiles_of(before - mean_before),
        quantiles_after=quantiles_of(after - mean_after),
    )


def _gap(unit: str, cells: Sequence[_Cell], seed: int) -> Gap:
    before = np.array([distance_to(cell.quantiles_before, cell.before) for cell in cells])
    after = np.array([distance_to(cell.quantiles_after, cell.after) for cell in cells])
    floor = np.array([distance_to(cell.quantiles_after, cell.floor).mean() for cell in cells])
    # By its own noise, so that the wide cells of the PLC do not drown the narrow ones.
    weights = np.array([len(cell.before) for cell in cells]) / np.maximum(floor, RESOLVABLE)
    weights = weights / weights.sum()
    value = _share(float(weights @ before), float(weights @ after), float(weights @ floor))
    rng = np.random.default_rng(seed)
    resampled = [_resampled(cells, weights, float(weights @ floor), rng) for _ in range(RESAMPLES)]
    edge = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(resampled, [edge, 1.0 - edge])
    return Gap(
        unit=unit,
        before=float(weights @ before),
        after=float(weights @ after),
        noise_floor=float(weights @ floor),
        shrink=Interval(value, float(low), float(high)),
    )


def _resampled(
    cells: Sequence[_Cell], weights: FloatArray, floor: float, rng: np.random.Generator
) -> float:
    before, after = [], []
    for cell in cells:
        rows = rng.integers(0, len(cell.before), len(cell.before))
        before.append(distance_to(cell.quantiles_before, cell.before[rows]))
        after.append(distance_to(cell.quantiles_after, cell.after[rows]))
    return _share(float(weights @ np.array(before)), float(weights @ np.array(after)), floor)


def _share(before: float, after: float, floor: float) -> float:
    """Share of the gap above the floor that is gone; 0 where there was none."""
    above = before - floor
    if above <= 0.0:
        return 0.0
    return float(np.clip((before - max(after, floor)) / above, -1.0, 1.0))
