"""Forms of the effects of the probe and of the link."""

import numpy as np

from tests.withheld.chain import FloatArray, Numbers, State, Step, lobes_um
from tests.withheld.forms import (
    Draw,
    Form,
    Maker,
    adds,
    gamma,
    in_spells,
    long_tailed,
    now_and_then,
    uniform,
)


def _harmonic(s: State, order: int, amplitude_um: float, phase: float) -> FloatArray:
    elevation = np.cos(np.radians(s.touches.beta_deg))
    return amplitude_um * elevation * np.cos(order * np.radians(s.touches.alpha_deg) + phase)


def _other_lobes(d: Draw) -> Form:
    """Lobes of another amplitude and azimuth, by the vector between the two."""
    amplitude, phase = 1.4 * d.amount_um, d.angle()
    words = f"another {amplitude:.3g} µm of three lobes at {np.degrees(phase):.0f}°/3"
    return Form(
        words, {Step.PROBE: adds("pretravel_um", lambda s: _harmonic(s, 3, amplitude, phase))}
    )


def _lobes_and_harmonics(d: Draw) -> Form:
    amplitude, phase = 1.3 * d.amount_um, d.angle()
    second, sixth = d.between(0.1, 0.35) * amplitude, d.between(0.1, 0.35) * amplitude
    phases = d.angle(), d.angle()

    def more(s: State) -> FloatArray:
        uneven = _harmonic(s, 2, second, phases[0]) + _harmonic(s, 6, sixth, phases[1])
        return _harmonic(s, 3, amplitude, phase) + uneven

    words = f"another {amplitude:.3g} µm of three lobes, {second:.2g} µm of two, {sixth:.2g} of six"
    return Form(words, {Step.PROBE: adds("pretravel_um", more)})


def _pointed_lobes(d: Draw) -> Form:
    """Round valleys and sharp crests, and falling faster with the elevation."""
    amplitude, phase = 2.0 * d.amount_um, d.angle()

    def more(s: State) -> FloatArray:
        third = np.cos(1.5 * np.radians(s.touches.alpha_deg) + phase / 2) ** 4 - 0.375
        return amplitude * np.cos(np.radians(s.touches.beta_deg)) ** 2 * third

    words = f"another {amplitude:.3g} µm of pointed lobes, falling with cos²β"
    return Form(words, {Step.PROBE: adds("pretravel_um", more)})


def _turned_lobes(d: Draw) -> Form:
    """The calibrated lobes, turned; a probe of small lobes shows little of it."""
    probe = d.setup.nominal.probe
    most = max(2 * abs(probe.lobe_um), 1e-9)
    turn = 2 * np.degrees(np.arcsin(min(1.4 * d.amount_um / most, 0.95))) / 3 * d.sense()
    stretch = d.between(0.8, 1.25)

    def more(s: State) -> FloatArray:
        turned = lobes_um(s.touches, stretch * probe.lobe_um, probe.lobe_phase_deg + turn)
        return turned - lobes_um(s.touches, probe.lobe_um, probe.lobe_phase_deg)

    words = f"lobes turned by {turn:.1f}° and {stretch:.2f} as high"
    return Form(words, {Step.PROBE: adds("pretravel_um", more)})


def _late_us(d: Draw) -> float:
    return d.amount_us * d.between(1.0, 2.0)


def _constant_delay(d: Draw) -> Form:
    late = _late_us(d)
    if d.setup.nominal.probe.delay_us > 2 * late:
        late *= d.sense()
    return Form(f"delay {late:+.4g} µs", {Step.PROBE: adds("delay_us", late)})


def _unsteady_delay(d: Draw) -> Form:
    late = _late_us(d)
    tail = d.between(0.2, 0.6)
    words = f"delay {late:+.4g} µs in the mean, lognormal with σ {tail:.2f}"
    return Form(words, {Step.PROBE: adds("delay_us", long_tailed(late, tail))})


def _sagging_battery(d: Draw) -> Form:
    late, more = _late_us(d), d.between(0.1, 0.4)
    end_s = float(d.setup.touches.time_s[-1])

    def sagging(s: State) -> FloatArray:
        return late * (1 + more * (s.touches.time_s / end_s) ** 2)

    words = f"delay {late:+.4g} µs, growing by {100 * more:.0f} % to the end"
    return Form(words, {Step.PROBE: adds("delay_us", sagging)})


