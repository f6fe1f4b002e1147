"""What each effect of the catalogue does to the physics, and where a search for it begins.

The simulator has its own, exact form of every effect; these are the surrogates that propose. An
effect that the simulator knows and this table does not is searched for by simulation alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.grid import grid_period
from skiplatch.diagnosis.law import Extra
from skiplatch.diagnosis.likelihood import law_under
from skiplatch.diagnosis.scene import LOBES, Scene
from skiplatch.motion import S_PER_MIN, contact_at

Parameters = FloatArray
Starts = Callable[[Scene, Change], Sequence[Sequence[float]]]

MOST_SCANS_OLD = 7.0
MOST_RETRIES = 0.9
MOST_AGAIN = 0.95
MOST_PUNCTUAL = 0.95
MOST = 0.6
MIRRORED = 0.5
LOOSEST = 0.25
"""Spread of the phase in the scan, over a period, beyond which the scans hardly bind it."""
SHORTEST_MM = 0.01
SLOWEST_RATIO = 0.05
US_PER_H = 3.6e9
DRIFT_ROUNDS = 4
"""Each makes the time that a stamp stands for a thousand times as exact, or more."""
FEWEST_STAMPS = 16
FEWEST_LATE = 3
FEW_TICKS = 4.0
"""By which stamps of scans on time may be off their grid."""
SHARP = 0.02
"""Scatter of the edge, over the scan period, that does not blur the waits for a scan."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect as a surrogate.

    Attributes:
        id: As in the table of effects.
        names: Of the parameters, as in the table of effects.
        change: What parameters, shape (p,), make of the physics.
        starts: Parameters to start a search from, given what is known to differ already. What is
            0 in a start stays 0.
        applies: Whether a campaign can show the effect at all.
    """

    id: str
    names: tuple[str, ...]
    change: Callable[[Scene, Parameters], Change]
    starts: Starts
    applies: Callable[[Scene], bool] = lambda _: True
    refinements: tuple[Mapping[int, float], ...] = ()
    """Parameters, by number and with a first value, that make other forms of the effect."""

    @property
    def is_named(self) -> bool:
        """It stands in the table of effects."""
        return self.id in CANDIDATES

    def __reduce__(self) -> tuple[Callable[[str], "Candidate"], tuple[str]]:
        """Travel to another process as the id alone."""
        return candidate, (self.id,)


def candidate(effect_id: str) -> Candidate:
    """Give the candidate of an id."""
    return CANDIDATES[effect_id]


def _both_signs(*sizes: float) -> Starts:
    return lambda _scene, _given: [[sign * size] for size in sizes for sign in (1.0, -1.0)]


def _fixed(*starts: Sequence[float]) -> Starts:
    return lambda _scene, _given: starts


def _machine(scene: Scene) -> bool:
    return scene.is_machine


def _share(value: float) -> float:
    """Keep a share between 0 and 1 wherever the search goes."""
    return float(np.clip(abs(value), 0.0, 1.0))


def _some(value: float) -> float:
    """Keep what happens to some touches from happening to nearly all of them."""
    return min(_share(value), MOST)


def _feed_error(scene: Scene, p: Parameters) -> Change:
    ratio = 1.0 + p[0] / 100.0 + p[1] / scene.touches.feed_mm_min
    ratio = np.maximum(ratio, SLOWEST_RATIO)
    return _other_motion(scene, ratio, scene.nominal.axis.accel_mm_s2)


def _unfinished(scene: Scene, p: Parameters) -> Change:
    ratio = float(np.clip(p[0], 0.01, 1.0))
    return _other_motion(scene, 1.0, scene.nominal.axis.accel_mm_s2 * ratio)


def _other_motion(scene: Scene, feed_ratio: FloatArray | float, accel_mm_s2: float) -> Change:
    wanted_mm_s = scene.touches.feed_mm_min / S_PER_MIN * feed_ratio
    contact = contact_at(scene.touches, wanted_mm_s, accel_mm_s2)
    return Change(
        contact_us=contact.time_us - scene.contact.time_us,
        speed_ratio=contact.speed_mm_s / scene.contact.speed_mm_s,
    )


def _lobing(scene: Scene, p: Parameters) -> Change:
    azimuth = LOBES * (scene.alpha - np.deg2rad(p[1]))
    return Change(pretravel_um=p[0] * scene.cos_beta * np.cos(azimuth))


def _retry(_scene: Scene, p: Parameters) -> Change:
    share, period = min(_share(p[0]), MOST_RETRIES), abs(p[1])
    again = float(np.clip(share + p[3], 0.0, MOST_AGAIN))
    extras = tuple(
        Extra(
            share * (1.0 - again) * again ** (k - 1),
            offset=k * period,
            sigma=np.sqrt(k) * abs(p[2]),
        )
        for k in range(1, 6)
    )
    return Change(pin_extra=extras)


def _bounce(_scene: Scene, p: Parameters) -> Change:
    late = Extra(_some(p[0]), mean=abs(p[1]), offset=abs(p[2]), width=abs(p[3]))
    return Change(pin_extra=(late,))


def _blocking(_scene: Scene, p: Parameters) -> Change:
    return Change(skip_extra=(Extra(_some(p[0]), width=abs(p[1]), mean=abs(p[2])),))


def _transmission(scene: Scene, p: Parameters) -> Change:
    position = np.nan_to_num(scene.touches.position_mm)
    known = (scene.whole or scene).touches.position_mm
    span = float(np.nanmax(known) - np.nanmin(known)) if not np.isnan(known).all() else 0.0
    period = np.clip(abs(p[1]), SHORTEST_MM, max(span, SHORTEST_MM))
    turn = 2.0 * np.pi * position / period  # what shows less than a period is not periodic
    first = p[0] * np.sin(turn + np.deg2rad(p[2]))
    second = p[3] * np.sin(2.0 * turn + np.deg2rad(p[4]))
    return Change(position_um=scene.sign * (first + second) * scene.over_x(p[5], p[6]))


def _lagged(scene: Scene, lag_s: float, cold: float = 0.0) -> FloatArray:
    """Temperature behind the thermometer by a first-order lag; shape (n,)."""
    if scene.whole is not None:
        return _lagged(scene.whole, lag_s, cold)[scene.chosen]
    warmth = scene.warmth
    if lag_s <= 0.0 or len(scene) < 2:
        return warmth
    keep = np.exp(-np.diff(scene.touches.time_s) / lag_s)
    steps = zip(warmth[1:].tolist(), keep.tolist(), strict=True)
    lagged = accumulate(
        steps,
        lambda before, step: step[0] + (before - step[0]) * step[1],
        initial=(1.0 - cold) * float(warmth[0]),
    )
    return np.fromiter(lagged, float, len(warmth))


def _delay(_scene: Scene, p: Parameters) -> Change:
    jitter = (Extra(1.0, width=abs(p[1])),) if p[1] else ()
    return Change(pin_us=p[0], pin_extra=jitter)


def _image_delay(scene: Scene, p: Parameters) -> Change:
    period_us = scene.nominal.plc.scan_us
    whole, part = divmod(min(abs(p[0]), MOST_SCANS_OLD), 1.0)
    older = (Extra(part, offset=period_us),) if part else ()
    return Change(plc_us=float(whole) * period_us, scan_extra=older)


def _delay_starts(_scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    return [[sign * size, 0.0] for size in (10.0, 300.0) for sign in (1.0, -1.0)]


def _per_axis(first: int) -> tuple[Mapping[int, float], ...]:
    """Refine by axes of their own; `first` is the number of y_more."""
    return ({first: 0.1}, {first: -0.5}, {first + 1: -0.9}, {first: 0.1, first + 1: -0.9})


def _drift(scene: Scene, p: Parameters) -> Change:
    warm_us = p[2] * _warmth_k_s(scene) if p[2] else 0.0
    stamps_us = master_us = scene.touches.latch_us
    for _ in range(DRIFT_ROUNDS):
        rate = (p[0] + p[1] * master_us / US_PER_H) * 1e-6
        master_us = (stamps_us - warm_us) / (1.0 + rate)
    return Change(stamp_us=stamps_us - master_us)


def _warmth_k_s(scene: Scene) -> FloatArray:
    """Kelvins above the calibration times seconds since the start, touch by touch; shape (n,)."""
    if scene.whole is not None:
        return _warmth_k_s(scene.whole)[scene.chosen]
    steps_s = np.diff(scene.touches.time_s, prepend=0.0)
    return np.asarray(np.cumsum(scene.warmth * steps_s))


def _drift_starts(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose the slope of the skip path's stamps over time, whole and of either half."""
    usual = [[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0], [50.0, 0.0, 0.0], [-50.0, 0.0, 0.0]]
    stream = scene.streams.get("latch_skip")
    if stream is None or stream.rows.sum() < FEWEST_STAMPS:
        return usual
    stamps = scene.touches.latch_us[stream.rows]
    residuals = (stream.residuals - stream.law.mean)[stream.rows]
    straight = float(np.median(residuals / stamps)) * 1e6
    curve, slope = np.polyfit(stamps, residuals / stamps * 1e6, 1)
    return [[straight, 0.0, 0.0], [float(slope), float(curve) * US_PER_H, 0.0], *usual]


