"""What in a campaign cannot be as it stands: wrong units, clocks that run backwards, and the like.

Each rule looks at recorded numbers alone, takes milliseconds, and names the touches it is about.
"""

from collections.abc import Callable, Iterator

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign.columns import InputPath
from skiplatch.campaign.far_off import far_from_the_others, surfaces_apart
from skiplatch.campaign.folder import Campaign
from skiplatch.campaign.impossible import (
    latches_before_the_move,
    moves_that_overlap,
    moves_without_time,
    places_beyond_reach,
    swapped_columns,
    temperatures,
    ways_of_axes,
)
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.oddity import Oddity, serials
from skiplatch.campaign.steps import common_step
from skiplatch.campaign.touches import SerialArray, Touches
from skiplatch.units import S_PER_MIN, US_PER_S

FACTORS = {
    1e3: "1000",
    1e-3: "1/1000",
    1e6: "1,000,000",
    1e-6: "1/1,000,000",
    25.4: "25.4",
    1 / 25.4: "1/25.4",
    60.0: "60",
    1 / 60.0: "1/60",
}
"""By which a quantity is off that was written in another unit."""
SLIP = 0.1  # share by which a factor may be missed: an offset shows beside it
FEWEST = 5  # touches before their middle is looked at
MANY_STEPS = 4  # as many different values show a scatter
STAMPS_OF_AN_EDGE = ("time_s", "edge_us")
"""Which two touches share that are one edge, latched by both paths."""

Rule = Callable[[Campaign], "Iterator[Oddity]"]


def oddities(campaign: Campaign) -> list[Oddity]:
    """Find all that is odd, the gravest first."""
    return [oddity for rule in RULES for oddity in rule(campaign)]


def _factor(ratio: float) -> str | None:
    """Give the factor of two units that a ratio is near to."""
    for factor, text in FACTORS.items():
        if abs(ratio / factor - 1.0) < SLIP:
            return text
    return None


def _wrong_unit(name: str, measured: FloatArray, expected: FloatArray, by: str) -> Iterator[Oddity]:
    """Hold a quantity against what it has to be by others; arrays of shape (n,)."""
    known = np.isfinite(measured) & np.isfinite(expected) & (expected != 0.0)
    if known.sum() < FEWEST:
        return
    factor = _factor(float(np.median(measured[known] / expected[known])))
    if factor is not None:
        yield Oddity(f"{name} is {factor} times what {by} let expect: another unit?")


def _slope(y: FloatArray, x: FloatArray) -> float:
    known = np.isfinite(y) & np.isfinite(x)
    if known.sum() < FEWEST or np.ptp(x[known]) == 0.0:
        return np.nan
    return float(np.polyfit(x[known], y[known], 1)[0])


def _clock_units(campaign: Campaign) -> Iterator[Oddity]:
    touches = campaign.touches
    for name in ("edge_us", "latch_us", "report_us"):
        factor = _factor(_slope(getattr(touches, name), touches.time_s * US_PER_S))
        if factor is not None:
            yield Oddity(f"{name} runs {factor} times as fast as time_s: another unit?")
    if np.isnan(touches.time_s).all():
        factor = _factor(_slope(touches.latch_us, touches.edge_us))
        if factor is not None:
            yield Oddity(f"latch_us runs {factor} times as fast as edge_us: another unit?")


def _travel_units(campaign: Campaign) -> Iterator[Oddity]:
    """On a bench the edge tells how long the approach took."""
    touches = campaign.touches
    speed_mm_s = touches.feed_mm_min / S_PER_MIN
    ramp_s = speed_mm_s / (2.0 * campaign.nominal.axis.accel_mm_s2)
    took_s = touches.edge_us / US_PER_S - touches.time_s - ramp_s
    expected_s = touches.approach_mm / speed_mm_s
    yield from _wrong_unit("the time of the approach", took_s, expected_s, "approach_mm and feed")


def _deviation_units(campaign: Campaign) -> Iterator[Oddity]:
    touches = campaign.touches
    way_um = touches.feed_mm_min / S_PER_MIN * (touches.latch_us - touches.edge_us) / 1e3
    resolution = campaign.nominal.axis.resolution_um
    seen = np.abs(way_um) > resolution
    way_um = np.where(seen, way_um, np.nan)
    yield from _wrong_unit("deviation_um", touches.deviation_um, way_um, "latch_us and feed_mm_min")
    step = common_step(touches.deviation_um)
    if ("axis", "resolution_um") in campaign.nominal.unknown or step is None:
        return
    factor = _factor(step / resolution)
    if factor is not None:
        yield Oddity(
            f"deviation_um goes in steps of {step:g}, {factor} times axis.resolution_um = "
            f"{resolution:g}: another unit?"
        )


def _order_of_stamps(campaign: Campaign) -> Iterator[Oddity]:
    touches = campaign.touches
    before = touches.edge_us < touches.time_s * US_PER_S
    if before.any():
        what = "edge_us lies before time_s, when the move began"
        yield Oddity(what, serials(touches, before))
    tick = campaign.nominal.skip.tick_us + 6.0 * campaign.nominal.bench.reference_jitter_us
    for early, late in (("latch_us", "edge_us"), ("report_us", "latch_us")):
        wrong = getattr(touches, early) + tick < getattr(touches, late)
        if campaign.nominal.kind is Kind.BENCH and wrong.any():
            yield Oddity(f"{early} lies before {late}", serials(touches, wrong))


