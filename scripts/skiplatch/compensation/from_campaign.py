"""A recorded campaign as a map and as runs at several feeds.

The deviation of a touch is its overtravel past the nominal surface: pretravel, the delay at its
speed, and an error of the artefact's position, which the best-fit centre takes away. So it grows
with the pretravel on any artefact. The delay is all that lies between contact and latch:
transducer, transmission, filter and latch.
"""

import warnings
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.campaign import TOUCHES_FILE, Campaign, InputPath, Touches
from skiplatch.compensation import firmware
from skiplatch.compensation.delay import Delay
from skiplatch.compensation.probe_figures import about_centre
from skiplatch.compensation.probe_map import ProbeMap, Readings, map_of
from skiplatch.compensation.speeds import Speeds
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.motion import expected_contact
from skiplatch.units import S_PER_MIN

DECIMALS = 3  # of an angle in touches.csv
SAME_SPEED = 1e-9
FEWEST_FEEDS = 2


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """Touches of a campaign that have a direction, in the order of time; arrays of shape (k,).

    Attributes:
        readings: Deviations; what is called a run there is not numbered yet.
        feed_mm_min: Feed of each.
        direction: Number of the direction of each.
        feed: Number of the feed of each, from the slowest.
    """

    readings: Readings
    feed_mm_min: FloatArray
    direction: IndexArray
    feed: IndexArray

    def select(self, rows: BoolArray, run: IndexArray) -> "Recorded":
        """Give the rows of a mask, shape (k,), with the runs they belong to, shape (k,)."""
        old = self.readings
        readings = Readings(
            old.alpha_deg[rows],
            old.beta_deg[rows],
            run[rows],
            old.radius_um[rows],
            old.path,
            old.line[rows],
        )
        return Recorded(readings, self.feed_mm_min[rows], self.direction[rows], self.feed[rows])

    @property
    def _touched(self) -> IndexArray:
        """How often each direction was touched at each feed; shape (directions, feeds)."""
        shape = (int(self.direction.max()) + 1, int(self.feed.max()) + 1)
        place = np.ravel_multi_index((self.direction, self.feed), shape)
        return np.bincount(place, minlength=shape[0] * shape[1]).reshape(shape)

    def speeds(self) -> Speeds:
        """Give the mean of each run over the directions that were touched at every feed.

        Raises:
            InputError: There is one feed only, or no such direction.
        """
        touched = self._touched
        feeds = touched.shape[1]
        if feeds < FEWEST_FEEDS:
            message = f"expected several feeds, got only {self.feed_mm_min[0]:g} mm/min"
            raise self._fault("feed_mm_min", f"{message}: tau is a slope; or give --tau")
        everywhere = touched.min(axis=1) > 0
        if not everywhere.any():
            message = f"no direction was touched at all of the {feeds} feeds; give --tau"
            raise self._fault("feed_mm_min", message)
        runs = int(touched[everywhere].min())
        nth = _occurrence(self.direction * feeds + self.feed)
        rows = everywhere[self.direction] & (nth < runs)
        part = self.select(rows, self.feed * runs + nth)
        numbers, first, of_run = np.unique(
            part.readings.run, return_index=True, return_inverse=True
        )
        total_um = np.bincount(of_run, part.readings.radius_um, len(numbers))
        mean_um = total_um / np.bincount(of_run)
        return Speeds(part.feed_mm_min[first], mean_um, False, self.readings.path)

    def probe_map(self, delay: Delay, feed_mm_min: float, *, fit_centre: bool) -> ProbeMap:
        """Give the map at one feed.

        It is made of all touches, brought to that feed by the delay, if every direction was touched
        at every feed or none at that one; else of those at that feed.

        Args:
            delay: The delay.
            feed_mm_min: The feed.
            fit_centre: Whether the centre of the artefact is the best-fit one.

        Raises:
            InputError: Directions are missing.
        """
        here = self.feed_mm_min == feed_mm_min
        whole = bool((self._touched > 0).all()) or not here.any()
        used = self._repeated(np.ones_like(here) if whole else here)
        to_feed = np.full(len(used.feed_mm_min), feed_mm_min)
        at_feed_um = firmware.predict_um(
            used.readings.radius_um, used.feed_mm_min, to_feed, delay.tau_ms
        )
        return _map_of(replace(used.readings, radius_um=at_feed_um), fit_centre=fit_centre)

    def as_measured(self, *, fit_centre: bool) -> ProbeMap:
        """Give the map at the feeds as they were: of touches made with a table.

        Raises:
            InputError: Directions are missing.
        """
        used = self._repeated(np.ones_like(self.feed_mm_min, dtype=np.bool_))
        return _map_of(used.readings, fit_centre=fit_centre)

    def _repeated(self, rows: BoolArray) -> "Recorded":
        """Give equally many repeats of each direction.

        A direction with half of the usual repeats or fewer is left out; of the others, what goes
        beyond the fewest.
        """
        part = self.select(rows, self.readings.run)
        counts = np.bincount(part.direction, minlength=int(self.direction.max()) + 1)
        usual = int(np.argmax(np.bincount(counts[counts > 0])))
        runs = int(counts[2 * counts > usual].min())
        nth = _occurrence(part.direction)
        kept = (nth < runs) & (counts[part.direction] >= runs)
        if not kept.all():
            message = (
                f"{int((~kept).sum())} touches are no part of the map, in which each direction "
                f"has {runs} repeats"
            )
            warning = CampaignWarning(self.readings.path, None, None, message)
            warnings.warn(warning, stacklevel=3)
        return part.select(kept, nth + 1)

    def _fault(self, column: str, message: str) -> InputError:
        return InputError(self.readings.path, None, column, message)


