"""Rigs and touches drawn at random: the conditions under which a campaign is played."""

from enum import StrEnum

import numpy as np

from skiplatch.campaign import (
    Axis,
    AxisNominal,
    BenchNominal,
    InputNominal,
    InputPath,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
    Touches,
)
from tests.withheld.chain import FloatArray, Setup, travel_us

Rng = np.random.Generator


class Recording(StrEnum):
    """What kind of campaign is recorded."""

    BENCH = "bench"
    STAMPED = "stamped"
    """A machine with latch and report times."""
    POSITION = "position"
    """A machine that kept the deviations only."""


FEED_SETS_MM_MIN = (
    (30, 100, 300, 1000, 3000),
    (60, 300, 1000, 3000),
    (50, 200, 800),
    (100, 400, 1600),
    (120, 500, 2000, 5000),
)
APPROACHES_MM = (2.0, 3.0, 5.0, 8.0)
FROM_FIRST = 0.3
"""Share of the campaigns that begin to count time with their first move."""


def draw_setup(rng: Rng, recording: Recording, touches: tuple[int, int]) -> Setup:
    """Draw a rig and between `touches` many touches, in the order of time."""
    nominal = _nominal(rng, recording)
    n = round(log_uniform(rng, *touches))
    conditions = _touches(rng, nominal, n)
    return Setup(nominal, conditions, round(rng.uniform(0.0, nominal.plc.scan_us), 3))


