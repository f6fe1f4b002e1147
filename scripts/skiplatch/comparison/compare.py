"""Replay a recorded campaign in the nominal simulation and measure the gap."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, DatumFreedom, InputPath, Nominal, Touches
from skiplatch.comparison.cells import cells_of
from skiplatch.comparison.gap import (
    adjusted_p_values,
    distance_to,
    mean_interval,
    quantiles_of,
    spread_interval,
)
from skiplatch.comparison.model import DEFAULT_ALPHA, Cell, CellGap, Comparison, Missed
from skiplatch.comparison.observables import ALL_OBSERVABLES, Observable, Recorded
from skiplatch.motion import Contact, expected_contact
from skiplatch.progress import shown
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.statistics import proportion

REFERENCE_REPLICATES = 100
MOST_REPLICATES = 999
FEWEST_REPLICATES = 199
SIMULATED_TOUCHES = 20_000_000  # over all replicates, where a campaign is large
BATCH_TOUCHES = 1_000_000  # in memory at once
FEWEST_TOUCHES = 5  # in a cell

FLOOR_QUANTILE = 0.95


class _Replay:
    """Plays a campaign's conditions in the nominal simulation, again and again."""

    def __init__(self, nominal: Nominal, touches: Touches, seed: int, jobs: int) -> None:
        self._nominal = nominal
        self._controller = Controller.for_campaign(nominal, touches)
        self._touches = touches
        self._seed = seed
        self._jobs = jobs

    def play(self, first: int, replicates: int) -> Outcomes:
        return play(
            self._nominal,
            self._controller,
            self._touches,
            seed=self._seed,
            first_replicate=first,
            replicates=replicates,
            jobs=self._jobs,
        )

    def batches(self, first: int, replicates: int) -> Iterator[Outcomes]:
        """Play a few replicates at a time."""
        size = max(1, BATCH_TOUCHES // len(self._touches))
        starts = range(0, replicates, size)
        for start in shown(starts, len(starts), "replicates"):
            yield self.play(first + start, min(size, replicates - start))


def compare(
    campaign: Campaign, *, seed: int, jobs: int = 1, alpha: float = DEFAULT_ALPHA
) -> Comparison:
    """Hold a recorded campaign against the nominal simulation of the same conditions.

    Args:
        campaign: What was recorded.
        seed: Of the simulation.
        jobs: Threads.
        alpha: False-alarm rate over all cells together.
    """
    touches = campaign.touches.in_order_of_time()
    contact = expected_contact(campaign.nominal, touches)
    replay = _Replay(campaign.nominal, touches, seed, jobs)
    reference = replay.play(0, _reference_size(len(touches)))
    is_feed_known = "feed_mm_min" not in campaign.stood_in
    cells = _cells(touches, reference, contact, is_feed_known=is_feed_known)
    replicates = int(np.clip(SIMULATED_TOUCHES // len(touches), FEWEST_REPLICATES, MOST_REPLICATES))
    gaps = _gaps(cells, _replicate_distances(cells, replay, replicates, contact)) if cells else []
    return Comparison(
        cells=cells,
        gaps=gaps,
        missed=[_missed(touches, path) for path in InputPath if (touches.path == path).any()],
        replicates=replicates,
        alpha=alpha,
        is_datum_free=campaign.nominal.datum.free is not DatumFreedom.NONE,
    )


def _reference_size(touches: int) -> int:
    return int(np.clip(2 * BATCH_TOUCHES // touches, 20, REFERENCE_REPLICATES))


def _cells(
    touches: Touches, simulated: Outcomes, contact: Contact, *, is_feed_known: bool
) -> list[Cell]:
    cells = []
    for observable in ALL_OBSERVABLES:
        mine = touches.turns == observable.is_rotary
        if not mine.any():
            continue
        recorded = observable.values(touches, contact)
        reference = observable.values(simulated, contact)
        known = mine & ~np.isnan(recorded) & ~np.isnan(reference).any(axis=0)
        for path, feed, rows in cells_of(touches, known, FEWEST_TOUCHES):
            cell = _cell(observable, path, feed, rows, recorded, reference)
            cells.append(replace(cell, is_feed_known=is_feed_known))
    return cells


def _cell(
    observable: Observable,
    path: InputPath,
    feed_mm_min: float,
    rows: NDArray[np.intp],
    recorded: FloatArray,
    reference: FloatArray,
) -> Cell:
    expected = reference[:, rows].mean(axis=0)
    return Cell(
        observable=observable,
        path=path,
        feed_mm_min=feed_mm_min,
        rows=rows,
        recorded=recorded[rows] - expected,
        reference=reference[:, rows] - expected,
        expected=expected,
    )


def _replicate_distances(
    cells: Sequence[Cell], replay: _Replay, replicates: int, contact: Contact
) -> FloatArray:
    """Distances of further replicates from the reference, shape (replicates, cells)."""
    quantiles = [quantiles_of(cell.reference) for cell in cells]
    first = MOST_REPLICATES  # beyond those of the reference
    parts = [
        _distances(cells, quantiles, outcomes, contact)
        for outcomes in replay.batches(first, replicates)
    ]
    return np.concatenate(parts)


def _distances(
    cells: Sequence[Cell], quantiles: Sequence[FloatArray], outcomes: Recorded, contact: Contact
) -> FloatArray:
    """Distances of recorded or simulated touches from the reference, shape (…, cells)."""
    values = {cell.observable: cell.observable.values(outcomes, contact) for cell in cells}
    return np.stack(
        [
            distance_to(quantile, values[cell.observable][..., cell.rows] - cell.expected)
            for cell, quantile in zip(cells, quantiles, strict=True)
        ],
        axis=-1,
    )


def _gaps(cells: Sequence[Cell], floors: FloatArray) -> list[CellGap]:
    distances = np.array([distance_to(quantiles_of(c.reference), c.recorded) for c in cells])
    p_values = adjusted_p_values(distances, floors)
    limits = np.quantile(floors, FLOOR_QUANTILE, axis=0)
    return [
        CellGap(
            observable=cell.observable,
            path=cell.path,
            feed_mm_min=cell.feed_mm_min,
            is_feed_known=cell.is_feed_known,
            touches=len(cell.rows),
            recorded_mean=float((cell.recorded + cell.expected).mean()),
            simulated_mean=float(cell.expected.mean()),
            recorded_spread=float(cell.recorded.std()),
            simulated_spread=float(cell.reference.std()),
            mean_difference=mean_interval(cell.recorded),
            spread_difference=spread_interval(cell.recorded, float(cell.reference.std())),
            distance=float(distance),
            noise_floor=float(limit),
            p_value=float(p_value),
        )
        for cell, distance, limit, p_value in zip(cells, distances, limits, p_values, strict=True)
    ]


def _missed(touches: Touches, path: InputPath) -> Missed:
    here = touches.path == path
    missed, total = int((touches.missed & here).sum()), int(here.sum())
    return Missed(path=path, missed=missed, touches=total, share=proportion(missed, total))
