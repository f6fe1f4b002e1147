"""How well touches of one surface repeat, with nothing believed of the rig.

What repeats is the deviation in µm, of rotary axes in arcsec; on a bench without motion, the time
from edge to latch in µs.

Deviations are held against the middle of their surface, and one straight line each in the number
of the touch, or in its time, and in the feed is fitted to all of them together. A line that is not
shown is not taken out, and first touches of a series that are not told from the others are touches
like them. Outliers do not enter. Each input path has figures of its own: a PLC task scatters by its
scan.
"""

from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Axis, Campaign, InputPath, Touches
from skiplatch.campaign.session_names import HOMING, begun_by
from skiplatch.drifts import FEWEST_FREE, Warmth, by_temperature, course_of, with_drift
from skiplatch.errors import InputError
from skiplatch.reversal import Reversal, reversal_of
from skiplatch.settled import first_off, is_shown, settle
from skiplatch.statistics import Interval
from skiplatch.succession import InARow, in_a_row
from skiplatch.surface_fit import Grid, by_t, grid_of
from skiplatch.tables import counted
from skiplatch.touched_often import beyond_firsts, often, surfaces_of, what_repeats
from skiplatch.units import ARCSEC_PER_MILLIDEGREE

PER_MS = {"µm": 1.0 / 60.0, "arcsec": 3.6 / 60.0, "µs": 1.0 / 60.0}
"""A mm/min in µm/ms, a deg/min in arcsec/ms; on a bench that has a feed, what a µm would be."""
FEWEST_AFTER_FIRST = 4
HIDING = 0.6  # of a step; a scatter below it is the rounding's own, 1/√12, and little more


@dataclass(frozen=True, slots=True, eq=False)
class Repeatability:
    """What repeated touches show.

    Attributes:
        touches: Serial numbers of the n touches, in their order.
        unit: Of all figures, ``µm``, ``arcsec`` or ``µs``.
        off: Each less the middle of its surface and feed; shape (n,).
        surfaces: How many surfaces were touched.
        mean: Of the touches that `sigma` is of.
        sigma: Standard deviation about middles and the lines that are shown, without outliers.
        plain: Standard deviation of all touches about the means of their surfaces, by n - 1.
        range: Widest range of a surface.
        first: How far the first touches of series are off the others; None for want of any.
        drift: From touch to touch, along the approach; None where the order tells nothing.
        axis_drift: From touch to touch, of the coordinate, which touches from either side see with
            opposite signs; None where all have one sense.
        warmth: How touches go with each thermometer that moves, by its name.
        in_a_row: How touches scatter that follow each other on one surface; None for want of any.
        reversal: Of an axis at rest; None where none was met in both senses at any position.
        slope: Against the feed in ms: a delay; None where there is one feed.
        outliers: Serial numbers.
        step: What figures are multiples of, if they are.
        told: Which of ``first``, ``order``, ``axis`` and ``speed`` are shown and no rounding: the
            first touches, the drifts and the slope. Only these are taken out of `sigma`.
        coordinate: Of the axis that all moved; empty where there are several.
        sense: In which all moved it, 1 or -1; 0 where it is not known or differs.
        feeds_are_apart: Whether feeds differ, but from surface to surface alone.
        touches_per_h: Where drifts go with time, by which they are turned into those an hour;
            None where they go by the number of the touch.
        is_directed: Whether any sense is known; where none is, positive is a larger coordinate.
        missed: Touches that were not latched; they enter no figure.
        false: Latches without a contact; likewise.
    """

    touches: tuple[int, ...]
    unit: str
    off: FloatArray
    surfaces: int
    mean: Interval
    sigma: Interval
    plain: float
    range: float
    first: Interval | None
    drift: Interval | None
    axis_drift: Interval | None
    warmth: dict[str, Warmth]
    in_a_row: InARow | None
    reversal: Reversal | None
    slope: Interval | None
    outliers: tuple[int, ...]
    step: float | None
    told: frozenset[str]
    coordinate: str
    sense: int
    feeds_are_apart: bool = False
    touches_per_h: float | None = None
    is_directed: bool = True
    missed: int = 0
    false: int = 0

    @property
    def per_kelvin(self) -> dict[str, Interval]:
        """How much touches drift a kelvin, by the name of each thermometer that moves."""
        return {name: warmth.slope for name, warmth in self.warmth.items()}

    @property
    def warmest(self) -> str:
        """The thermometer that leaves least of the scatter, of those shown; else empty."""
        told = {name: w.sigma.value for name, w in self.warmth.items() if w.is_told}
        return min(told, key=lambda name: told[name], default="")

    @property
    def sigma_without_temperature(self) -> Interval | None:
        """What the warmest thermometer leaves; None where none is shown."""
        return self.warmth[self.warmest].sigma if self.warmest else None

    @property
    def is_limited_by_resolution(self) -> bool:
        """Whether the step of the positions hides the scatter."""
        if self.sigma.value == 0.0:
            return True
        return self.step is not None and self.sigma.value < HIDING * self.step