def _pick(rng: Rng, *values: float) -> float:
    return values[rng.integers(len(values))]


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """Draw a size: every factor between both is as likely."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _nominal(rng: Rng, recording: Recording) -> Nominal:
    bench = recording is Recording.BENCH
    return Nominal(
        kind=Kind.BENCH if bench else Kind.MACHINE,
        probe=_probe(rng, bench=bench),
        input=InputNominal(_pick(rng, 0.0, 0.0, 5.0, 10.0, 20.0, 50.0)),
        skip=SkipNominal(
            latency_us=_pick(rng, 2.0, 4.0, 6.0, 8.0),
            jitter_us=_pick(rng, 0.5, 1.0, 2.0),
            tick_us=_pick(rng, 0.25, 0.5, 1.0),
        ),
        plc=PlcNominal(_pick(rng, 1000.0, 2000.0, 2500.0, 4000.0, 5000.0, 8000.0)),
        axis=AxisNominal(
            resolution_um=_pick(rng, 0.05, 0.1, 0.2, 0.5, 1.0),
            accel_mm_s2=_pick(rng, 500.0, 1000.0, 2000.0, 3000.0, 5000.0),
        ),
        report=ReportNominal(_pick(rng, 250.0, 500.0, 1200.0), _pick(rng, 20.0, 50.0, 100.0)),
        bench=BenchNominal(_pick(rng, 0.05, 0.1) if bench else 0.0),
    )


def _probe(rng: Rng, *, bench: bool) -> ProbeNominal:
    if bench:
        return ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0)
    return ProbeNominal(
        pretravel_um=round(rng.uniform(6.0, 14.0), 4),
        lobe_um=round(rng.uniform(1.0, 4.0), 4),
        lobe_phase_deg=round(rng.uniform(0.0, 120.0), 3),
        repeatability_um=round(rng.uniform(0.15, 0.4), 4),
        delay_us=_pick(rng, 0.0, 500.0, 2000.0, 12680.0),
    )


def _touches(rng: Rng, nominal: Nominal, n: int) -> Touches:
    feed = _feeds(rng, n)
    approach = _approaches(rng, n)
    directions = _directions(rng, n, bench=nominal.kind is Kind.BENCH)
    start = _starts(rng, feed, approach, nominal.axis.accel_mm_s2)
    share = rng.uniform(0.3, 0.7)
    return Touches.from_columns(
        touch=np.arange(n),
        time_s=start,
        path=np.where(rng.random(n) < share, InputPath.PLC, InputPath.SKIP),
        feed_mm_min=feed,
        approach_mm=approach,
        position_mm=_positions(rng, n),
        rotary_deg=_rotary(rng, n, bench=nominal.kind is Kind.BENCH),
        temp_c=_temperature(rng, start),
        **directions,
    )


def _feeds(rng: Rng, n: int) -> FloatArray:
    if rng.random() < 0.15:
        return np.asarray(np.round(np.exp(rng.uniform(3.4, 8.0, n))), np.float64)
    chosen = FEED_SETS_MM_MIN[rng.integers(len(FEED_SETS_MM_MIN))]
    return np.asarray(rng.choice(chosen, n), np.float64)


def _approaches(rng: Rng, n: int) -> FloatArray:
    how = rng.random()
    if how < 0.15:
        return rng.choice(APPROACHES_MM, n)
    longest = 6.0 if how < 0.7 else 10.0
    return np.round(rng.uniform(2.0 if how < 0.85 else 0.5, longest, n), 4)


def _directions(rng: Rng, n: int, *, bench: bool) -> dict[str, FloatArray]:
    """Draw the probing directions; the axis is the one that mostly moves."""
    alpha = rng.integers(4, size=n) * 90.0
    beta = np.zeros(n)
    if not bench:
        if rng.random() < 0.8:
            alpha = np.round(rng.uniform(0.0, 359.999, n), 3)
        beta = rng.choice([0.0, 0.0, 30.0, 60.0], n)
    across = np.cos(np.radians(alpha))
    along = np.sin(np.radians(alpha))
    on_x = np.abs(across) >= np.abs(along)
    axis = np.where(on_x, Axis.X, Axis.Y)
    sign = np.sign(np.where(on_x, across, along))
    if not bench and rng.random() < 0.2:
        down = rng.random(n) < 0.2
        axis[down], sign[down] = Axis.Z, -1.0
        alpha[down], beta[down] = 0.0, -90.0
    return {"axis": axis, "sign": sign, "alpha_deg": alpha, "beta_deg": beta}


def _positions(rng: Rng, n: int) -> FloatArray:
    if rng.random() < 0.15:  # a few surfaces, touched again and again
        places = rng.uniform(-200.0, 200.0, 24)
        return np.asarray(np.round(rng.choice(places, n), 3), np.float64)
    return np.round(rng.uniform(-200.0, 200.0, n), 3)


def _rotary(rng: Rng, n: int, *, bench: bool) -> FloatArray:
    step = _pick(rng, 90.0, 90.0, 45.0, 30.0)
    steps = np.zeros(n) if bench else rng.integers(int(360 / step), size=n)
    return np.asarray(steps * step, np.float64)


def _starts(rng: Rng, feed: FloatArray, approach: FloatArray, accel: float) -> FloatArray:
    """Leave a rest of some seconds, and now and then a pause, between the moves.

    Some count time from their first move on.
    """
    n = len(feed)
    speed, accels = feed / 60_000.0, np.full(n, accel * 1e-9)
    move_s = travel_us(approach * 1e3, speed, accels) * 1e-6
    rest_s = rng.uniform(2.0, 6.0, n) + rng.exponential(2.0, n)
    rest_s += (rng.random(n) < 0.04) * rng.uniform(20.0, 90.0, n)
    start_s = np.cumsum(rest_s) + np.cumsum(move_s) - move_s
    is_from_first = rng.spawn(1)[0].random() < FROM_FIRST
    return np.asarray(np.round(start_s - start_s[0] * is_from_first, 6), np.float64)


def _temperature(rng: Rng, time_s: FloatArray) -> FloatArray:
    """Warming up, a random walk, a day's swing or nearly nothing."""
    step_s = np.diff(time_s, prepend=0.0)
    walk = np.cumsum(rng.normal(0.0, 1.0, len(time_s)) * np.sqrt(step_s))
    how = rng.random()
    if how < 0.5:
        course = rng.uniform(1.0, 4.0) * (1 - np.exp(-time_s / rng.uniform(1000.0, 5000.0)))
        course += 0.002 * walk
    elif how < 0.75:
        course = rng.uniform(0.01, 0.03) * walk
    elif how < 0.9:
        swing = np.sin(time_s / rng.uniform(1500.0, 4000.0) + rng.uniform(0.0, 6.0))
        course = rng.uniform(0.5, 3.0) * swing
    else:
        course = 0.002 * walk
    return np.round(20.0 + course + rng.normal(0.0, 0.015, len(time_s)), 3)
