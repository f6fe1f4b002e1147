"""An experiment as files: campaigns, radii and speeds, as somebody would have recorded them.

The control knows one figure of a probe: how far past the surface the tip goes. Before compensation
the engineer has it from the mean pretravel and the delay. After it, pretravel and delay add up to
the same in all directions at whatever feed the table gives, so it is that figure and no delay.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Nominal, Touches, write_campaign
from skiplatch.compensation import firmware
from skiplatch.compensation.columns_csv import ALPHA, BETA, FEED, RADIUS, RUN
from skiplatch.compensation.experiment import (
    Result,
    Survey,
    pretravels_um,
    ring_radii_um,
)
from skiplatch.compensation.formats import read_table
from skiplatch.compensation.probe_map import Readings, map_of
from skiplatch.compensation.touching import Directions, Recording
from skiplatch.files import atomic_write_text
from skiplatch.units import US_PER_MS

BEFORE = "before"
AFTER = "after"
RADII_BEFORE = "radii_before.csv"
RADII_AFTER = "radii_after.csv"
SPEEDS = "speeds.csv"


def record(folder: Path, result: Result) -> None:
    """Write the campaigns `before`, ring and map, and `after`, the map at the table's feeds.

    Beside them stand the radii of both maps, and what the ring says of the delay, as `skiplatch
    compensate` reads them.

    Raises:
        InputError: A folder or a file cannot be written.
    """
    touches = _joined([*(_about_own_centre(ring) for ring in result.rings), _map(result.before)])
    tau_ms = result.tau.tau_ms
    way_um = firmware.pretravel_um(0.0, result.rig.feed_mm_min, tau_ms)
    pretravel_um = float(result.before.mean_um.mean()) - way_um
    write_campaign(folder / BEFORE, _believed(result, pretravel_um, tau_ms), touches)
    after_um = float(result.after.mean_um.mean())
    write_campaign(folder / AFTER, _believed(result, after_um, 0.0), _map(result.after))
    atomic_write_text(folder / RADII_BEFORE, _radii_csv(result.before))
    atomic_write_text(folder / RADII_AFTER, _radii_csv(result.after))
    atomic_write_text(folder / SPEEDS, _speeds_csv(result))


def read_feeds(path: Path, directions: Directions) -> FloatArray:
    """Read a table of feeds for the n directions of a rig; shape (n,).

    Raises:
        InputError: The file is wrong, or it has no feed for a direction.
    """
    n = len(directions)
    nothing = np.zeros(n, dtype=np.int64)
    readings = Readings(
        directions.alpha_deg, directions.beta_deg, nothing, np.zeros(n), path, nothing
    )
    wanted = map_of(readings, outside=False)
    return read_table(path, wanted)[wanted.cell_of]


def _radii_csv(survey: Survey) -> str:
    """Give the radii less that of the artefact itself: they grow with the pretravel."""
    directions = survey.recording.directions
    runs = len(survey.all_um)
    columns = (
        ALPHA.format(np.tile(directions.alpha_deg, runs)),
        BETA.format(np.tile(directions.beta_deg, runs)),
        RUN.format(np.repeat(np.arange(1, runs + 1), len(directions))),
        RADIUS.format(survey.all_um.ravel()),
    )
    return _csv(("alpha_deg", "beta_deg", "run", "radius_um"), columns)


def _speeds_csv(result: Result) -> str:
    radii_um = ring_radii_um(result.rings)
    feeds, runs = radii_um.shape
    columns = (
        FEED.format(np.repeat(result.rig.ring_feeds_mm_min, runs)),
        RUN.format(np.tile(np.arange(1, runs + 1), feeds)),
        RADIUS.format(radii_um.ravel()),
    )
    return _csv(("feed_mm_min", "run", "mean_radius_um"), columns)


def _csv(header: Sequence[str], columns: Sequence[Iterable[str]]) -> str:
    lines = [header, *zip(*columns, strict=True)]
    return "".join(",".join(line) + "\n" for line in lines)


def _about_own_centre(ring: Recording) -> Touches:
    mean_um = ring.points_um.mean(axis=0)
    centre = firmware.fit(mean_um, firmware.Shape.CIRCLE)
    return ring.about(pretravels_um(ring.target, mean_um, centre))


def _map(survey: Survey) -> Touches:
    return survey.recording.about(survey.mean_um)


def _believed(result: Result, pretravel_um: float, tau_ms: float) -> Nominal:
    """Give the chain of somebody who knows one figure for all directions."""
    nominal = result.rig.nominal
    latch_us = nominal.input.filter_us + nominal.skip.latency_us + nominal.skip.jitter_us / 2.0
    delay_us = max(tau_ms * US_PER_MS - latch_us, 0.0)
    return replace(
        nominal,
        probe=replace(
            nominal.probe, pretravel_um=round(pretravel_um, 3), delay_us=round(delay_us, 1)
        ),
    )


def _joined(parts: Sequence[Touches]) -> Touches:
    return Touches.from_columns(
        **{
            name: np.concatenate([part.columns()[name] for part in parts])
            for name in parts[0].columns()
        }
    )
