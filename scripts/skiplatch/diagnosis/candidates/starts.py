"""Where the search for the parameters of an effect begins: what the touches themselves propose."""

from collections.abc import Callable, Sequence

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.surrogates import Parameters, warmth_k_s
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import BY_STAMPS, WITHOUT_STAMPS
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.likelihood.likelihood import fitted_datum_um, shifted_by_datum
from skiplatch.diagnosis.scene.grid import FEWEST_STAMPS
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.statistics import robust_deviation
from skiplatch.units import MM_PER_M, S_PER_MIN, US_PER_H, US_PER_S

Starts = Callable[[Scene, Change], Sequence[Sequence[float]]]

FEWEST_FEEDS = 2
SLOWER = (0.9997, 0.999, 0.997, 0.99, 0.97, 0.9, 0.7, 0.4, 0.1)
"""Shares of the believed acceleration."""
JUST_NOT_ENOUGH = (0.9, 0.6, 0.3)
"""Shares of the acceleration that the fastest of the short approaches needs."""
CLOSER = 0.9 ** np.arange(1, 20)
"""The same, as close as a few touches that come slow tell them from many that do not."""
POWERS_OF_FEED = (0.0, -0.5, 0.5, -1.0, 1.0, -2.0, 2.0)
"""That a share of the acceleration may go with."""
CAPPED = (0.999, 0.99, 0.9, 0.6)
"""Shares of the highest feed that may be the limit of it."""
FASTEST = 0.8
"""Share of the touches that are slower than those that show such a limit."""
SOON, SEEM_EARLY, FAR_LATE = 0.1, 2.0, 6.0
"""Share of the touches that came at once, spreads by which these may seem early, and spreads beyond
them by which others are late."""
TINY = 1e-9


def fixed(*starts: Sequence[float]) -> Starts:
    """Propose the same for every campaign."""
    return lambda _scene, _given: starts


def later(*usual: Sequence[float]) -> Starts:
    """Propose times by which edges come later, and those of the skip path's mean and scatter.

    A time that all have, a uniform one and an exponential one.
    """

    def starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
        mean, sigma = later_us(scene, given)
        if np.isnan(mean):
            return usual
        box = np.sqrt(12.0) * sigma
        return [*usual, [mean, 0.0, 0.0], [mean - box / 2.0, box, 0.0], [mean - sigma, 0.0, sigma]]

    return starts


def later_us(scene: Scene, given: Change, *, is_datum_fitted: bool = False) -> tuple[float, float]:
    """Give by how much the sharper touches of the skip path are later than thought: mean, scatter.

    They scatter about their own surfaces, wherever these are. NaN of too few.
    """
    beside_datum_us, spread_us = _late_us(scene, given, is_datum_fitted=True)
    if len(beside_datum_us) < FEWEST_STAMPS:
        return np.nan, np.nan
    late_us = beside_datum_us if is_datum_fitted else _late_us(scene, given)[0]
    sharp = spread_us <= np.median(spread_us)
    return float(np.mean(late_us[sharp])), unknown_sigma(beside_datum_us, spread_us)


def unknown_sigma(off: FloatArray, spread: FloatArray) -> float:
    """Give the scatter of the sharper half that is not known of; both of shape (n,)."""
    sharp = spread <= np.median(spread)
    unknown = float(np.var(off[sharp]) - np.mean(spread[sharp] ** 2))
    return float(np.sqrt(max(unknown, 0.0)))


def now_and_then(usual: Sequence[Sequence[float]], as_late: Sequence[Sequence[float]]) -> Starts:
    """Propose what comes now and then, and that by which the skip path's late touches are later.

    Args:
        usual: Parameters that are proposed anyway: a share of the touches, and times.
        as_late: Those of touches that are late by 1 µs, without the share.
    """

    def starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
        late_us, spread_us = _late_us(scene, given, is_datum_fitted=True)
        if len(late_us):
            # Slow touches seem early or late by far more than sharp ones.
            late_us = late_us - np.quantile(late_us + SEEM_EARLY * spread_us, SOON)
        far = late_us > FAR_LATE * spread_us
        seen = _told_by_moments(*later_us(scene, given))
        if far.any():
            seen.append((float(far.mean()), float(np.median(late_us[far]))))
        more = [[share, *(us * value for value in one)] for share, us in seen for one in as_late]
        return [*usual, *more]

    return starts