def _slot_us(d: Draw) -> float:
    return 3.5 * d.amount_us * d.between(0.7, 1.4)


def _fixed_slots(d: Draw) -> Form:
    period = _slot_us(d)
    origin = d.between(0.0, period)

    def wait(s: State) -> FloatArray:
        return (origin - s.edge_us) % period

    return Form(f"slots every {period:.4g} µs", {Step.EDGE: adds("edge_us", wait)})


def _loose_slots(d: Draw) -> Form:
    """The link wakes anew for every touch, so that its slots keep no common grid."""
    period = _slot_us(d)
    words = f"slots every {period:.4g} µs, begun anew at every touch"
    return Form(words, {Step.EDGE: adds("edge_us", uniform(0.0, period))})


def _jittery_slots(d: Draw) -> Form:
    period = _slot_us(d)
    origin, scatter = d.between(0.0, period), d.between(0.02, 0.1) * period

    def wait(s: State) -> FloatArray:
        return (origin - s.edge_us) % period + s.rng.normal(0.0, 1.0, s.n) ** 2 * scatter

    words = f"slots every {period:.4g} µs, left late by {scatter:.3g} µs"
    return Form(words, {Step.EDGE: adds("edge_us", wait)})


def _retry_us(d: Draw) -> float:
    return 4 * d.amount_us * d.between(0.8, 2.0)


def _geometric_retries(d: Draw) -> Form:
    lost, period = d.often(), _retry_us(d)

    def late(s: State) -> Numbers:
        return (s.rng.geometric(1 - lost, s.n) - 1) * period

    words = f"{100 * lost:.1f} % of the frames are lost, a retry every {period:.4g} µs"
    return Form(words, {Step.EDGE: adds("edge_us", late)})


def _uneven_retries(d: Draw) -> Form:
    """Each retry backs off for a random time."""
    lost, period = d.often(), _retry_us(d)

    def late(s: State) -> FloatArray:
        times = s.rng.geometric(1 - lost, s.n) - 1.0
        return np.where(times > 0, s.rng.gamma(8 * np.maximum(times, 1), period / 8), 0.0)

    words = f"{100 * lost:.1f} % of the frames are lost, retries after {period:.4g} µs ± a third"
    return Form(words, {Step.EDGE: adds("edge_us", late)})


def _retries_in_spells(d: Draw) -> Form:
    lost, period, spell = d.often(), _retry_us(d), d.spell()

    def late(s: State) -> Numbers:
        return s.rng.integers(1, 3, s.n) * period

    words = f"{100 * lost:.1f} % one or two retries of {period:.4g} µs late, {spell.words()}"
    return Form(words, {Step.EDGE: adds("edge_us", in_spells(spell, lost, late))})


def _soft_retries(d: Draw) -> Form:
    lost, period = d.often(), _retry_us(d)
    more = gamma(2.0, 0.2 * period)
    words = f"{100 * lost:.1f} % of the frames are {period:.4g} µs and a gamma fifth late"
    late = now_and_then(lost, lambda s: period + more(s))
    return Form(words, {Step.EDGE: adds("edge_us", late)})


PRETRAVEL_LOBING: dict[str, Maker] = {
    "other lobes": _other_lobes,
    "lobes with 2nd and 6th": _lobes_and_harmonics,
    "pointed lobes": _pointed_lobes,
    "turned lobes": _turned_lobes,
}
TRIGGER_DELAY: dict[str, Maker] = {
    "constant": _constant_delay,
    "lognormal": _unsteady_delay,
    "sagging battery": _sagging_battery,
}
LINK_SLOTTING: dict[str, Maker] = {
    "fixed grid": _fixed_slots,
    "anew each touch": _loose_slots,
    "late grid": _jittery_slots,
}
LINK_RETRY: dict[str, Maker] = {
    "geometric": _geometric_retries,
    "random period": _uneven_retries,
    "in spells": _retries_in_spells,
    "period and gamma": _soft_retries,
}
