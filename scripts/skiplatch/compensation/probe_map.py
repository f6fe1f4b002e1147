"""The map of a probe: trigger radii over directions, with repeats, checked for gaps.

A trigger radius is the distance from the best-fit centre to where the tip was when the probe
triggered. Inside an artefact it grows with the pretravel; outside of one the tip goes on towards
the centre, and it falls. A map holds what grows: a radius measured outside changes its sign, so
that the difference of two is one of pretravels.
"""

import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray, IndexArray
from skiplatch.compensation import firmware
from skiplatch.compensation.columns_csv import ALPHA, BETA, RADIUS, RUN, Rows, read_columns
from skiplatch.compensation.radius_map import Map
from skiplatch.errors import CampaignWarning, InputError

COLUMNS = {"alpha_deg": ALPHA, "beta_deg": BETA, "run": RUN, "radius_um": RADIUS}

TURN_DEG = 360.0
SAME_DEG = 1e-3
MOST_DIRECTIONS = 4096  # 2.3 deg apart over half a sphere; what follows grows with their square
BLOCK_CELLS = 1 << 22  # readings times directions that are held side by side at once
LOBES_NEED = 7
"""Azimuths at the equator: more than two for each of three lobes."""


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """Trigger radii as they were recorded; arrays of shape (k,).

    Attributes:
        alpha_deg: 0 to 360.
        beta_deg: 0 to 90.
        run: Number of the run.
        radius_um: Growing with the pretravel.
        path: File or folder they come from, for messages.
        line: Line of each in that file; 0 where there is none.
    """

    alpha_deg: FloatArray
    beta_deg: FloatArray
    run: NDArray[np.int64]
    radius_um: FloatArray
    path: Path
    line: NDArray[np.int64]

    def fault(self, reading: int, column: str, message: str) -> InputError:
        """Give the error that complains of a reading."""
        return InputError(self.path, int(self.line[reading]) or None, column, message)

    def named(self, reading: int) -> str:
        """Name the direction of a reading in a message."""
        return f"alpha {self.alpha_deg[reading]:g}, beta {self.beta_deg[reading]:g}"


@dataclass(frozen=True)
class ProbeMap:
    """Radii of n directions in m runs, in the order of the firmware's map: by beta, then alpha.

    Attributes:
        cells: The firmware's map, whose radius is the mean of all repeats.
        radius_um: Of each run; shape (n, m).
        outside: Whether it was measured outside of an artefact.
        readings: What it was made of.
        cell_of: The direction of each reading; shape (k,).
    """

    cells: Map
    radius_um: FloatArray
    outside: bool
    readings: Readings
    cell_of: IndexArray

    def __len__(self) -> int:
        return len(self.cells)

    @property
    def runs(self) -> int:
        """Repeats of each direction."""
        return int(self.radius_um.shape[1])

    @property
    def sign(self) -> float:
        """What turns a radius of the map into one as it was measured, and back."""
        return -1.0 if self.outside else 1.0

    @property
    def mean_um(self) -> FloatArray:
        """Mean over the runs; shape (n,)."""
        return self.cells.radius_um

    @cached_property
    def repeatability_um(self) -> float | None:
        """Standard deviation of one touch, pooled over the directions; None of a single run.

        What all directions of a run have in common is its drift and is taken out.
        """
        if self.runs == 1:
            return None
        left = self.radius_um - self.radius_um.mean(axis=1, keepdims=True)
        left = left - left.mean(axis=0, keepdims=True)
        return float(np.sqrt((left**2).sum() / self.freedom))

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the repeatability."""
        return (len(self) - 1) * (self.runs - 1)

    @cached_property
    def listed(self) -> IndexArray:
        """One reading of each direction as it was written, in the order of the file."""
        directions = np.column_stack([self.readings.alpha_deg, self.readings.beta_deg])
        return np.sort(np.unique(directions, axis=0, return_index=True)[1])

    def reading_of(self, cell: int) -> int:
        """Give the first reading of a direction, for a message."""
        return int(np.flatnonzero(self.cell_of == cell)[0])

    def fault(self, cell: int, column: str, message: str) -> InputError:
        """Give the error that complains of a direction."""
        reading = self.reading_of(cell)
        return self.readings.fault(reading, column, f"{self.readings.named(reading)}: {message}")


def read_map(path: Path, *, outside: bool) -> ProbeMap:
    """Read RADII.csv: alpha_deg, beta_deg, run, radius_um.

    Raises:
        InputError: The file is wrong, a direction lacks a run, there are too few directions, or
            directions are missing.
    """
    rows = read_columns(path, COLUMNS)
    _refuse_repeats(rows)
    sign = -1.0 if outside else 1.0
    readings = Readings(
        alpha_deg=rows.values["alpha_deg"],
        beta_deg=rows.values["beta_deg"],
        run=rows.values["run"],
        radius_um=sign * rows.values["radius_um"],
        path=path,
        line=rows.lines,
    )
    return map_of(readings, outside=outside)


def map_of(readings: Readings, *, outside: bool) -> ProbeMap:
    """Sort readings into a map.

    Raises:
        InputError: A direction lacks a run, there are too few directions, or some are missing.
    """
    _refuse_endless(readings)
    cells = Map.from_readings(readings.alpha_deg, readings.beta_deg, readings.radius_um)
    cell_of = _nearest(cells, readings)
    try:
        cells.check()
    except firmware.PretravelError as error:
        raise _incomplete(cells, readings, error) from error
    radius_um = _by_run(readings, len(cells), cell_of)
    found = ProbeMap(cells, radius_um, outside, readings, cell_of)
    _warn_of_hidden_lobes(found)
    return found


def _refuse_endless(readings: Readings) -> None:
    """Raise InputError for more directions than a map is ever measured in."""
    steps = np.round(np.column_stack([readings.alpha_deg, readings.beta_deg]) / SAME_DEG)
    count = len(np.unique(steps, axis=0))
    if count > MOST_DIRECTIONS:
        message = f"{count} directions: a map has at most {MOST_DIRECTIONS}"
        raise readings.fault(0, "alpha_deg", message)


def _incomplete(cells: Map, readings: Readings, error: firmware.PretravelError) -> InputError:
    """Say in the file's terms why a map cannot be used."""
    gap = error.gap
    if gap is None:
        return readings.fault(0, "alpha_deg", f"{error}; got {len(cells)} directions")
    row = np.abs(cells.beta_deg - gap.beta_deg) < SAME_DEG
    steps = np.diff(cells.alpha_deg[row], append=cells.alpha_deg[row][0] + TURN_DEG)
    in_azimuth = gap.width_deg > np.median(steps) + SAME_DEG
    near = np.hypot(readings.alpha_deg - gap.alpha_deg, readings.beta_deg - gap.beta_deg)
    return readings.fault(
        int(np.argmin(near)),
        "alpha_deg" if in_azimuth else "beta_deg",
        f"a gap in the map: no direction for {gap.width_deg:g} deg of "
        f"{'alpha' if in_azimuth else 'beta'} from alpha {gap.alpha_deg:g}, beta {gap.beta_deg:g} "
        "on",
    )


