"""Mean trigger radii at several feeds, from which the delay follows."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.compensation import firmware
from skiplatch.compensation.columns_csv import FEED, RADIUS, RUN, Rows, read_columns

COLUMNS = {"feed_mm_min": FEED, "run": RUN, "mean_radius_um": RADIUS}
FEWEST_RUNS = 3
"""Of two a line says nothing of its own uncertainty."""


@dataclass(frozen=True, slots=True, eq=False)
class Speeds:
    """Runs at several feeds.

    Attributes:
        feed_mm_min: Shape (n,).
        radius_um: Mean trigger radius as it was measured; shape (n,).
        outside: Whether outside of a sphere, where the radius falls as the feed grows.
        path: Where they were read.
    """

    feed_mm_min: FloatArray
    radius_um: FloatArray
    outside: bool
    path: Path

    @property
    def side(self) -> firmware.Side:
        """Which sign pretravel has in the radius."""
        return firmware.Side.OUTSIDE if self.outside else firmware.Side.INSIDE


def read_speeds(path: Path, *, outside: bool) -> Speeds:
    """Read SPEEDS.csv: feed_mm_min, run, mean_radius_um.

    Raises:
        InputError: The file is wrong, or has one feed only, or fewer than three runs.
    """
    rows = read_columns(path, COLUMNS)
    _refuse_repeats(rows)
    feed_mm_min = rows.values["feed_mm_min"]
    if len(np.unique(feed_mm_min)) == 1:
        message = f"expected several feeds, got only {feed_mm_min[0]:g} mm/min: tau is a slope"
        raise rows.fault(0, "feed_mm_min", message)
    if len(feed_mm_min) < FEWEST_RUNS:
        message = f"expected at least {FEWEST_RUNS} runs, got {len(feed_mm_min)}"
        raise rows.fault(0, "run", message)
    return Speeds(feed_mm_min, rows.values["mean_radius_um"], outside, path)


def _refuse_repeats(rows: Rows) -> None:
    first: dict[tuple[float, int], int] = {}
    pairs = zip(rows.values["feed_mm_min"].tolist(), rows.values["run"].tolist(), strict=True)
    for row, pair in enumerate(pairs):
        if pair in first:
            line = int(rows.lines[first[pair]])
            raise rows.fault(row, "run", f"this feed and run stand already in line {line}")
        first[pair] = row
