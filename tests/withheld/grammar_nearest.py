"""Shapes that the effects of the catalogue can take, by what they move: columns to fit with.

Every group is one effect in one form, free in its amounts. Groups may do more than the effect can
do (an effect's senses are free here, and so is each axis): what comes near to one of them is left
out of the strangers, and leaving out too much does no harm.
"""

from collections.abc import Mapping

import numpy as np

from tests.withheld.chain import FloatArray, Setup
from tests.withheld.geometry import lagging

LAGS_S = (0.0, 100.0, 300.0, 1e3, 3e3, 1e4, 1e5)
PERIODS_MM = (60.0, 90.0, 130.0, 200.0, 300.0, 400.0, 600.0, 1000.0)
"""Long ones: a hat over all of the axis is a period of that length."""
BENDS = (0.0, 0.15, 0.3)
CALIBRATED_C = 20.0
Groups = Mapping[str, FloatArray]


def _columns(*columns: FloatArray) -> FloatArray:
    return np.stack(columns, axis=1)


def _axes(setup: Setup) -> FloatArray:
    """Mark the axes, shape (n, axes)."""
    axis = setup.touches.axis
    return np.asarray(axis[:, None] == np.unique(axis), np.float64)


def datum(setup: Setup) -> FloatArray:
    """What an unknown place of the surface takes up of lengths, shape (n, …)."""
    return np.ones((len(setup.touches), 1)) if setup.on_bench else _axes(setup)


def groups(setup: Setup, observable: str) -> Groups:
    """Give the columns of every effect that moves an observable, by its name."""
    if observable == "length":
        return {**_by_speed(setup), **_by_direction(setup), **_by_coordinate(setup)}
    if observable == "start":
        return {**_by_way(setup), **_by_clock(setup)}
    return _by_clock(setup) if observable == "stamp" else {}


def _by_speed(setup: Setup) -> dict[str, FloatArray]:
    speed, time_s = setup.feed_um_us, setup.touches.time_s
    fast, elapsed = speed.max(), time_s / time_s[-1]
    found = {
        f"following_error, bent by {b}": _columns(speed * (1 - b * speed / fast)) for b in BENDS
    }
    found["following_error per axis"] = _axes(setup) * speed[:, None]
    found["trigger_delay, sagging"] = _columns(speed * (1 + 0.3 * elapsed**2))
    return found


def _by_direction(setup: Setup) -> dict[str, FloatArray]:
    touches, speed = setup.touches, setup.feed_um_us
    alpha, rotary = np.radians(touches.alpha_deg), np.radians(touches.rotary_deg)
    level = np.cos(np.radians(touches.beta_deg))
    sense = touches.sign.astype(float)

    def turning(angle: FloatArray) -> FloatArray:
        return _columns(level * np.cos(angle), level * np.sin(angle))

    smoothed = sense * speed / (speed + np.median(speed))
    return {
        "pretravel_lobing": np.hstack([turning(3 * alpha), turning(6 * alpha)]),
        "backlash": np.hstack([_axes(setup) * sense[:, None], smoothed[:, None]]),
        "rotary_pivot": turning(alpha - rotary),
        "rotary_pivot, mirrored": turning(alpha + rotary),
        "rotary_pivot, none at 0°": turning(alpha - rotary) - turning(alpha),
    }


def _by_coordinate(setup: Setup) -> dict[str, FloatArray]:
    touches = setup.touches
    axes = _axes(setup) * touches.sign[:, None]
    place, time_s = touches.position_mm, touches.time_s
    found = {"scale_error": np.hstack([axes * place[:, None], axes * place[:, None] ** 2 / 600.0])}
    for period in PERIODS_MM:
        angle = 2 * np.pi * np.outer(place / period, [1.0, 2.0, 3.0])
        waves = np.hstack([np.sin(angle), np.cos(angle)])
        found[f"transmission_error every {period:g} mm"] = waves * touches.sign[:, None]
    warmth = touches.temp_c - CALIBRATED_C
    for lag_s in LAGS_S:
        course = lagging(time_s, warmth, lag_s) if lag_s else warmth
        cold = np.exp(-time_s / lag_s) if lag_s else np.zeros_like(time_s)
        grown = axes * place[:, None]
        parts = [column * c[:, None] for column in (axes, grown) for c in (course, cold)]
        found[f"thermal_drift with a lag of {lag_s:g} s"] = np.hstack(parts)
    return found


def _by_clock(setup: Setup) -> dict[str, FloatArray]:
    time_s = setup.touches.time_s
    warmth = np.cumsum((setup.touches.temp_c - CALIBRATED_C) * np.diff(time_s, prepend=0.0))
    return {"timer_drift": _columns(time_s, time_s**2, warmth)}


def _by_way(setup: Setup) -> dict[str, FloatArray]:
    speed, approach = setup.feed_um_us, setup.touches.approach_mm
    return {
        "feed_error": _columns(approach / speed, approach / speed**2),
        "unfinished_acceleration": _columns(speed, speed**2),
        "the datum": _axes(setup) / speed[:, None],
    }
