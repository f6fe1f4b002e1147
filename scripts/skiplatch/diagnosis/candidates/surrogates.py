"""What the parameters of an effect make of the physics.

The simulator has its own, exact form of every effect; these are the surrogates that propose.
"""

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.density.law import Extra
from skiplatch.diagnosis.scene.nominal_chain import LOBES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.motion import contact_at
from skiplatch.simulator.effects import Parameter, parameter_of
from skiplatch.units import DEG_PER_TURN, MM_PER_M, S_PER_MIN, UM_PER_MM, US_PER_H

Parameters = FloatArray
MOST_RETRIES = 0.9
MOST_AGAIN = 0.95
MOST = 0.6
NOW_AND_THEN = ("contact_bounce", "isr_blocking", "scan_overrun")
"""Effects on some touches or scans, at most that share of them."""
SWITCHES = (
    *("along_approach", "at_surface", "is_coordinate", "left_out", "mirrored", "moves_surface"),
    "thermometer",
)
"""Parameters of which nothing but whole numbers have a meaning."""
PLACES = ("phase", "second_after", "origin")
"""Parameters that are a place within a period, as a share of it."""
HALF_WAY = 0.5
"""From which on a switch is on."""
LOOSEST = 0.25
"""Spread of the phase in the scan, over a period, beyond which the scans hardly bind it."""
STEEPEST = 5.0
"""Power of the cosine of the elevation that lobes fall with."""
SHORTEST_MM = 0.01
SHORTEST_US = 1e-3
MOST_LAG = 3.0
"""Behind the temperature, over the time that a campaign takes."""
SLOWEST_RATIO = 0.05
DRIFT_ROUNDS = 4
"""Each makes the time that a stamp stands for a thousand times as exact, or more."""


def highest(effect_id: str, parameter: Parameter) -> float:
    """Up to where a parameter is searched: what happens to nearly all touches is another effect."""
    is_partial = effect_id in NOW_AND_THEN and parameter.name == "probability"
    return min(parameter.high, MOST) if is_partial else parameter.high


def turn_of(parameter: Parameter) -> float:
    """Give after how much a parameter is the same again; 0 for one that never is."""
    is_place = parameter.unit == "deg" or parameter.name in PLACES
    return parameter.high if is_place else 0.0


def as_share(value: float) -> float:
    """Keep a share between 0 and 1 wherever the search goes."""
    return min(abs(float(value)), 1.0)


def as_part(value: float) -> float:
    """Keep what happens to some touches from happening to nearly all of them."""
    return min(as_share(value), MOST)


def feed_error(scene: Scene, p: Parameters) -> Change:
    """The axis moves at another feed, or at none above a limit."""
    limit = abs(p[2]) / scene.touches.feed_mm_min if p[2] else np.inf
    ratio = np.minimum(1.0 + p[0] / 100.0 + p[1] / scene.touches.feed_mm_min, limit)
    ratio = np.maximum(ratio, SLOWEST_RATIO)
    return _other_motion(scene, ratio, scene.nominal.axis.accel_mm_s2)


def unfinished(scene: Scene, p: Parameters) -> Change:
    """The axis accelerates more slowly, at some feeds more so than at others."""
    with np.errstate(over="ignore"):  # a power without bounds ends at the bounds of the ratio
        by_feed = (scene.touches.feed_mm_min / MM_PER_M) ** p[1]
    least = parameter_of("unfinished_acceleration", "accel_ratio").low
    ratio = np.clip(p[0] * by_feed, least, 1.0)
    return _other_motion(scene, 1.0, scene.nominal.axis.accel_mm_s2 * ratio)


def _other_motion(
    scene: Scene, feed_ratio: FloatArray | float, accel_mm_s2: FloatArray | float
) -> Change:
    wanted_mm_s = scene.touches.feed_mm_min / S_PER_MIN * feed_ratio
    contact = contact_at(scene.touches, wanted_mm_s, accel_mm_s2)
    return Change(
        contact_us=contact.time_us - scene.contact.time_us,
        speed_ratio=contact.speed_mm_s / scene.contact.speed_mm_s,
    )


def lobing(scene: Scene, p: Parameters) -> Change:
    """Lobes come on top of the calibrated ones, pointed or flat, steeper with the elevation."""
    lobe = LOBES * (scene.alpha - np.deg2rad(p[1]))
    along_um = p[0] * np.cos(lobe) + p[2] * np.cos(2.0 * lobe) + p[3] * np.cos(3.0 * lobe)
    power = np.clip(1.0 + p[4], 0.0, STEEPEST)
    return Change(pretravel_um=along_um * np.abs(scene.cos_beta) ** power)


