"""The shrink on touches that were held back, beside that of an oracle that knows the truth.

The score is the CRPS of the recorded touches under many plays of a simulation. A touch of the skip
path is scored against its own plays, one of the PLC path against those of all touches of its path
and feed. Where stamps were recorded they tell the phase of the scans, and all plays may know it.
Without stamps nobody who has to predict can, and the plays of the oracle and of the unchanged chain
have a phase of their own each time: those at the phase of the record would repeat, on the same
touches, the very waits that they are scored on.

What was recorded is one draw of the truth, and some plays of the oracle are further ones: scored on
all of them, a ratio depends less on the luck of some eighty touches.
"""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scoringrules import crps_ensemble  # type: ignore[import-untyped]

from tests.withheld.chain import BoolArray, FloatArray
from tests.withheld.sealed import HeldBack
from tests.withheld.streams import Expected, Played, begin_us, cells, residuals

SCORED = ("deviation", "latch", "report")
FEWEST_TOUCHES = 3  # of a cell
DRAWS = 10  # plays of the oracle that are scored beside what was recorded, and not by the oracle
MOST_POOLED = 1_000  # plays against which a touch of the PLC is scored
ROUNDING = 1 / 6  # of a step: the score of what is known but for its rounding
LEAST_GAP = 0.05  # of the score, below which the gap is too small to say how much of it is gone


def read_predictions(path: Path, expected: Expected) -> Mapping[str, FloatArray]:
    """Read what ``skiplatch predict`` wrote: residuals by stream, shape (replicates, n)."""
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    n = len(expected.speed_um_us)

    def column(name: str) -> FloatArray:
        values = [float(row[name] or "nan") for row in rows]
        return np.array(values, np.float64).reshape(-1, n)

    played = Played(column("latch_us"), column("report_us"), column("deviation_um"))
    begin = expected.contact_us if expected.machine else column("edge_us")
    return residuals(expected, played, begin)


def shrink_to_oracle(
    held_back: HeldBack, diagnosed: Mapping[str, FloatArray], rng: np.random.Generator
) -> float:
    """Give the diagnosis's shrink over the oracle's: 1 predicts as well as the truth.

    Every cell of path, feed and stream counts by its touches, in units of the oracle's score, so
    that the wide ones of the PLC do not drown the narrow ones. NaN where even the oracle hardly
    scores better than the unchanged chain: an effect that only loses touches, or one that moves the
    PLC's scans by little of their period.
    """
    sealed = (
        (held_back.unchanged, held_back.oracle)
        if "latch" in held_back.recorded
        else (held_back.unchanged_any_phase, held_back.oracle_any_phase)
    )
    # All count from the same edges: whoever predicts is given them, noise of the reading and all.
    begin = begin_us(held_back.expected, held_back.touches)
    unchanged, oracle = (residuals(held_back.expected, plays, begin) for plays in sealed)
    tick = held_back.nominal.skip.tick_us
    steps = {"deviation": held_back.nominal.axis.resolution_um, "latch": tick, "report": tick}
    gained = possible = whole = 0.0
    for stream in [s for s in SCORED if s in held_back.recorded]:
        for rows in cells(held_back.touches):
            truths = np.vstack([held_back.truth[stream], oracle[stream][:DRAWS]])
            scores = [
                _score(held_back, stream, rows, truths, plays, rng)
                for plays in (unchanged[stream], diagnosed[stream], oracle[stream][DRAWS:])
            ]
            if scores[0] is None or scores[1] is None or scores[2] is None:
                continue
            weight = np.count_nonzero(rows) / max(scores[2], ROUNDING * steps[stream])
            gained += weight * (scores[0] - scores[1])
            possible += weight * (scores[0] - scores[2])
            whole += weight * scores[0]
    return float(gained / possible) if possible > LEAST_GAP * whole else float("nan")


def _score(
    held_back: HeldBack,
    stream: str,
    rows: BoolArray,
    truths: FloatArray,
    plays: FloatArray,
    rng: np.random.Generator,
) -> float | None:
    """Mean CRPS of the touches of a cell, or None if there are too few.

    Args:
        held_back: The touches.
        stream: Whose residuals these are.
        rows: The cell, shape (n,).
        truths: What became of the touches, shape (draws, n).
        plays: Of a simulation, shape (replicates, n).
        rng: Draws from the plays of a cell.
    """
    scale = np.ones(truths.shape[1])
    if stream == "deviation" and held_back.expected.plc[rows].all():
        scale = held_back.expected.speed_um_us  # a cell may have several feeds
    rows = rows & ~np.isnan(truths[0]) & ~np.isnan(plays).all(axis=0)
    if np.count_nonzero(rows) < FEWEST_TOUCHES:
        return None
    seen, ensemble = truths[:, rows] / scale[rows], (plays[:, rows] / scale[rows]).T
    ensemble = np.where(np.isnan(ensemble), np.nanmedian(ensemble, axis=1)[:, None], ensemble)
    if held_back.expected.plc[rows].all():
        ensemble = pooled(ensemble, rng)
    scores = [crps_ensemble(one, ensemble, estimator="pwm", backend="numpy") for one in seen]
    return float(np.nanmean(scores))


def pooled(ensemble: FloatArray, rng: np.random.Generator, most: int = MOST_POOLED) -> FloatArray:
    """Give every touch, shape (n, …), the same draw from the plays of all; shape (n, pooled)."""
    drawn = rng.choice(ensemble.ravel(), min(most, ensemble.size), replace=False)
    return np.broadcast_to(drawn, (len(ensemble), len(drawn)))
