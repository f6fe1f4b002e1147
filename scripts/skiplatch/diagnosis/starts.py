"""Where the search for the parameters of an effect begins: what the touches themselves propose."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy import optimize

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.grid import (
    MARGIN,
    folded,
    grid_period,
    kept_grid,
    mean_turn,
    sharpened,
)
from skiplatch.diagnosis.laws import SHORTEST_PERIOD, law_under
from skiplatch.diagnosis.lines import FAR_APART
from skiplatch.diagnosis.pitches import MANY_STEPS, odd_pitch, whole_pitches
from skiplatch.diagnosis.scene import Scene, Stream
from skiplatch.diagnosis.surrogates import BLURRED, FEW_TICKS, LOOSEST, Parameters, warmth_k_s
from skiplatch.units import DEG_PER_TURN, MM_PER_M, S_PER_MIN, UM_PER_MM, US_PER_H, US_PER_S

Starts = Callable[[Scene, Change], Sequence[Sequence[float]]]

FEWEST_STAMPS = 16
FEWEST_LATE = 3
FEWEST_FEEDS = 2
APART = (1.0 + MARGIN) / (1.0 - MARGIN)
"""Factor between guesses of a period that leave none out between them."""
WELL_KEPT = 0.95
"""Length of the mean turn of stamps that keep a grid, from which on no other is looked for."""
OTHER_PERIODS = tuple(APART**k for k in (-3, -2, -1, 1, 2, 3))
"""Of the scan, over the believed one, about which a grid is looked for."""
SLOWER = (0.9997, 0.999, 0.997, 0.99, 0.97, 0.9, 0.7, 0.4, 0.1)
"""Shares of the believed acceleration."""
JUST_NOT_ENOUGH = (0.9, 0.6, 0.3)
"""Shares of the acceleration that the fastest of the short approaches needs."""
CAPPED = (0.999, 0.99, 0.9, 0.6)
"""Shares of the highest feed that may be the limit of it."""
FASTEST = 0.8
"""Share of the touches that are slower than those that show such a limit."""
WITHOUT_WORST = (0.02, 0.98)
CLEAR = 6.0
"""Standard deviations over which ages spread that are not all the same."""
SHARP_AGE = 0.1
"""Scatter of the age of a position, over that of all ages, that tells an update's time."""
TINY = 1e-9
SHARP = 0.02
"""Scatter of the edge, over the scan period, that does not blur the waits for a scan."""


def both_signs(*sizes: float) -> Starts:
    """Propose one parameter at some sizes, of either sign."""
    return lambda _scene, _given: [[sign * size] for size in sizes for sign in (1.0, -1.0)]


def fixed(*starts: Sequence[float]) -> Starts:
    """Propose the same for every campaign."""
    return lambda _scene, _given: starts


