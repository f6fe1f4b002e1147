"""Forms of the effects of an axis's geometry: play, screw, scale, warmth, and the table's pivot."""

import numpy as np

from tests.withheld.chain import FloatArray, Numbers, State
from tests.withheld.forms import (
    Draw,
    Form,
    Maker,
    axis_errs,
    errs,
    per_axis_about,
)


def _play_um(d: Draw) -> float:
    return d.amount_um * d.between(1.5, 3.0) * d.sense()


def _one_sense(d: Draw) -> Form:
    play, sense = _play_um(d), d.sense()
    words = f"{play:+.3g} µm in moves of sense {sense:+.0f} only"
    return Form(words, errs(lambda s: play * (s.sign == sense)))


def _both_senses(d: Draw) -> Form:
    play = _play_um(d)
    return Form(f"{play:+.3g} µm between the senses", errs(lambda s: play / 2 * s.sign))


def _play_per_axis(d: Draw) -> Form:
    play = _play_um(d)
    own, words = per_axis_about(d, play)
    return Form(
        f"in moves of negative sense, in µm: {words}", errs(lambda s: own(s) * (s.sign < 0))
    )


def _smoothed_play(d: Draw) -> Form:
    """Slow moves take the play up less than fast ones do."""
    play, slow = _play_um(d), d.between(0.1, 1.0) * float(np.median(d.setup.feed_um_us))

    def error(s: State) -> Numbers:
        return play * (s.sign < 0) * (0.6 + 0.4 * s.speed_um_us / (s.speed_um_us + slow))

    words = f"{play:+.3g} µm in moves of negative sense, 40 % less when slow"
    return Form(words, errs(error))


def _turns(s: State, period_mm: float) -> FloatArray:
    return s.touches.position_mm / period_mm


def _period_mm(d: Draw) -> float:
    return d.pick(2.0, 4.0, 5.0, 10.0, 16.0, 20.0, round(d.between(2.0, 30.0), 3))


def _harmonics(d: Draw) -> Form:
    period, amplitude, phases = _period_mm(d), 1.4 * d.amount_um, [d.angle() for _ in range(3)]
    second, third = d.between(0.1, 0.5), d.between(0.0, 0.3)

    def error(s: State) -> Numbers:
        angle = 2 * np.pi * _turns(s, period)
        uneven = second * np.sin(2 * angle + phases[1]) + third * np.sin(3 * angle + phases[2])
        return amplitude * (np.sin(angle + phases[0]) + uneven)

    words = f"{amplitude:.3g} µm every {period} mm, and {second:.2f} and {third:.2f} of 2nd and 3rd"
    return Form(words, axis_errs(error))


def _sawtooth(d: Draw) -> Form:
    period, height, phase = _period_mm(d), 3.5 * d.amount_um * d.sense(), d.between(0.0, 1.0)
    words = f"a sawtooth of {height:+.3g} µm every {period} mm"
    return Form(words, axis_errs(lambda s: height * ((_turns(s, period) + phase) % 1.0 - 0.5)))


def _growing_wave(d: Draw) -> Form:
    """A screw worn at one end."""
    period, amplitude, phase = _period_mm(d), 1.4 * d.amount_um, d.angle()
    wear = d.between(0.2, 0.7) * d.sense()

    def error(s: State) -> Numbers:
        wave = np.sin(2 * np.pi * _turns(s, period) + phase)
        return amplitude * (1 + wear * s.touches.position_mm / 200.0) * wave

    words = f"{amplitude:.3g} µm every {period} mm, {100 * wear:+.0f} % at one end"
    return Form(words, axis_errs(error))


def _waves_per_axis(d: Draw) -> Form:
    period, phase = _period_mm(d), d.angle()
    own, words = per_axis_about(d, 1.4 * d.amount_um)

    def error(s: State) -> Numbers:
        return own(s) * np.sin(2 * np.pi * _turns(s, period) + phase + s.touches.axis)

    return Form(f"every {period} mm, amplitude in µm: {words}", axis_errs(error))