def _told_by_moments(mean_us: float, sigma_us: float) -> list[tuple[float, float]]:
    """Give the share of touches, and by how much those are late, of this mean and scatter."""
    if not mean_us > 0.0 or not sigma_us > 0.0:
        return []
    late_us = mean_us + sigma_us**2 / mean_us
    return [(mean_us / late_us, late_us)]


def _late_us(
    scene: Scene, given: Change, *, is_datum_fitted: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Give by how much touches of the skip path are later than thought, and the spread of that.

    A datum that is fitted takes up what all touches of a surface have: else each comes later the
    slower it is.
    """
    for family in (BY_STAMPS, WITHOUT_STAMPS):
        stream = scene.streams.get(family[0])
        if stream is not None:
            law = law_under(scene, stream, given)
            data = fitted_datum_um(scene, given) if is_datum_fitted else {}
            late = (stream.residuals - law.mean)[stream.rows]
            late = late - shifted_by_datum(scene, stream, data)
            per_us = scene.speed[stream.rows] if stream.unit == "µm" else np.ones(len(late))
            return late / per_us, law.spread[stream.rows] / per_us
    return np.empty(0), np.empty(0)


def _late_arrivals(scene: Scene) -> list[list[float]]:
    """Propose how late arrivals are that stand for stamps: by that positions fall behind them."""
    stream = scene.streams.get("arrival")
    if stream is None:
        return []
    behind_um, speed = (stream.law.mean - stream.residuals)[stream.rows], scene.speed[stream.rows]
    late_us = float(np.median(behind_um / speed))
    if len(np.unique(speed)) >= FEWEST_FEEDS:
        late_us = float(np.polyfit(speed, behind_um, 1)[0])
    return [[late_us, 0.0, 0.0, 0.0]]


def feeds(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose feeds off by a share, a constant or both, and limits; also those the stamps show."""
    shares = [[sign * size, 0.0, 0.0] for size in (1.0, 5.0, 20.0) for sign in (1.0, -1.0)]
    feed_mm_min = scene.touches.feed_mm_min
    limits = [share * float(feed_mm_min.max()) for share in CAPPED]
    stream = scene.streams.get("latch_skip")
    if stream is not None and stream.rows.sum() >= FEWEST_STAMPS:
        fastest = stream.rows & (feed_mm_min >= np.quantile(feed_mm_min[stream.rows], FASTEST))
        late_min = (stream.residuals - stream.law.mean)[fastest] / (US_PER_S * S_PER_MIN)
        way_mm = scene.touches.approach_mm[fastest]
        real_mm_min = way_mm / np.maximum(way_mm / feed_mm_min[fastest] + late_min, TINY)
        limits.append(float(np.median(real_mm_min)))
        # A touch is late by what its way takes longer.
        way_us = scene.touches.approach_mm / feed_mm_min * (US_PER_S * S_PER_MIN)
        shares = [*_told_by(stream, [-way_us / 100.0, -way_us / feed_mm_min]), *shares]
    return [*shares, *([0.0, 0.0, limit] for limit in limits)]


def drifts(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose what the skip path's stamps show: a drift, one that ages, or that goes by warmth.

    Beside a delay of any size, which is not the clock's: a short campaign would take it for drift.
    """
    usual = [[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0], [50.0, 0.0, 0.0], [-50.0, 0.0, 0.0]]
    stream = scene.streams.get("latch_skip")
    if stream is None or stream.rows.sum() < FEWEST_STAMPS:
        return usual
    stamps_us = scene.touches.latch_us
    parts = [stamps_us * 1e-6, stamps_us**2 / US_PER_H * 1e-6, warmth_k_s(scene, stamps_us)]
    return [*_told_by(stream, parts, ([0], [0, 1], [0, 2])), *usual]


def _told_by(
    stream: Stream,
    parts: Sequence[FloatArray],
    together: Sequence[Sequence[int]] = ([0], [1], [0, 1]),
) -> list[list[float]]:
    """Propose the first parameters of three by what a stream shows of parts, some at a time."""
    seen = []
    for chosen in together:
        start = np.zeros(3)
        start[list(chosen)] = _slopes(stream, [parts[i] for i in chosen])
        seen.append(start.tolist())
    return seen


def _slopes(stream: Stream, parts: Sequence[FloatArray]) -> FloatArray:
    """Fit multiples of the parts, each of shape (n,), and an offset, whatever some touches do."""
    rows, spread = stream.rows, stream.law.spread
    scores = ((stream.residuals - stream.law.mean) / spread)[rows]
    columns = [(part / spread)[rows] for part in (*parts, np.ones(len(rows)))]
    return robust_fit(columns, scores)[0][:-1]


def scale_beside(columns: Sequence[FloatArray], scores: FloatArray) -> float:
    """Give the scatter of scores, shape (n,), beside multiples of columns, whatever some do."""
    found, _ = robust_fit(columns, scores)
    left = scores - np.column_stack(columns) @ found
    return max(1.0, robust_deviation(left))


def robust_fit(
    columns: Sequence[FloatArray], values: FloatArray, scale: float = 1.0
) -> tuple[FloatArray, float]:
    """Fit multiples of columns to values, all of shape (n,), whatever some of them do.

    Gives the multiples, and what they leave, as nats of a scatter of that scale; beyond it values
    count for less.
    """
    design, scaled = np.column_stack(columns) / scale, values / scale
    least, *_ = np.linalg.lstsq(design, scaled, rcond=None)

    def off(p: Parameters) -> FloatArray:
        return np.asarray(design @ p - scaled)

    def slopes(_p: Parameters) -> FloatArray:
        return design

    found = scipy.optimize.least_squares(off, least, jac=slopes, x_scale="jac", loss="soft_l1")
    return np.asarray(found.x), float(found.cost)


def reports(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose a longer way, a queue, both by the soonest and the mean report, and a way by feed."""
    usual = [[us, 0.0, 0.0, 0.0] for us in (10.0, 100.0)]
    usual += [[0.0, us, 0.5, 0.0] for us in (20.0, 200.0)]
    stream = scene.streams.get("report")
    if stream is None:
        return [*usual, [50.0, 100.0, 0.0, 0.0], *_late_arrivals(scene)]
    soonest = float(stream.known.min())
    later = (stream.residuals - stream.law.mean)[stream.rows]
    queue = max(float(np.mean(later)) - soonest, 1.0)
    both = [[soonest, queue / (1.0 - direct), direct, 0.0] for direct in (0.0, 0.2, 0.6)]
    feed_m_min = scene.touches.feed_mm_min[stream.rows] / MM_PER_M
    if len(np.unique(feed_m_min)) < FEWEST_FEEDS:
        return [*usual, *both]
    slope, level = map(float, np.polyfit(feed_m_min, later, 1))
    if slope <= 0.0:
        return [*usual, *both]
    left_us = later - slope * feed_m_min
    least_us, queue_us = float(left_us.min()), max(level - float(left_us.min()), 1.0)
    by_feed = [[least_us, queue_us / (1.0 - direct), direct, slope] for direct in (0.0, 0.6)]
    return [*usual, *both, [level, 0.0, 0.0, slope], *by_feed]


def accelerations(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose shares of the believed acceleration, and those with which some touches come slow.

    Those of the feed that is slowed most: a power of the feed makes it less for the others.
    """
    feed_mm_s = scene.touches.feed_mm_min / S_PER_MIN
    enough_mm_s2 = feed_mm_s**2 / (2.0 * scene.touches.approach_mm)
    most = float(np.max(enough_mm_s2)) / scene.nominal.axis.accel_mm_s2
    shares = (*SLOWER, *(share * most for share in JUST_NOT_ENOUGH))
    feed_m_min = scene.touches.feed_mm_min / MM_PER_M
    by_feed = [(power, float(np.max(feed_m_min**-power))) for power in POWERS_OF_FEED]
    alike = [[share, 0.0] for share in (CLOSER * most).tolist() if share < 1.0]
    return alike + [
        [share * over, power] for share in shares if share < 1.0 for power, over in by_feed
    ]