def delays(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose delays of either sign, and by the skip path's mean and scatter those that scatter."""
    usual = [[sign * size, 0.0, 0.0] for size in (10.0, 300.0) for sign in (1.0, -1.0)]
    mean, sigma = _later_us(scene, given)
    if np.isnan(mean):
        return usual
    box = np.sqrt(12.0) * sigma
    return [*usual, [mean - box / 2.0, box, 0.0], [mean - sigma, 0.0, sigma]]


def _later_us(scene: Scene, given: Change) -> tuple[float, float]:
    """Give by how much the sharper touches of the skip path are later than thought: mean, scatter.

    NaN of too few.
    """
    late_us, spread_us = _late_us(scene, given)
    if len(late_us) < FEWEST_STAMPS:
        return np.nan, np.nan
    sharp = spread_us <= np.median(spread_us)
    return float(np.mean(late_us[sharp])), _unknown_sigma(late_us, spread_us)


def _unknown_sigma(off: FloatArray, spread: FloatArray) -> float:
    """Give the scatter of the sharper half that is not known of; both of shape (n,)."""
    sharp = spread <= np.median(spread)
    unknown = float(np.var(off[sharp]) - np.mean(spread[sharp] ** 2))
    return float(np.sqrt(max(unknown, 0.0)))


def _late_us(scene: Scene, given: Change) -> tuple[FloatArray, FloatArray]:
    """Give by how much touches of the skip path are later than thought, and the spread of that."""
    for name in ("latch_skip", "deviation_skip"):
        stream = scene.streams.get(name)
        if stream is not None:
            law = law_under(scene, stream, given)
            per_us = scene.speed if stream.unit == "µm" else np.ones(len(scene))
            late, spread = (stream.residuals - law.mean) / per_us, law.spread / per_us
            return late[stream.rows], spread[stream.rows]
    return np.empty(0), np.empty(0)


def feeds(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose feeds off by a share, and limits, also that by which the fastest touches are late."""
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
    seen = []
    for chosen in ([0], [0, 1], [0, 2]):
        start = np.zeros(3)
        start[chosen] = _slopes(stream, [parts[i] for i in chosen])
        seen.append(start.tolist())
    return [*seen, *usual]


def _slopes(stream: Stream, parts: Sequence[FloatArray]) -> FloatArray:
    """Fit multiples of the parts, each of shape (n,), and an offset, whatever some touches do."""
    rows, spread = stream.rows, stream.law.spread
    scores = ((stream.residuals - stream.law.mean) / spread)[rows]
    columns = [(part / spread)[rows] for part in (*parts, np.ones(len(rows)))]
    return robust_fit(columns, scores)[0][:-1]


def robust_fit(
    columns: Sequence[FloatArray], values: FloatArray, scale: float = 1.0
) -> tuple[FloatArray, float]:
    """Fit multiples of columns to values, all of shape (n,), whatever some of them do.

    Gives the multiples, and what they leave, as nats of a scatter of that scale; beyond it values
    count for less.
    """
    design = np.column_stack(columns)
    least, *_ = np.linalg.lstsq(design, values, rcond=None)

    def off(p: Parameters) -> FloatArray:
        return np.asarray(design @ p - values) / scale

    found = optimize.least_squares(off, least, x_scale="jac", loss="soft_l1")
    return np.asarray(found.x), float(found.cost)


def overruns(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose the reach of the late stamps, that scan or the one after being late."""
    period = scene.nominal.plc.scan_us
    usual = [
        [0.05, share * period, span * period]
        for share, span in ((0.3, 0.0), (0.5, 0.0), (1.2, 0.0), (2.3, 0.0), (0.5, 1.0), (1.5, 1.0))
    ]
    stream = scene.streams.get("lattice")
    if stream is None:
        return usual
    late = (stream.known - np.median(stream.known)) % period
    on_time = FEW_TICKS * scene.nominal.skip.tick_us
    late = late[np.abs(late - period / 2.0) < 0.5 * period - on_time]
    if len(late) < FEWEST_LATE:
        return usual
    low, span = float(late.min()), float(np.ptp(late))
    reaches = [(low, span), (low + period, span), (0.0, low + span), (float(np.median(late)), 0.0)]
    apart = _apart(stream.known % period, period)
    seen = [(len(apart), float(apart.min()), float(np.ptp(apart)))]
    seen += [(len(late), us, more) for us, more in reaches]
    # The longer gap before a late scan meets more edges than it is scans.
    met = [
        [n / len(stream.known) / (1.0 + (us + more / 2.0) / period), us, more]
        for n, us, more in seen
    ]
    return [*met, *usual]


def _apart(places: FloatArray, period: float) -> FloatArray:
    """Give how late those are that lie apart, behind others that may be a little late themselves.

    Counted from the first place behind the widest empty stretch of the turn.
    """
    turn = np.sort(places)
    widest = int(np.argmax(np.diff(turn, append=turn[0] + period)))
    late = np.sort((turn - turn[(widest + 1) % len(turn)]) % period)
    return late[int(np.argmax(np.diff(late))) + 1 :]


def locks(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose phases anywhere, and that of the touches whose stamps keep no grid with others."""
    usual = [
        *([phase, 0.1, 0.0] for phase in (0.2, 0.5, 0.8)),
        *([phase, 0.05, 0.5] for phase in (0.1, 0.3, 0.5, 0.7, 0.9)),
    ]
    grid, waits = scene.streams.get("lattice"), scene.streams.get("latch_plc")
    if grid is None or waits is None:
        return usual
    period = scene.nominal.plc.scan_us
    rows = grid.rows & waits.rows
    off = folded(grid.residuals - np.median(grid.known), period)
    is_off = np.abs(off[rows]) > SHARP * period
    if is_off.sum() < FEWEST_LATE:
        return usual
    turns = np.exp(2j * np.pi * waits.residuals[rows][is_off] / period)
    wait = float(np.angle(turns.mean())) / (2.0 * np.pi)
    spread = float(np.sqrt(max(-2.0 * np.log(np.abs(turns.mean())), 1e-6))) / (2.0 * np.pi)
    return [[-wait % 1.0, min(spread, LOOSEST), 1.0 - float(is_off.mean())], *usual]


def ticks(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose grids that the stamps lie on, and ticks that share no grid with the believed one."""
    tick = scene.nominal.skip.tick_us
    pitches = whole_pitches(scene.touches.latch_us[~scene.plc], tick)
    on_grid = [[pitch, 0.0, nearest] for pitch in pitches for nearest in (0.0, 1.0)]
    usual = on_grid + [
        [ratio * tick, origin * ratio * tick, 0.0]
        for ratio in (3.0, 10.0, 30.0)
        for origin in (0.5, 0.05)
    ]
    mean, sigma = _later_us(scene, given)
    if "latch_skip" not in scene.streams or np.isnan(mean):
        return usual
    width = _box_of(sigma, tick)
    seen = [[width, mean + 0.5 * width, 0.0]]
    if width > FAR_APART * tick:
        stamps = scene.touches.latch_us[scene.streams["latch_skip"].rows]
        for pitch, turn in (_coarsest(stamps, *grid) for grid in _grids_kept(stamps, width)):
            line = turn * pitch + 0.5 * tick  # stamps are rounded down from it
            whole = np.rint((mean + 0.5 * pitch - line) / pitch)
            seen.append([pitch, line + whole * pitch, 0.0])
    return [*seen, *usual]


def reports(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose a longer way, a queue, both by the soonest and the mean report, and a way by feed."""
    usual = [[us, 0.0, 0.0, 0.0] for us in (10.0, 100.0)]
    usual += [[0.0, us, 0.5, 0.0] for us in (20.0, 200.0)]
    stream = scene.streams.get("report")
    if stream is None:
        return [*usual, [50.0, 100.0, 0.0, 0.0]]
    soonest = float(stream.known.min())
    later = (stream.residuals - stream.law.mean)[stream.rows]
    queue = max(float(np.mean(later)) - soonest, 1.0)
    both = [[soonest, queue / (1.0 - direct), direct, 0.0] for direct in (0.0, 0.2, 0.6)]
    feed_m_min = scene.touches.feed_mm_min[stream.rows] / MM_PER_M
    if len(np.unique(feed_m_min)) < FEWEST_FEEDS:
        return [*usual, *both]
    slope, level = np.polyfit(feed_m_min, later, 1)
    by_feed = [[float(level), 0.0, 0.0, float(slope)]] if slope > 0.0 else []
    return [*usual, *both, *by_feed]


def resolutions(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose grids that deviations lie on, or coordinates: what is coarse shows its steps."""
    fine = scene.nominal.axis.resolution_um
    deviations = scene.touches.deviation_um
    pitches = [*whole_pitches(deviations, fine), *odd_pitch(deviations, fine)]
    grids = [[pitch, 0.0, 0.0] for pitch in pitches] + _coordinate_lines(scene, given)
    return [*grids, [BLURRED / 2.0 * fine, 1.0, 0.0]]


def slots(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose slots anywhere, and those that the skip path's stamps keep."""
    usual = [[slot_us, 0.0] for slot_us in (50.0, 500.0, 4000.0)]
    skip = scene.nominal.skip
    span_us = _box_of(_later_us(scene, given)[1])
    if "latch_skip" not in scene.streams or not span_us > CLEAR * (skip.jitter_us + skip.tick_us):
        return usual
    behind_us = (
        scene.nominal.input.filter_us + skip.latency_us + (skip.jitter_us - skip.tick_us) / 2.0
    )
    ends_us = scene.touches.latch_us[scene.streams["latch_skip"].rows] - behind_us
    seen = []
    for slot_us, turn in _grids_kept(ends_us, span_us):
        # What keeps the ends of slots keeps those of slots half as long as well.
        seen += [
            [slot_us, turn],
            [2.0 * slot_us, turn / 2.0],
            [2.0 * slot_us, turn / 2.0 + 0.5],
        ]
    seen = [[slot_us, turn * DEG_PER_TURN] for slot_us, turn in seen]
    return [*seen, *usual]


def holds(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose periods of updates anywhere, and what is told by the ages of positions at stamps."""
    usual = [[period_us, 0.0, 0.0] for period_us in (50.0, 500.0, 2000.0)]
    stream = scene.streams.get("position")
    if stream is None or not scene.has_stamps.any():
        return usual
    law = law_under(scene, stream, given)
    ages_us = (law.mean - stream.residuals) / scene.speed
    unsure_us = law.spread / scene.speed
    rows = stream.rows & scene.has_stamps
    sharp = rows & (unsure_us <= np.median(unsure_us[rows]))
    span_us = float(np.ptp(np.quantile(ages_us[sharp], WITHOUT_WORST)))
    is_news = span_us > CLEAR * float(unsure_us[sharp].max())
    sharp = rows & (unsure_us < SHARP_AGE * span_us)
    if not is_news or not sharp.any():
        return usual
    updates_us = (scene.touches.latch_us - ages_us)[sharp]
    dead_us = max(float(ages_us[sharp].min()), 0.0)
    seen = []
    for period_us, middle in _grids_kept(updates_us, span_us):
        for age_us in (0.0, dead_us):
            turn = (middle + age_us / period_us) % 1.0 or 1.0
            seen.append([period_us, age_us, turn * DEG_PER_TURN])
    return [*seen, *usual]


def accelerations(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose shares of the believed acceleration, and those with which some touches come slow."""
    feed_mm_s = scene.touches.feed_mm_min / S_PER_MIN
    enough_mm_s2 = feed_mm_s**2 / (2.0 * scene.touches.approach_mm)
    most = float(np.max(enough_mm_s2)) / scene.nominal.axis.accel_mm_s2
    shares = (*SLOWER, *(share * most for share in JUST_NOT_ENOUGH))
    return [[share, 0.0] for share in shares if share < 1.0]


def scan_periods(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose periods by their waits, and by the grid that the stamps keep."""
    believed = scene.nominal.plc.scan_us
    coarse = [[share * believed] for share in (-0.5, -0.2, -0.05, 0.05, 0.2, 0.5, 1.0)]
    stream = scene.streams.get("latch_plc")
    if stream is None or stream.rows.sum() < FEWEST_STAMPS:
        return coarse
    sharp = stream.rows & (scene.mechanics_us < SHARP * believed)
    waits = stream.residuals[sharp if sharp.sum() >= FEWEST_STAMPS else stream.rows]
    # Where the scans bind the edges, the waits differ by far less than a period.
    width = max(float(np.ptp(np.quantile(waits, [0.01, 0.99]))), SHORTEST_PERIOD * believed)
    stamps = np.sort((scene.touches.latch_us - given.stamp_us)[stream.rows])
    near = [grid_period(stamps, guess) for guess in (width, believed)]
    far = [] if np.abs(mean_turn(stamps, near[1])) > WELL_KEPT else _far_periods(stamps, believed)
    periods = [sharpened(stamps, period) for period in (*near, *far)]
    return [*([period - believed] for period in periods), [width - believed], *coarse]


def _far_periods(stamps: FloatArray, believed: float) -> list[float]:
    """Propose grids of periods far from the believed one."""
    found = [grid_period(stamps, ratio * believed, FEWEST_STAMPS) for ratio in OTHER_PERIODS]
    return [period for period in found if period > SHORTEST_PERIOD * believed]


def _coordinate_lines(scene: Scene, given: Change) -> list[list[float]]:
    """Propose the grid that coordinates keep whose steps are as wide as the scatter says."""
    fine = scene.nominal.axis.resolution_um
    stream = scene.streams.get("position", scene.streams.get("deviation_skip"))
    if stream is None:
        return []
    law = law_under(scene, stream, given)
    rows = stream.rows
    seen_um = _box_of(_unknown_sigma((stream.residuals - law.mean)[rows], law.spread[rows]), fine)
    if seen_um < MANY_STEPS * fine:
        return []
    where_um = scene.latched_mm[~np.isnan(scene.touches.deviation_um)] * UM_PER_MM
    where_um = where_um[~np.isnan(where_um)]
    return [[pitch, 1.0, turn] for pitch, turn in _grids_kept(where_um, seen_um)]


def _box_of(sigma: float, known: float = 0.0) -> float:
    """Give the width of a box with so much scatter beside a known box."""
    return float(np.hypot(np.sqrt(12.0) * sigma, known))


def _coarsest(values: FloatArray, period: float, turn: float) -> tuple[float, float]:
    """Give the coarsest grid that holds the lines that values keep: what keeps it keeps finer."""
    lines = np.rint(values / period - turn).astype(np.int64)
    step = int(np.gcd.reduce(lines - lines[0])) or 1
    return step * period, (int(lines[0]) % step + turn) / step


def _grids_kept(values: FloatArray, guess: float) -> list[tuple[float, float]]:
    """Give the grids, each not too far from the guess, that values keep by no accident.

    With each comes where it lies as a share of its period, above 0 and not above 1.
    """
    if len(values) < FEWEST_STAMPS:
        return []
    in_order, guesses = np.sort(values), (guess / APART, guess, guess * APART)
    kept = [kept_grid(in_order, near, first=FEWEST_STAMPS) for near in guesses]
    return [(grid[0], grid[1] or 1.0) for grid in kept if grid]