def _times_backwards(campaign: Campaign) -> Iterator[Oddity]:
    """Tell times before that of a touch above, in its session and path: they are taken first."""
    touches = campaign.touches
    known = np.flatnonzero(np.isfinite(touches.time_s))
    if "time_s" in campaign.stood_in or not len(known):
        return
    streams = np.column_stack([touches.session, touches.path])[known]
    _, stream = np.unique(streams, axis=0, return_inverse=True)
    stream = stream.ravel()
    in_streams = known[np.argsort(stream, kind="stable")]
    back = np.zeros(len(touches), dtype=bool)
    for rows in np.split(in_streams, np.cumsum(np.bincount(stream))[:-1]):
        times_s = touches.time_s[rows]
        back[rows] = times_s < np.maximum.accumulate(times_s)
    if back.any():
        what = "time_s runs backwards from row to row; touches are taken in order of time"
        yield Oddity(what, serials(touches, back))


def _backwards(campaign: Campaign) -> Iterator[Oddity]:
    """Tell stamps that go back; of one edge that both paths latch, either may come first."""
    ordered = campaign.touches.in_order_of_time()
    for name in ("edge_us", "latch_us", "report_us"):
        known = ordered.select(np.isfinite(getattr(ordered, name)))
        is_same_session = np.diff(known.session, prepend=known.session[:1]) == 0
        is_same_edge = np.diff(known.edge_us, prepend=np.nan) == 0.0
        is_other_path = np.diff(known.path, prepend=known.path[:1]) != 0
        back = np.diff(getattr(known, name), prepend=-np.inf) < 0
        back &= is_same_session & ~(is_same_edge & is_other_path)
        if back.any():
            yield Oddity(f"{name} runs backwards", serials(known, back))


def _equal_stamps(campaign: Campaign) -> Iterator[Oddity]:
    touches = campaign.touches
    stamps = ("time_s", "edge_us", "latch_us", "report_us")
    for name in (stamp for stamp in stamps if stamp not in campaign.stood_in):
        values = getattr(touches, name)
        known = np.isfinite(values)
        _, first, which, counts = np.unique(
            values[known], return_index=True, return_inverse=True, return_counts=True
        )
        by_both = np.bincount(which, touches.path[known] == InputPath.PLC) == 1
        is_one_edge = by_both & (counts == 2) & (name in STAMPS_OF_AN_EDGE)
        if ((counts > 1) & ~is_one_edge).any():
            repeated = ~is_one_edge[which]
            repeated[first] = False
            rows = np.zeros(len(touches), dtype=bool)
            rows[np.flatnonzero(known)[repeated]] = True
            yield Oddity(f"{name} stands there more than once", serials(touches, rows))


def _no_scatter(campaign: Campaign) -> Iterator[Oddity]:
    """Touches in the same conditions that scatter by nothing or by a step or two."""
    touches = campaign.touches
    for name, unit in (("deviation_um", "µm"), ("deviation_arcsec", "arcsec")):
        values = getattr(touches, name)
        step = common_step(values)
        if step is None and not _is_still(values):
            continue
        for rows in alike(touches, np.isfinite(values)):
            different = len(np.unique(values[rows]))
            apart = round(float(np.ptp(values[rows])) / step) if step else 0
            if len(rows) >= FEWEST and apart + 1 < MANY_STEPS:
                how = f"steps of {step:g}" if step else f"one value, {values[rows[0]]:g}"
                where = (
                    f"{name}: {len(rows)} touches in the same conditions have {different} values"
                )
                found = tuple(touches.touch[rows].tolist())
                yield Oddity(f"{where}, {how} {unit}, which hides their scatter", found)
                break


def _is_still(values: FloatArray) -> bool:
    known = values[np.isfinite(values)]
    return len(known) >= FEWEST and bool((known == known[0]).all())


def alike(touches: Touches, known: BoolArray) -> Iterator[SerialArray]:
    """Give the rows of each set of touches in the same conditions, as far as recorded."""
    conditions = np.column_stack(
        [
            np.nan_to_num(np.asarray(getattr(touches, name), dtype=float), nan=np.inf)
            for name in ("path", "axis", "sign", "alpha_deg", "beta_deg", "feed_mm_min")
        ]
        + [np.nan_to_num(np.round(touches.position_mm, 2), nan=np.inf)]
        + [np.nan_to_num(np.round(touches.position_deg, 2), nan=np.inf)]
    )
    rows = np.flatnonzero(known)
    if not len(rows):
        return
    _, group = np.unique(conditions[rows], axis=0, return_inverse=True)
    group = group.ravel()
    for number in range(int(group.max()) + 1):
        yield rows[group == number]


RULES: tuple[Rule, ...] = (
    _clock_units,
    _travel_units,
    _deviation_units,
    moves_without_time,
    moves_that_overlap,
    temperatures,
    swapped_columns,
    ways_of_axes,
    places_beyond_reach,
    latches_before_the_move,
    far_from_the_others,
    lambda campaign: surfaces_apart(campaign.touches),
    _order_of_stamps,
    _times_backwards,
    _backwards,
    _equal_stamps,
    _no_scatter,
)