def by_path(campaign: Campaign) -> dict[InputPath, Repeatability]:
    """Work it out for each input path that tells anything, the skip input first.

    Raises:
        InputError: No surface was touched often enough, or no deviation was recorded.
    """
    touches = campaign.touches
    paths = [path for path in InputPath if (touches.path == path).any()]
    if len(paths) <= 1:
        return {path: repeatability(campaign) for path in paths or [InputPath.SKIP]}
    found, refused = {}, []
    for path in paths:
        try:
            own = replace(campaign, touches=touches.select(touches.path == path))
            found[path] = repeatability(own)
        except InputError as error:
            refused.append(error)
    if not found:
        raise refused[0]
    return found


def _homed(touches: Touches) -> str:
    """Say how many sessions an importer began after homing; nothing where it began none."""
    homed = {begun_by(name, HOMING) for name in touches.session_names} - {None}
    if not homed:
        return ""
    return f": homing began {counted(len(homed), 'session')}, and touches are compared within one"


def repeatability(campaign: Campaign) -> Repeatability:
    """Work it out for all touches together.

    Raises:
        InputError: No surface was touched often enough, or no deviation was recorded.
    """
    ordered = campaign.touches.in_order_of_time()
    unit, values = what_repeats(ordered)
    known = ~np.isnan(values) & ~ordered.false
    touches, values = ordered.select(known), values[known]
    surface = surfaces_of(touches)
    often_touched = often(surface)
    if beyond_firsts(surface) < FEWEST_FREE:
        message = "expected a surface that was touched 3 times, or two that were twice, got "
        message += "one that was twice" if often_touched.any() else "none that was"
        message += _homed(touches)
        raise InputError(campaign.path, None, None, message)
    touches, surface = touches.select(often_touched), surface[often_touched]
    surface = np.unique(surface, return_inverse=True)[1].ravel()
    grid = grid_of(values[often_touched], touches.axis, _resolution(campaign, unit))
    at_rest = campaign.nominal.datum.is_at_rest
    worked_out = _of(touches, values[often_touched], surface, unit, grid, at_rest=at_rest)
    return replace(worked_out, missed=int(ordered.missed.sum()), false=int(ordered.false.sum()))


def _resolution(campaign: Campaign, unit: str) -> float:
    """Give what the rig is believed to tell apart, in the unit of the figures."""
    nominal = campaign.nominal
    if unit == "µs":
        return nominal.skip.tick_us
    return nominal.axis.resolution_um * (ARCSEC_PER_MILLIDEGREE if unit == "arcsec" else 1.0)