def slotted(_scene: Scene, p: Parameters) -> Change:
    """Triggers arrive at the end of their slot."""
    slot_us = max(abs(p[0]), SHORTEST_US)
    phase_us = p[1] / DEG_PER_TURN * slot_us
    return Change(
        pin_extra=(Extra(1.0, width=slot_us),), slots=(slot_us, phase_us) if p[1] else None
    )


def retry(_scene: Scene, p: Parameters) -> Change:
    """Attempts fail, and some fail again."""
    share, period = min(as_share(p[0]), MOST_RETRIES), abs(p[1])
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


def bounce(_scene: Scene, p: Parameters) -> Change:
    """Some edges come late, by a least, an exponential and a uniform time."""
    late = Extra(as_part(p[0]), mean=abs(p[1]), offset=abs(p[2]), width=abs(p[3]))
    return Change(pin_extra=(late,))


def blocking(_scene: Scene, p: Parameters) -> Change:
    """Some interrupts wait for the rest of a masked stretch, and a least time before it."""
    late = Extra(as_part(p[0]), width=abs(p[1]), mean=abs(p[2]), offset=abs(p[3]))
    return Change(skip_extra=(late,))


def transmission(scene: Scene, p: Parameters) -> Change:
    """The position errs periodically, with harmonics, each axis by a screw of its own.

    Where it was latched has the error in it, which goes by where the axis was.
    """
    position = np.nan_to_num(_where_mm(scene, p))
    known = _where_mm(scene.whole or scene, p)
    span = float(np.nanmax(known) - np.nanmin(known)) if not np.isnan(known).all() else 0.0
    period = max(abs(p[1]), SHORTEST_MM)
    if not (scene.whole or scene).shortest_wave_mm <= period <= max(span, SHORTEST_MM):
        return NOTHING  # what shows less than a period is not periodic, nor what nobody can see
    ahead, size = np.deg2rad(scene.beyond_x(p[9], p[10])), scene.over_x(p[7], p[8])

    def error_um(position_mm: FloatArray) -> FloatArray:
        turn = 2.0 * np.pi * position_mm / period + ahead
        found = p[0] * np.sin(turn + np.deg2rad(p[2]))
        for order, size_um, phase_deg in ((2.0, p[3], p[4]), (3.0, p[5], p[6])):
            if size_um:
                found = found + size_um * np.sin(order * turn + np.deg2rad(phase_deg))
        return np.asarray(size * found)

    error = error_um(position)
    if not _is_at_surface(p):
        error = error_um(position - error / UM_PER_MM)
    return _farther(scene.sign * error, p[12])


def _is_at_surface(p: Parameters) -> bool:
    """Tell whether a wave counts where the surface should be: so it does where it moves that."""
    return bool(max(p[11], p[12]) > HALF_WAY)


def _where_mm(scene: Scene, p: Parameters) -> FloatArray:
    return scene.touches.position_mm if _is_at_surface(p) else scene.latched_mm


def held(scene: Scene, p: Parameters) -> Change:
    """The position is as old as the last update, which the stamp tells if their phase is known."""
    period_us, dead_us = max(abs(p[0]), SHORTEST_US), abs(p[1])
    age_us = np.full(len(scene), np.nan)
    if p[2]:
        age_us = (scene.touches.latch_us - p[2] / DEG_PER_TURN * period_us) % period_us
    is_told = ~np.isnan(age_us)
    return Change(
        position_us=-(np.where(is_told, age_us, period_us) + dead_us),
        position_box_us=np.where(is_told, 0.0, period_us),
    )


def lagging(scene: Scene, p: Parameters) -> Change:
    """The axis is behind where it is commanded to be; by no time at all, none that scatters."""
    lag_us = p[0] * scene.over_x(p[1], p[2])
    return Change(
        position_us=lag_us,
        position_sigma_us=np.minimum(abs(p[3]), np.abs(lag_us)),
    )


def lost_motion(scene: Scene, p: Parameters) -> Change:
    """The position errs by the sense of motion."""
    by_sense = np.where(scene.sign < 0.0, -p[0], p[1])
    return _farther(by_sense * scene.over_x(p[2], p[3]), p[4])


def scaled(scene: Scene, p: Parameters) -> Change:
    """The position errs in proportion to itself.

    Where it was latched has what it is off by in it: a scale of 100 % would explain anything so.
    """
    most_ppm = parameter_of("scale_error", "scale_ppm").high
    scale_ppm = np.clip(p[0] * scene.over_x(p[1], p[2]), -most_ppm, most_ppm)
    error_um = scale_ppm / UM_PER_MM * np.nan_to_num(scene.latched_mm)
    return _farther(scene.sign * error_um, p[3])