def _per_mm(d: Draw) -> float:
    """A scale error in µm/mm."""
    return d.sense() * d.amount_um / 100.0


def _one_scale(d: Draw) -> Form:
    scale = _per_mm(d)
    words = f"scale {1e3 * scale:+.3g} ppm"
    return Form(words, axis_errs(lambda s: scale * s.touches.position_mm))


def _bent_scale(d: Draw) -> Form:
    scale, bend = _per_mm(d), d.between(-0.3, 0.3)

    def error(s: State) -> Numbers:
        return scale * s.touches.position_mm * (1 + bend * s.touches.position_mm / 200.0)

    words = f"scale {1e3 * scale:+.3g} ppm, bent by {100 * bend:+.0f} % at the end"
    return Form(words, axis_errs(error))


def _scale_per_axis(d: Draw) -> Form:
    own, words = per_axis_about(d, 1e3 * _per_mm(d))

    def error(s: State) -> Numbers:
        return 1e-3 * own(s) * s.touches.position_mm

    return Form(f"scale in ppm: {words}", axis_errs(error))


def _growing_scale(d: Draw) -> Form:
    """A scale that lies fixed somewhere, and grows from there."""
    touches = d.setup.touches
    fixed_mm = d.between(-1.0, 1.0) * float(np.abs(touches.position_mm).max())
    course = (touches.position_mm - fixed_mm) * (touches.temp_c - 20.0)
    per_k = d.sense() * d.amount_um / max(float(np.sqrt(np.mean(course**2))), 1.0)
    words = f"{1000 * per_k:+.3g} ppm/K, fixed at {fixed_mm:.0f} mm"
    return Form(words, axis_errs(lambda _: per_k * course))


def _per_kelvin(d: Draw) -> float:
    course = d.setup.touches.temp_c - 20.0
    return d.sense() * d.amount_um / max(float(np.sqrt(np.mean(course**2))), 0.2)


def lagging(time_s: FloatArray, course: FloatArray, lag_s: float) -> FloatArray:
    """First-order lag, exact for a course that holds from sample to sample."""
    followed, so_far = np.zeros_like(course), 0.0
    keep = np.exp(-np.diff(time_s, prepend=0.0) / lag_s)
    for i, (kept, now) in enumerate(zip(keep, course, strict=True)):
        so_far = kept * so_far + (1 - kept) * now
        followed[i] = so_far
    return followed


def _warm(course: FloatArray, um_per_k: float, words: str) -> Form:
    """A course of temperature in K over 20 °C, shape (n,), and what it moves the axis by."""
    return Form(f"{um_per_k:+.3g} µm/K {words}", axis_errs(lambda _: um_per_k * course))


def _prompt_drift(d: Draw) -> Form:
    return _warm(d.setup.touches.temp_c - 20.0, _per_kelvin(d), "at once")


def _lagging_drift(d: Draw) -> Form:
    lag_s = d.between(100.0, 2500.0)
    touches = d.setup.touches
    course = lagging(touches.time_s, touches.temp_c - 20.0, lag_s)
    return _warm(course, _per_kelvin(d), f"with a lag of {lag_s:.0f} s")


def _two_lags(d: Draw) -> Form:
    """A part follows soon, the rest late, and something was warm before."""
    soon_s, late_s = d.between(30.0, 300.0), d.between(1000.0, 4000.0)
    offset = 0.3 * d.between(-1.0, 1.0)
    touches = d.setup.touches
    warm = touches.temp_c - 20.0
    course = 0.5 * lagging(touches.time_s, warm, soon_s)
    course = course + 0.5 * lagging(touches.time_s, warm, late_s)
    course = course + offset * np.exp(-touches.time_s / late_s)
    words = f"half with a lag of {soon_s:.0f} s, half of {late_s:.0f} s, from {offset:+.2f} K"
    return _warm(course, _per_kelvin(d), words)