def _map_of(readings: Readings, *, fit_centre: bool) -> ProbeMap:
    found = map_of(readings, outside=False)
    if not fit_centre:
        return found
    shift_um = about_centre(found) - (found.mean_um - found.mean_um.mean())
    centred = replace(readings, radius_um=readings.radius_um + shift_um[found.cell_of])
    return map_of(centred, outside=False)


def recorded(campaign: Campaign, path: InputPath | None = None) -> Recorded:
    """Take what a compensation needs from a campaign.

    Args:
        campaign: Of a machine.
        path: The input path whose touches count; None for the skip input, or for the only one.

    Raises:
        InputError: There are no such touches with a direction, or a feed is not reached within the
            approach.
    """
    touches = _usable(campaign, path).in_order_of_time()
    _refuse_ramps(campaign, touches)
    alpha_deg = np.round(touches.alpha_deg, DECIMALS) % 360.0
    beta_deg = np.round(touches.beta_deg, DECIMALS)
    keys = np.column_stack([alpha_deg, beta_deg])
    direction = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
    feed = np.unique(touches.feed_mm_min, return_inverse=True)[1].ravel()
    nothing = np.zeros(len(touches), dtype=np.int64)
    readings = Readings(
        alpha_deg=alpha_deg,
        beta_deg=beta_deg,
        run=nothing,
        radius_um=touches.deviation_um,
        path=campaign.path / TOUCHES_FILE,
        line=nothing,
    )
    return Recorded(readings, touches.feed_mm_min, direction, feed)


def _usable(campaign: Campaign, path: InputPath | None) -> Touches:
    file = campaign.path / TOUCHES_FILE
    touches = campaign.touches
    ok = touches.ok & ~np.isnan(touches.deviation_um)
    if not ok.any():
        raise InputError(file, None, "deviation_um", "expected recorded deviations, got none")
    if path is None:
        path = InputPath.SKIP if (ok & touches.on_skip).any() else InputPath.PLC
    ok &= touches.path == path
    directed = ok & ~np.isnan(touches.alpha_deg) & ~np.isnan(touches.beta_deg)
    if not directed.any():
        message = f"expected {path.name.lower()} touches with a direction, got none"
        raise InputError(file, None, "alpha_deg", message)
    below = directed & (touches.beta_deg < 0.0)
    if below.any():
        serial = touches.touch[below][0]
        message = f"touch {serial}: expected a number from 0 to 90, the half that a map has"
        raise InputError(file, None, "beta_deg", message)
    return touches.select(directed)


def _refuse_ramps(campaign: Campaign, touches: Touches) -> None:
    """Refuse a touch that had not reached its feed yet: its speed is not what was programmed."""
    reached = expected_contact(campaign.nominal, touches).speed_mm_s * S_PER_MIN
    slow = reached < touches.feed_mm_min * (1.0 - SAME_SPEED)
    if slow.any():
        row = int(np.flatnonzero(slow)[0])
        message = (
            f"touch {touches.touch[row]}: the ramp to {touches.feed_mm_min[row]:g} mm/min is "
            f"longer than the approach of {touches.approach_mm[row]:g} mm"
        )
        raise InputError(campaign.path / TOUCHES_FILE, None, "approach_mm", message)


def _occurrence(cell: NDArray[np.intp]) -> NDArray[np.intp]:
    """Tell for each row, shape (k,), how many of the same cell come before it."""
    order = np.argsort(cell, kind="stable")
    starts = np.flatnonzero(np.diff(cell[order], prepend=-1))
    lengths = np.diff(np.append(starts, len(cell)))
    nth = np.empty_like(cell)
    nth[order] = np.arange(len(cell)) - np.repeat(starts, lengths)
    return nth