def _warn_of_hidden_lobes(found: "ProbeMap") -> None:
    """Tell of rings whose azimuths may all stand where three lobes are zero, or alike."""
    betas, azimuths = np.unique(found.cells.beta_deg, return_counts=True)
    needed = np.ceil(LOBES_NEED * np.cos(np.radians(betas)))
    few = np.flatnonzero(azimuths < needed)
    if few.size:
        readings, ring = found.readings, few[0]
        message = (
            f"{azimuths[ring]} azimuths at beta {betas[ring]:g} may not show the three lobes of a "
            f"probe; {needed[ring]:g} do"
        )
        warning = CampaignWarning(readings.path, None, "alpha_deg", message)
        warnings.warn(warning, stacklevel=3)


def _nearest(cells: Map, readings: Readings) -> IndexArray:
    """Give the cell of each reading, shape (k,), in blocks that fit into little memory."""
    alpha, beta = readings.alpha_deg, readings.beta_deg
    block = max(1, BLOCK_CELLS // len(cells))
    parts = [slice(at, at + block) for at in range(0, len(alpha), block)]
    return np.concatenate([_nearest_of(cells, alpha[part], beta[part]) for part in parts])


def _nearest_of(cells: Map, alpha_deg: FloatArray, beta_deg: FloatArray) -> IndexArray:
    """Give the cell of each direction, shape (k,); at the pole every azimuth is the same."""
    turn = np.abs(alpha_deg[:, None] - cells.alpha_deg) % TURN_DEG
    azimuth = np.minimum(turn, TURN_DEG - turn) * np.cos(np.radians(cells.beta_deg))
    rise = np.abs(beta_deg[:, None] - cells.beta_deg)
    return np.asarray(np.argmin(azimuth + rise, axis=1))


def _refuse_repeats(rows: Rows) -> None:
    columns = [rows.values[name].tolist() for name in ("alpha_deg", "beta_deg", "run")]
    first: dict[tuple[float, ...], int] = {}
    for row, key in enumerate(zip(*columns, strict=True)):
        if key in first:
            line = int(rows.lines[first[key]])
            raise rows.fault(row, "run", f"this direction and run stand already in line {line}")
        first[key] = row


def _by_run(readings: Readings, directions: int, cell_of: IndexArray) -> FloatArray:
    """Give the radii, shape (directions, runs): the mean where a run has several readings."""
    runs, of_run = np.unique(readings.run, return_inverse=True)
    shape = (directions, len(runs))
    place = np.ravel_multi_index((cell_of, of_run.ravel()), shape)
    count = np.bincount(place, minlength=directions * len(runs)).reshape(shape)
    lacking = np.argwhere(count == 0)
    if lacking.size:
        cell, run = lacking[0]
        reading = int(np.flatnonzero(cell_of == cell)[-1])
        raise readings.fault(
            reading,
            "run",
            f"a gap in the map: {readings.named(reading)} has no run {runs[run]}, "
            "which other directions have",
        )
    total = np.bincount(place, readings.radius_um, directions * len(runs)).reshape(shape)
    return np.asarray(total / count)