def warmed(scene: Scene, p: Parameters) -> Change:
    """The position follows the temperature, behind it by a lag: all along, or as a scale grows."""
    lag_s = abs(p[2])
    if lag_s > MOST_LAG * float(np.ptp((scene.whole or scene).touches.time_s)):
        return NOTHING  # what hardly moves all the while follows nothing
    warmth_k = _lagged(scene, lag_s, as_share(p[3]), _thermometer(scene, p[8]))
    um_k = p[0] + p[1] / UM_PER_MM * np.nan_to_num(scene.latched_mm)
    sense = 1.0 if p[6] > HALF_WAY else scene.sign
    return _farther(sense * um_k * warmth_k * scene.over_x(p[4], p[5]), p[7])


def _farther(um: FloatArray, moves_surface: float) -> Change:
    """What is read is off along the approach, or the surface lies farther and is met later."""
    return Change(position_um=um, surface_um=um if moves_surface > HALF_WAY else 0.0)


def _thermometer(scene: Scene, number: float) -> int:
    return int(np.rint(np.clip(number, 0.0, len(scene.warmths) - 1.0)))


def _lagged(scene: Scene, lag_s: float, cold: float, thermometer: int) -> FloatArray:
    """Temperature behind a thermometer by a first-order lag; shape (n,)."""
    if scene.whole is not None:
        return _lagged(scene.whole, lag_s, cold, thermometer)[scene.chosen]
    warmth: FloatArray = scene.warmths[thermometer]
    if lag_s <= 0.0 or len(scene) < 2:
        return warmth
    keep = np.exp(-np.diff(scene.touches.time_s) / lag_s)
    # Each is the one before, as far as that is kept, and the thermometer's for the rest.
    bands = np.ones((2, len(warmth)))
    bands[1, :-1] = -keep
    given = np.append((1.0 - cold) * warmth[0], (1.0 - keep) * warmth[1:])
    return np.asarray(scipy.linalg.solve_banded((1, 0), bands, given, check_finite=False))


def delay(_scene: Scene, p: Parameters) -> Change:
    """The pin changes later, by a fixed, a uniform and an exponential time."""
    return Change(pin_us=p[0], pin_extra=_scatter(p))


def interrupt(_scene: Scene, p: Parameters) -> Change:
    """The edge interrupt comes later, by such times."""
    return Change(skip_us=p[0], skip_extra=_scatter(p))


def _scatter(p: Parameters) -> tuple[Extra, ...]:
    return (Extra(1.0, width=abs(p[1]), mean=abs(p[2])),) if p[1] or p[2] else ()


def drift(scene: Scene, p: Parameters) -> Change:
    """The stamps are those of a clock that drifts, ages, and follows the temperature."""
    stamps_us = master_us = scene.touches.latch_us
    for _ in range(DRIFT_ROUNDS):
        rate = (p[0] + p[1] * master_us / US_PER_H) * 1e-6
        warm_us = p[2] * warmth_k_s(scene, master_us) if p[2] else 0.0
        master_us = (stamps_us - warm_us) / (1.0 + rate)
    return Change(stamp_us=stamps_us - master_us)


def warmth_k_s(scene: Scene, now_us: FloatArray) -> FloatArray:
    """Kelvins above the calibration times seconds, from the start to now; shape (n,)."""
    since_s = now_us * 1e-6 - scene.touches.time_s
    return np.asarray(scene.warmth_before_k_s + scene.warmths[0] * since_s)


def later_reports(scene: Scene, p: Parameters) -> Change:
    """The reports take a longer way, the longer the faster the axis steps, and some queue."""
    stepping_us = abs(p[3]) * scene.touches.feed_mm_min / MM_PER_M
    queue = Extra(1.0 - as_share(p[2]), mean=abs(p[1]))
    return Change(report_us=p[0] + stepping_us, report_extra=(queue,))


def pivot(scene: Scene, p: Parameters) -> Change:
    """The table turns about another centre."""
    sense = -1.0 if p[3] > HALF_WAY else 1.0
    turn = sense * np.deg2rad(np.nan_to_num(scene.touches.rotary_deg))
    kept = 1.0 - as_share(p[2])
    shift_x = kept * p[0] - (np.cos(turn) * p[0] - np.sin(turn) * p[1])
    shift_y = kept * p[1] - (np.sin(turn) * p[0] + np.cos(turn) * p[1])
    along = np.cos(scene.alpha) * shift_x + np.sin(scene.alpha) * shift_y
    return _farther(along * scene.cos_beta, p[4])