def _overrun(scene: Scene, p: Parameters) -> Change:
    """The grid shows a late scan by its lateness; an edge waits for it from the scan before on."""
    share, late, span = _some(p[0]), abs(p[1]), abs(p[2])
    ratio = (late + span / 2.0) / scene.nominal.plc.scan_us
    met = min(share * (1.0 + ratio), 0.9)  # the longer gap before a late scan meets more edges
    return Change(
        lattice_extra=(Extra(met, offset=late, width=span),),
        scan_extra=_gaps(scene, (met, 1.0 + ratio), (share * max(0.0, 1.0 - ratio), 1.0 - ratio)),
    )


def _overruns(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose the reach of the late stamps, that scan or the one after being late."""
    period = scene.nominal.plc.scan_us
    usual = [
        [0.05, share * period, span * period]
        for share, span in ((0.3, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (0.5, 1.0), (1.5, 1.0))
    ]
    stream = scene.streams.get("lattice")
    if stream is None:
        return usual
    late = (stream.known - np.median(stream.known)) % period
    on_time = FEW_TICKS * scene.nominal.skip.tick_us
    late = late[np.abs(late - period / 2.0) < 0.5 * period - on_time]
    if len(late) < FEWEST_LATE:
        return usual
    share = len(late) / len(stream.known) / 2.0  # the longer gap before a late scan meets more
    low, span = float(late.min()), float(np.ptp(late))
    seen = [[share, low + turn, span] for turn in (0.0, period)]
    return [*seen, [share, float(np.median(late)), 0.0], *usual]


def _locks(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
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
    off = (grid.residuals - np.median(grid.known) + period / 2.0) % period - period / 2.0
    is_off = np.abs(off[rows]) > SHARP * period
    if is_off.sum() < FEWEST_LATE:
        return usual
    turns = np.exp(2j * np.pi * waits.residuals[rows][is_off] / period)
    wait = float(np.angle(turns.mean())) / (2.0 * np.pi)
    spread = float(np.sqrt(max(-2.0 * np.log(np.abs(turns.mean())), 1e-6))) / (2.0 * np.pi)
    return [[-wait % 1.0, min(spread, LOOSEST), 1.0 - float(is_off.mean())], *usual]


def _gaps(scene: Scene, *gaps: tuple[float, float]) -> tuple[Extra, ...]:
    """Shares of edges that fall into gaps between scans of other lengths, in periods."""
    period = scene.nominal.plc.scan_us
    return tuple(
        Extra(share, width=length * period, boxless=1.0) for share, length in gaps if share > 0.0
    )


def _jitter(scene: Scene, p: Parameters) -> Change:
    """Every gap between scans is longer or shorter by the difference of two latenesses."""
    span, tail = abs(p[0]), abs(p[1])
    late = 1.0 - min(_share(p[2]), MOST_PUNCTUAL)
    off = min(np.sqrt(span**2 / 6.0 + 2.0 * tail**2) / scene.nominal.plc.scan_us, 0.9)
    longer, shorter = late * (1.0 + off) / 3.0, late * (1.0 - off) / 3.0
    return Change(
        lattice_extra=(Extra(late, width=span, mean=tail),),
        scan_extra=_gaps(scene, (longer, 1.0 + off), (shorter, 1.0 - off)),
    )


def _coarse_ticks(scene: Scene, p: Parameters) -> Change:
    is_on_grid = p[1] == 0.0
    # Of two clocks that share no grid, both round down, one after the other.
    again = 0.0 if is_on_grid else 0.5 * scene.nominal.skip.tick_us
    later = p[1] + 0.5 * abs(p[0]) * _share(p[2]) - again
    return Change(
        coarse_us=abs(p[0]), stamp_us=np.where(scene.plc, 0.0, later), is_on_grid=is_on_grid
    )


def _ticks(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose grids that the stamps lie on, and ticks that share no grid with the believed one."""
    tick = scene.nominal.skip.tick_us
    grids = _grids(scene.touches.latch_us[~scene.plc], tick)
    on_grid = [[grid[0], 0.0, nearest] for grid in grids for nearest in (0.0, 1.0)]
    usual = on_grid + [
        [ratio * tick, origin * ratio * tick, 0.0]
        for ratio in (3.0, 10.0, 30.0)
        for origin in (0.5, 0.05)
    ]
    stream = scene.streams.get("latch_skip")
    if stream is None or stream.rows.sum() < FEWEST_STAMPS:
        return usual
    off = (stream.residuals - stream.law.mean)[stream.rows]
    variance = float(np.var(off) - np.mean(stream.law.spread[stream.rows] ** 2))
    seen = np.sqrt(12.0 * max(variance, 0.0) + tick**2)  # by the scatter of a box
    return [*usual, [seen, float(np.mean(off)) + 0.5 * seen, 0.0]]


def _report_starts(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose a longer way, a queue, and both, as far as the soonest and the mean report tell."""
    usual = [[10.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 20.0, 0.5], [0.0, 200.0, 0.5]]
    stream = scene.streams.get("report")
    if stream is None:
        return [*usual, [50.0, 100.0, 0.0]]
    soonest = float(stream.known.min())
    queue = max(float(np.mean((stream.residuals - stream.law.mean)[stream.rows])) - soonest, 1.0)
    both = [[soonest, queue / (1.0 - direct), direct] for direct in (0.0, 0.2, 0.6)]
    return [*usual, *both]


def _resolutions(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose grids that the deviations lie on, and steps of the coordinate, on none."""
    fine = scene.nominal.axis.resolution_um
    grids = [[grid[0], 0.0] for grid in _grids(scene.touches.deviation_um, fine)]
    return grids + [[ratio * fine, 1.0] for ratio in (3.0, 10.0, 30.0, 100.0)]


def _pivot(scene: Scene, p: Parameters) -> Change:
    sense = -1.0 if p[3] > MIRRORED else 1.0
    turn = sense * np.deg2rad(np.nan_to_num(scene.touches.rotary_deg))
    kept = 1.0 - _share(p[2])
    shift_x = kept * p[0] - (np.cos(turn) * p[0] - np.sin(turn) * p[1])
    shift_y = kept * p[1] - (np.sin(turn) * p[0] + np.cos(turn) * p[1])
    along = np.cos(scene.alpha) * shift_x + np.sin(scene.alpha) * shift_y
    return Change(position_um=along * scene.cos_beta)


def _scan_periods(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose periods by their waits, and by the grid that the stamps keep."""
    believed = scene.nominal.plc.scan_us
    coarse = [[share * believed] for share in (-0.5, -0.2, -0.05, 0.05, 0.2, 0.5, 1.0)]
    stream = scene.streams.get("latch_plc")
    if stream is None or stream.rows.sum() < FEWEST_STAMPS:
        return coarse
    sharp = stream.rows & (scene.mechanics_us < SHARP * believed)
    waits = stream.residuals[sharp if sharp.sum() >= FEWEST_STAMPS else stream.rows]
    width = float(np.ptp(np.quantile(waits, [0.01, 0.99])))
    stamps = scene.touches.latch_us[stream.rows]
    periods = [grid_period(stamps, guess) for guess in (width, believed)]
    return [*([period - believed] for period in periods), [width - believed], *coarse]


def _grids(values: FloatArray, fine: float) -> Sequence[Sequence[float]]:
    """Propose the coarsest grids on which nearly all values lie."""
    steps = np.rint(values[~np.isnan(values)] / fine).astype(np.int64)
    if not len(steps):
        return [[2.0 * fine]]
    most_off = 0.02 * len(steps)
    on_grid = [k for k in range(2, 4097) if np.count_nonzero(steps % k) < most_off]
    return [[k * fine] for k in (on_grid or [2])[-3:]]


def _transmission_starts(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Scan the periods: at each, the best sine by least squares."""
    stream = scene.streams.get("position") or scene.streams.get("deviation_skip")
    unknown = [[1.0, 10.0, 1.0, 0.0, 0.0, 0.0, 0.0]]
    if stream is None:
        return unknown
    rows = stream.rows & ~np.isnan(scene.touches.position_mm)
    if not rows.any():
        return unknown
    law = law_under(scene, stream, given).select(rows)
    residuals = scene.sign[rows] * (stream.residuals[rows] - law.mean)
    residuals = residuals - np.median(residuals)
    position = scene.touches.position_mm[rows]
    weights = 1.0 / law.spread**2
    span = float(np.ptp(position)) or 1.0
    frequencies = np.arange(0.5 / span, 2.0, 0.2 / span)
    waves = np.exp(-2j * np.pi * np.outer(frequencies, position))
    limited = np.clip(residuals, *np.quantile(residuals, [0.02, 0.98]))
    power = np.abs(waves @ (weights * limited))
    starts = []
    for i in np.argsort(power)[::-1][:3]:
        wave = waves[i].conj()
        design = np.column_stack([wave.imag, wave.real])
        root = np.sqrt(weights)
        (a, b), *_ = np.linalg.lstsq(design * root[:, None], limited * root, rcond=None)
        starts.append(
            [
                float(np.hypot(a, b)),
                1.0 / float(frequencies[i]),
                float(np.rad2deg(np.arctan2(b, a))),
                0.0,
                0.0,
                0.0,
                0.0,
            ]
        )
    return starts


CANDIDATES: Mapping[str, Candidate] = {
    row.id: row
    for row in (
        Candidate(
            "feed_error",
            ("feed_percent", "offset_mm_min"),
            _feed_error,
            _fixed(*([sign * size, 0.0] for size in (1.0, 5.0, 20.0) for sign in (1.0, -1.0))),
            refinements=({1: 1.0}, {1: -1.0}),
        ),
        Candidate(
            "unfinished_acceleration", ("accel_ratio",), _unfinished, _fixed([0.8], [0.4], [0.1])
        ),
        Candidate(
            "pretravel_lobing",
            ("amplitude_um", "azimuth_deg"),
            _lobing,
            _fixed(*([2.0, azimuth] for azimuth in (0.0, 30.0, 60.0, 90.0))),
            _machine,
        ),
        Candidate(
            "trigger_delay",
            ("delay_us", "jitter_us"),
            _delay,
            _delay_starts,
            _machine,
            refinements=({1: 5.0}, {1: 100.0}),
        ),
        Candidate(
            "link_slotting",
            ("slot_us",),
            lambda _, p: Change(pin_extra=(Extra(1.0, width=abs(p[0])),)),
            _fixed([50.0], [500.0], [4000.0]),
            _machine,
        ),
        Candidate(
            "link_retry",
            ("probability", "period_us", "scatter_us", "again"),
            _retry,
            _fixed(
                *([0.1, period, 0.2 * period, 0.0] for period in (100.0, 500.0, 2000.0, 8000.0))
            ),
            _machine,
            refinements=({3: 0.3},),
        ),
        Candidate(
            "input_filter",
            ("delay_us", "jitter_us"),
            _delay,
            _delay_starts,
            refinements=({1: 5.0}, {1: 100.0}),
        ),
        Candidate(
            "contact_bounce",
            ("probability", "mean_us", "least_us", "span_us"),
            _bounce,
            _fixed(*([0.2, mean, 0.0, 0.0] for mean in (30.0, 300.0, 3000.0))),
            refinements=tuple({i: size} for size in (10.0, 100.0, 1000.0) for i in (2, 3)),
        ),
        Candidate(
            "lost_trigger",
            ("probability",),
            lambda _, p: Change(lost=_share(p[0])),
            _fixed([0.02]),
        ),
        Candidate(
            "isr_latency",
            ("latency_us", "jitter_us", "tail_us"),
            lambda _, p: Change(
                skip_us=p[0], skip_extra=(Extra(1.0, width=abs(p[1]), mean=abs(p[2])),)
            ),
            _fixed([10.0, 0.0, 0.0], [100.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [5.0, 5.0, 0.0]),
            refinements=({1: 1.0}, {1: 20.0}, {2: 1.0}, {2: 20.0}),
        ),
        Candidate(
            "isr_blocking",
            ("probability", "length_us", "tail_us"),
            _blocking,
            _fixed([0.2, 20.0, 0.0], [0.2, 200.0, 0.0], [0.2, 2000.0, 0.0]),
            refinements=({2: 10.0}, {2: 100.0}, {2: 1000.0}),
        ),
        Candidate(
            "timer_quantisation",
            ("tick_us", "origin_us", "nearest"),
            _coarse_ticks,
            _ticks,
        ),
        Candidate(
            "timer_drift",
            ("drift_ppm", "ageing_ppm_h", "warmth_ppm_k"),
            _drift,
            _drift_starts,
            refinements=(
                *({1: size} for size in (1.0, -1.0, 20.0, -20.0)),
                *({2: size} for size in (0.3, -0.3, 5.0, -5.0)),
            ),
        ),
        Candidate(
            "scan_period", ("period_us",), lambda _, p: Change(period_us=p[0]), _scan_periods
        ),
        Candidate(
            "scan_jitter",
            ("jitter_us", "tail_us", "punctual"),
            _jitter,
            _fixed([20.0, 5.0, 0.0], [200.0, 100.0, 0.0], [100.0, 500.0, 0.0], [10.0, 0.0, 0.5]),
            refinements=({2: 0.3},),
        ),
        Candidate(
            "scan_overrun",
            ("probability", "overrun_us", "span_us"),
            _overrun,
            _overruns,
        ),
        Candidate(
            "input_image_delay",
            ("scans",),
            _image_delay,
            _fixed([0.3], [1.0], [1.5], [2.0], [3.0], [4.0]),
        ),
        Candidate(
            "scan_phase_lock",
            ("phase", "spread", "unlocked"),
            lambda _, p: Change(
                wait=(-p[0] % 1.0, float(np.clip(abs(p[1]), 1e-3, LOOSEST)), _share(p[2]))
            ),
            _locks,
        ),
        Candidate(
            "servo_hold",
            ("period_us", "dead_us"),
            lambda scene, p: Change(
                position_um=-scene.speed * (abs(p[0]) + abs(p[1])),
                position_box_um=scene.speed * abs(p[0]),
            ),
            _fixed([50.0, 0.0], [500.0, 0.0], [2000.0, 0.0]),
            refinements=({1: 10.0}, {1: 200.0}),
        ),
        Candidate(
            "following_error",
            ("lag_us", "y_more", "z_more"),
            lambda scene, p: Change(position_um=scene.speed * p[0] * scene.over_x(p[1], p[2])),
            _fixed(*([sign * us, 0.0, 0.0] for us in (10.0, 500.0) for sign in (1.0, -1.0))),
            refinements=_per_axis(1),
        ),
        Candidate(
            "backlash",
            ("backlash_um", "positive_um", "y_more", "z_more"),
            lambda scene, p: Change(
                position_um=np.where(scene.sign < 0.0, -p[0], p[1]) * scene.over_x(p[2], p[3])
            ),
            _fixed(
                *(
                    [sign * negative, sign * positive, 0.0, 0.0]
                    for negative, positive in ((2.0, 0.0), (0.0, 2.0), (2.0, 2.0))
                    for sign in (1.0, -1.0)
                )
            ),
            refinements=({0: 0.1}, {1: 0.1}, *_per_axis(2)),
        ),
        Candidate(
            "transmission_error",
            (
                "amplitude_um",
                "period_mm",
                "phase_deg",
                "amplitude2_um",
                "phase2_deg",
                "y_more",
                "z_more",
            ),
            _transmission,
            _transmission_starts,
            refinements=(
                *({3: 0.3, 4: phase} for phase in (45.0, 135.0, 225.0, 315.0)),
                *_per_axis(5),
            ),
        ),
        Candidate(
            "scale_error",
            ("scale_ppm", "y_more", "z_more"),
            lambda scene, p: Change(
                position_um=scene.sign
                * (p[0] * 1e-3 * np.nan_to_num(scene.touches.position_mm))
                * scene.over_x(p[1], p[2])
            ),
            _fixed([10.0, 0.0, 0.0], [-10.0, 0.0, 0.0], [100.0, 0.0, 0.0], [-100.0, 0.0, 0.0]),
            refinements=_per_axis(1),
        ),
        Candidate(
            "encoder_quantisation",
            ("resolution_um", "is_coordinate"),
            lambda _, p: Change(coarse_um=abs(p[0]), is_on_grid=p[1] == 0.0),
            _resolutions,
        ),
        Candidate(
            "thermal_drift",
            ("drift_um_k", "lag_s", "cold", "y_more", "z_more"),
            lambda scene, p: Change(
                position_um=scene.sign
                * (p[0] * _lagged(scene, abs(p[1]), _share(p[2])))
                * scene.over_x(p[3], p[4])
            ),
            _fixed(
                *(
                    [um, lag_s, 0.0, 0.0, 0.0]
                    for um in (2.0, -2.0)
                    for lag_s in (0.0, 300.0, 3000.0)
                ),
                [2.0, 500.0, 1.0, 0.0, 0.0],
                [-2.0, 500.0, 1.0, 0.0, 0.0],
            ),
            refinements=_per_axis(3),
        ),
        Candidate(
            "rotary_pivot",
            ("x_um", "y_um", "unset", "mirrored"),
            _pivot,
            _fixed(
                *(
                    [x, y, unset, mirrored]
                    for x, y in ((5.0, 0.5), (0.5, -5.0), (-5.0, 0.5), (0.5, 5.0))
                    for unset, mirrored in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))
                )
            ),
        ),
        Candidate(
            "report_delay",
            ("delay_us", "queue_us", "direct"),
            lambda _, p: Change(
                report_us=p[0],
                report_extra=(Extra(1.0 - _share(p[2]), mean=abs(p[1])),),
            ),
            _report_starts,
        ),
    )
}
