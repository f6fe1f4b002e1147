"""Forms of the effects of the motion."""

import numpy as np

from tests.withheld.chain import FloatArray, State, Step
from tests.withheld.forms import Draw, Form, Maker, adds, scales


def _override(d: Draw) -> float:
    return d.sense() * float(np.clip(0.002 * d.size * d.pick(1.0, 1.0, 0.1), 1e-4, 0.4))


def _constant_override(d: Draw) -> Form:
    off = _override(d)
    return Form(f"feed {1 + off:.4f} of the programmed", {Step.RIG: scales("feed_um_us", 1 + off)})


def _swinging_override(d: Draw) -> Form:
    off, period, phase = _override(d), d.between(800.0, 4000.0), d.angle()

    def factor(s: State) -> FloatArray:
        return 1 + off * (1 + 0.5 * np.sin(2 * np.pi * s.touches.time_s / period + phase))

    words = f"feed off by {100 * off:.2f} %, half of it swinging in {period:.0f} s"
    return Form(words, {Step.RIG: scales("feed_um_us", factor)})


def _feed_cap(d: Draw) -> Form:
    feeds = d.setup.feed_um_us
    cap = float(feeds.max()) * (1 - abs(_override(d)))

    def factor(s: State) -> FloatArray:
        return np.minimum(1.0, cap / s.feed_um_us)

    words = f"no feed above {cap * 60_000:.1f} mm/min"
    return Form(words, {Step.RIG: scales("feed_um_us", factor)})


def _feed_offset(d: Draw) -> Form:
    off = 0.1 * _override(d) * float(np.median(d.setup.feed_um_us))
    least = 0.3 * float(d.setup.feed_um_us.min())
    off = max(off, -least)
    words = f"feed off by {off * 60_000:.3g} mm/min at any feed"
    return Form(words, {Step.RIG: adds("feed_um_us", off)})


def _slower(d: Draw) -> float:
    return 1 / (1 + 0.15 * d.size * d.pick(1.0, 1.0, 0.1, 0.01))


def _low_acceleration(d: Draw) -> Form:
    factor = _slower(d)
    words = f"acceleration {factor:.3f} of the believed"
    return Form(words, {Step.RIG: scales("accel_um_us2", factor)})


def _soft_start(d: Draw) -> Form:
    """Speed approaches the feed exponentially: v(t) = feed (1 − exp(−t/τ))."""
    factor = _slower(d)

    def hook(s: State) -> None:
        tau = s.feed_um_us / (s.accel_um_us2 * factor)
        cruise = s.touches.approach_mm * 1e3 / s.feed_um_us
        moving = cruise + tau
        for _ in range(200):
            moving = cruise + tau * -np.expm1(-moving / tau)
        s.contact_us = s.touches.time_s * 1e6 + moving
        s.speed_um_us = s.feed_um_us * -np.expm1(-moving / tau)

    words = f"soft start, first order with {1 / factor:.2f} of the believed time of acceleration"
    return Form(words, {Step.MOVE: hook})


def _weak_when_fast(d: Draw) -> Form:
    factor = _slower(d)

    def weaken(s: State) -> FloatArray:
        return factor + (1 - factor) * np.exp(-((s.feed_um_us / 0.02) ** 2))

    words = f"acceleration falls to {factor:.3f} of the believed towards high feeds"
    return Form(words, {Step.RIG: scales("accel_um_us2", weaken)})


FEED_ERROR: dict[str, Maker] = {
    "constant override": _constant_override,
    "swinging override": _swinging_override,
    "capped": _feed_cap,
    "offset": _feed_offset,
}
UNFINISHED_ACCELERATION: dict[str, Maker] = {
    "low acceleration": _low_acceleration,
    "soft start": _soft_start,
    "weak when fast": _weak_when_fast,
}