def _of(
    touches: Touches,
    y: FloatArray,
    surface: np.typing.NDArray[np.intp],
    unit: str,
    grid: Grid,
    *,
    at_rest: bool,
) -> Repeatability:
    is_first = _firsts(touches, surface)
    dummies = (surface[:, None] == np.arange(surface.max() + 1)).astype(float)
    speed = touches.feed_mm_min * PER_MS[unit]
    conditions = {"speed": speed} if _varies_within(speed, surface) else {}
    course = course_of(touches, y, dummies, conditions, ~is_first, grid)
    lines = with_drift(course, conditions, touches.sign)
    first = first_off(y, dummies, lines, is_first, grid)
    freedom = int((~is_first).sum()) - dummies.shape[1]
    is_off = first is not None and is_shown(first, freedom) and abs(first.value) > grid.finest(y)
    rows = ~is_first if is_off else np.ones(len(y), dtype=bool)
    found = settle(y, dummies, lines, rows, ~is_first, grid)
    regular, fit = found.regular, found.fit
    beside = {name: x for name, x in conditions.items() if name in fit.lines}
    return Repeatability(
        touches=tuple(touches.touch.tolist()),
        unit=unit,
        off=fit.residuals + sum(fit.part(name, lines[name]) for name in lines if name != "speed"),
        surfaces=dummies.shape[1],
        mean=_mean(y[regular]),
        sigma=fit.sigma,
        plain=_plain(y, dummies),
        range=max(float(np.ptp(y[surface == s])) for s in range(dummies.shape[1])),
        first=first,
        drift=found.intervals.get("order"),
        axis_drift=found.intervals.get("axis"),
        feeds_are_apart=_are_apart(speed, surface) and not at_rest and unit != "µs",
        touches_per_h=course.per_h,
        warmth=by_temperature(touches, y, dummies, beside, regular),
        in_a_row=in_a_row(fit.residuals, surface, regular, fit.sigma.value),
        reversal=reversal_of(touches, y, surface, regular, fit.sigma.value, fit.freedom)
        if at_rest
        else None,
        slope=found.intervals.get("speed"),
        outliers=tuple(touches.touch[_with_pairs(rows & ~regular, surface)].tolist()),
        step=grid.step,
        told=frozenset(fit.lines) | ({"first"} if is_off else set()),
        coordinate=_coordinate(touches),
        sense=_sense(touches),
        is_directed=bool(np.isfinite(touches.sign).any()),
    )


def _with_pairs(far: BoolArray, surface: np.typing.NDArray[np.intp]) -> BoolArray:
    """Add the other touch of a surface that was touched twice: nobody knows which is the one."""
    return np.asarray(far | ((np.bincount(surface) == 2)[surface] & np.isin(surface, surface[far])))


def _coordinate(touches: Touches) -> str:
    axes = np.unique(touches.axis)
    return Axis(int(axes[0])).name if len(axes) == 1 and axes[0] >= 0 else ""


def _sense(touches: Touches) -> int:
    senses = np.unique(touches.sign)
    return int(senses[0]) if len(senses) == 1 and np.isfinite(senses[0]) else 0


def _plain(y: FloatArray, dummies: FloatArray) -> float:
    off = y - dummies @ _means(y, dummies, np.ones(len(y), dtype=bool))
    return float(np.sqrt(np.sum(off**2) / max(len(y) - dummies.shape[1], 1)))


def _firsts(touches: Touches, surface: np.typing.NDArray[np.intp]) -> BoolArray:
    """Tell the first touch of each series of one surface and feed, if enough follow it."""
    feed = np.nan_to_num(touches.feed_mm_min, nan=-1.0)
    begins = np.ones(len(surface), dtype=bool)
    begins[1:] = (np.diff(surface) != 0) | (np.diff(feed) != 0)
    starts = np.flatnonzero(begins)
    lengths = np.diff(np.append(starts, len(surface)))
    firsts = np.zeros(len(surface), dtype=bool)
    firsts[starts[lengths > FEWEST_AFTER_FIRST]] = True
    return firsts


def _varies_within(values: FloatArray, surface: np.typing.NDArray[np.intp]) -> bool:
    if np.isnan(values).any():
        return False
    return any(np.ptp(values[surface == s]) > 0.0 for s in range(int(surface.max()) + 1))


def _are_apart(values: FloatArray, surface: np.typing.NDArray[np.intp]) -> bool:
    known = values[np.isfinite(values)]
    return len(np.unique(known)) > 1 and not _varies_within(values, surface)


def _means(y: FloatArray, dummies: FloatArray, rows: BoolArray) -> FloatArray:
    count = np.maximum(dummies[rows].sum(axis=0), 1.0)
    means: FloatArray = (dummies[rows].T @ y[rows]) / count
    return means


def _mean(y: FloatArray) -> Interval:
    error = float(np.std(y, ddof=1) / np.sqrt(len(y)))
    return by_t(float(y.mean()), error, len(y) - 1)