def _creeping_drift(d: Draw) -> Form:
    """Follows the temperature and creeps on with the logarithm of time."""
    touches = d.setup.touches
    creep, after_s = d.between(0.05, 0.2), d.between(200.0, 800.0)
    swing = float(np.sqrt(np.mean((touches.temp_c - 20.0) ** 2)))
    course = touches.temp_c - 20.0 + creep * swing * np.log1p(touches.time_s / after_s)
    return _warm(course, _per_kelvin(d), f"and a creep of {creep:.2f} of it per ln t")


def _drift_per_axis(d: Draw) -> Form:
    per_kelvin = _per_kelvin(d)
    own, words = per_axis_about(d, per_kelvin, per_kelvin)
    course = d.setup.touches.temp_c - 20.0
    return Form(f"in µm/K: {words}", axis_errs(lambda s: own(s) * course))


def _probing(s: State, along_x: Numbers, along_y: Numbers) -> FloatArray:
    """Project a vector onto the probing direction."""
    alpha, beta = np.radians(s.touches.alpha_deg), np.radians(s.touches.beta_deg)
    return np.cos(beta) * (along_x * np.cos(alpha) + along_y * np.sin(alpha))


def _pivot_um(d: Draw) -> float:
    return 2.0 * d.amount_um


def _turning(s: State, radius_um: float, phase: float, sense: float = 1.0) -> FloatArray:
    angle = sense * np.radians(s.touches.rotary_deg) + phase
    return _probing(s, radius_um * np.cos(angle), radius_um * np.sin(angle))


def _plain_pivot(d: Draw) -> Form:
    radius, phase = _pivot_um(d), d.angle()
    words = f"centre off by {radius:.3g} µm at {np.degrees(phase):.0f}°"
    return Form(words, errs(lambda s: _turning(s, radius, phase)))


def _zeroed_pivot(d: Draw) -> Form:
    """The workpiece was set at 0° of the table, where there is no error then."""
    radius, phase = _pivot_um(d), d.angle()

    def error(s: State) -> Numbers:
        at_zero = _probing(s, radius * np.cos(phase), radius * np.sin(phase))
        return _turning(s, radius, phase) - at_zero

    words = f"centre off by {radius:.3g} µm at {np.degrees(phase):.0f}°, none with the table at 0°"
    return Form(words, errs(error))


def _wobbling_pivot(d: Draw) -> Form:
    radius, phase, wobble, other = _pivot_um(d), d.angle(), d.between(0.1, 0.3), d.angle()

    def error(s: State) -> Numbers:
        twice = 2 * np.radians(s.touches.rotary_deg) + other
        more = _probing(s, wobble * radius * np.cos(twice), wobble * radius * np.sin(twice))
        return _turning(s, radius, phase) + more

    words = f"centre off by {radius:.3g} µm, and {100 * wobble:.0f} % of that turning twice as fast"
    return Form(words, errs(error))


def _mirrored_pivot(d: Draw) -> Form:
    """A table that counts the other way round."""
    radius, phase = _pivot_um(d), d.angle()
    words = f"centre off by {radius:.3g} µm, the table turns the other way"
    return Form(words, errs(lambda s: _turning(s, radius, phase, -1.0)))


BACKLASH: dict[str, Maker] = {
    "one sense": _one_sense,
    "both senses": _both_senses,
    "per axis": _play_per_axis,
    "less when slow": _smoothed_play,
}
TRANSMISSION_ERROR: dict[str, Maker] = {
    "harmonics": _harmonics,
    "sawtooth": _sawtooth,
    "worn at one end": _growing_wave,
    "per axis": _waves_per_axis,
}
SCALE_ERROR: dict[str, Maker] = {
    "one scale": _one_scale,
    "bent": _bent_scale,
    "per axis": _scale_per_axis,
}
THERMAL_DRIFT: dict[str, Maker] = {
    "prompt": _prompt_drift,
    "first-order lag": _lagging_drift,
    "two lags and an offset": _two_lags,
    "creeping": _creeping_drift,
    "growing scale": _growing_scale,
    "per axis": _drift_per_axis,
}
ROTARY_PIVOT: dict[str, Maker] = {
    "plain": _plain_pivot,
    "none at 0°": _zeroed_pivot,
    "wobbling": _wobbling_pivot,
    "mirrored": _mirrored_pivot,
}
