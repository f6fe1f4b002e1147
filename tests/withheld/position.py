"""Forms of the effects on how a position is read: held, behind, in steps."""

import numpy as np

from tests.withheld.chain import FloatArray, Numbers, State, Step
from tests.withheld.forms import (
    Amount,
    Draw,
    Form,
    Maker,
    axis_errs,
    errs,
    per_axis_about,
)


def _update_us(d: Draw) -> float:
    return float(np.clip(2 * d.amount_us * d.between(0.8, 1.6), 20.0, 4000.0))


def _held(age: Amount, words: str) -> Form:
    def hook(s: State) -> None:
        s.read_us = s.read_us - age(s)

    return Form(words, {Step.READ: hook})


def _grid_hold(d: Draw) -> Form:
    period = _update_us(d)
    origin = d.between(0.0, period)
    words = f"position of the last update, every {period:.4g} µs"
    return _held(lambda s: (s.read_us - origin) % period, words)


def _late_hold(d: Draw) -> Form:
    """As old as the update, and a dead time more."""
    period, dead = _update_us(d), d.between(0.2, 1.0)
    origin = d.between(0.0, period)
    words = f"position of the last update, every {period:.4g} µs, and {dead:.2f} of that before"
    return _held(lambda s: (s.read_us - origin) % period + dead * period, words)


def _loose_hold(d: Draw) -> Form:
    period = _update_us(d)
    words = f"position up to {period:.4g} µs old, with no common grid"
    return _held(lambda s: s.rng.uniform(0.0, period, s.n), words)


def _lag_us(d: Draw) -> float:
    return d.amount_us * d.between(0.8, 1.6)


def _constant_lag(d: Draw) -> Form:
    lag = _lag_us(d)
    return Form(f"lag {lag:.4g} µs of travel", errs(lambda s: lag * s.speed_um_us))


def _settling_lag(d: Draw) -> Form:
    """The lag has not quite built up yet after a short approach at a high feed."""
    lag, settle_us = _lag_us(d), d.between(5e3, 3e4)

    def error(s: State) -> Numbers:
        moving = s.contact_us - s.touches.time_s * 1e6
        return lag * s.speed_um_us * -np.expm1(-moving / settle_us)

    words = f"lag {lag:.4g} µs of travel, settling in {settle_us:.3g} µs"
    return Form(words, errs(error))


def _lag_per_axis(d: Draw) -> Form:
    lag = _lag_us(d)
    own, words = per_axis_about(d, lag, lag)
    return Form(f"lag in µs of travel: {words}", errs(lambda s: own(s) * s.speed_um_us))


def _bent_lag(d: Draw) -> Form:
    """Feed-forward takes over towards high feeds."""
    lag, bend = _lag_us(d), d.between(0.05, 0.3)
    fast = float(d.setup.feed_um_us.max())

    def error(s: State) -> Numbers:
        return lag * s.speed_um_us * (1 - bend * s.speed_um_us / fast)

    words = f"lag {lag:.4g} µs of travel, {100 * bend:.0f} % less at the highest feed"
    return Form(words, errs(error))


def _coarse_um(d: Draw) -> float:
    return max(3.5 * d.amount_um, 2 * d.setup.nominal.axis.resolution_um) * d.between(0.8, 1.2)


def _coarse_nearest(d: Draw) -> Form:
    step = _coarse_um(d)

    def hook(s: State) -> None:
        s.resolution_um = step

    return Form(f"steps of {step:.4g} µm", {Step.RIG: hook})


def _coordinate_um(s: State) -> FloatArray:
    return s.touches.position_mm * 1e3 + s.sign * s.deviation_um


def _coarse_coordinate(d: Draw) -> Form:
    """The coordinate is what is coarse, and it is cut off."""
    step = _coarse_um(d)

    def error(s: State) -> Numbers:
        where = _coordinate_um(s)
        return (np.floor(where / step) + 0.5) * step - where

    return Form(f"coordinates cut to steps of {step:.4g} µm", axis_errs(error))


def _uneven_steps(d: Draw) -> Form:
    """Steps in turns wider and narrower: two scan heads of an encoder that disagree."""
    step, uneven = _coarse_um(d), d.between(0.1, 0.3)

    def error(s: State) -> Numbers:
        where = _coordinate_um(s)
        number = np.round(where / step)
        return number * step + uneven * step * (number % 2 - 0.5) - where

    words = f"steps of {step:.4g} µm, in turns {100 * uneven:.0f} % wider and narrower"
    return Form(words, axis_errs(error))


SERVO_HOLD: dict[str, Maker] = {
    "grid": _grid_hold,
    "grid and dead time": _late_hold,
    "no grid": _loose_hold,
}
FOLLOWING_ERROR: dict[str, Maker] = {
    "constant": _constant_lag,
    "settling": _settling_lag,
    "per axis": _lag_per_axis,
    "bent": _bent_lag,
}
ENCODER_QUANTISATION: dict[str, Maker] = {
    "nearest": _coarse_nearest,
    "cut coordinate": _coarse_coordinate,
    "uneven steps": _uneven_steps,
}
