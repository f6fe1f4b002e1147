"""Forms of the effects of the skip input and of its clock."""

from collections.abc import Callable, Mapping

import numpy as np

from tests.withheld.chain import FloatArray, Hook, State, Step
from tests.withheld.forms import (
    Amount,
    Draw,
    Form,
    Maker,
    adds,
    in_spells,
    long_tailed,
    now_and_then,
)


def _later(amount: Amount | float, words: str) -> Form:
    return Form(words, {Step.SKIP: adds("skip_us", amount)})


def _latency_us(d: Draw) -> float:
    return d.amount_us * d.between(0.8, 1.6)


def _constant_latency(d: Draw) -> Form:
    late = _latency_us(d)
    if d.setup.nominal.skip.latency_us > 1.2 * late:
        late *= d.sense()
    return _later(late, f"latency {late:+.4g} µs")


def _gaussian_latency(d: Draw) -> Form:
    late, scatter = _latency_us(d), d.between(0.05, 0.25)

    def more(s: State) -> FloatArray:
        return np.abs(s.rng.normal(late, scatter * late, s.n))

    return _later(more, f"latency +{late:.4g} µs, Gaussian, σ {scatter * late:.3g} µs")


def _triangular_latency(d: Draw) -> Form:
    late, half = _latency_us(d), d.between(0.1, 0.6)

    def more(s: State) -> FloatArray:
        return s.rng.triangular((1 - half) * late, late, (1 + half) * late, s.n)

    return _later(more, f"latency +{late:.4g} µs, triangular over ±{half * late:.3g} µs")


def _tailed_latency(d: Draw) -> Form:
    late, tail = _latency_us(d), d.between(0.3, 0.8)
    words = f"latency +{late:.4g} µs in the mean, lognormal with σ {tail:.2f}"
    return _later(long_tailed(late, tail), words)


def _two_ways(d: Draw) -> Form:
    """A short way through the handler and a long one."""
    late, share = _latency_us(d), d.between(0.3, 0.7)

    def more(s: State) -> FloatArray:
        return late * np.where(s.rng.random(s.n) < share, 1.4, 0.7)

    return _later(more, f"latency +{0.7 * late:.4g} or, {100 * share:.0f} %, +{1.4 * late:.4g} µs")


def _masked_us(d: Draw) -> float:
    return 5 * d.amount_us * d.between(0.8, 1.6)


def _masked(s: State, period: float, length: float) -> FloatArray:
    """Time to the end of the masked stretch an edge falls into, else 0."""
    since = (s.pin_us + s.rng.uniform(0.0, period)) % period
    return np.maximum(length - since, 0.0)


def _periodic_mask(d: Draw) -> Form:
    length, share = _masked_us(d), d.often()
    period = length / share
    words = f"masked for {length:.4g} µs every {period:.4g} µs"
    return _later(lambda s: _masked(s, period, length), words)


def _burst_of_masks(d: Draw) -> Form:
    """Three masked stretches in a row, then a pause."""
    length, share = _masked_us(d), d.often()
    period = 3 * length / share

    def more(s: State) -> FloatArray:
        since = (s.pin_us + s.rng.uniform(0.0, period)) % period
        inside = since % (1.5 * length)
        return np.where(since < 4.5 * length, np.maximum(length - inside, 0.0), 0.0)

    words = f"masked three times for {length:.4g} µs every {period:.4g} µs"
    return _later(more, words)


def _long_masks(d: Draw) -> Form:
    length, share = 0.5 * _masked_us(d), d.often()
    words = f"{100 * share:.1f} % masked for {length:.4g} µs, lognormal"
    return _later(now_and_then(share, long_tailed(length, 0.7)), words)


def _masks_in_spells(d: Draw) -> Form:
    length, share, spell = _masked_us(d), d.often(), d.spell()
    words = f"{100 * share:.1f} % masked for the rest of {length:.4g} µs, {spell.words()}"

    def rest(s: State) -> FloatArray:
        return s.rng.uniform(0.0, length, s.n)

    return _later(in_spells(spell, share, rest), words)


def _tick_us(d: Draw) -> float:
    tick = d.setup.nominal.skip.tick_us
    return tick * max(2.0, round(d.size * d.between(0.7, 1.4)))


def _ticking(coarse: Callable[[FloatArray], FloatArray]) -> Mapping[Step, Hook]:
    """Let a coarse clock stamp both paths; the skip input's position is that of its stamp."""

    def read(s: State) -> None:
        s.read_us = np.where(s.touches.on_skip, coarse(s.read_us), s.read_us)

    def stamp(s: State) -> None:
        s.stamp_us = coarse(s.stamp_us)

    return {Step.READ: read, Step.STAMP: stamp}


def _coarse_tick(d: Draw) -> Form:
    tick = _tick_us(d)
    hooks = _ticking(lambda at_us: np.floor(at_us / tick) * tick)
    return Form(f"ticks of {tick:.4g} µs", hooks)


def _nearest_tick(d: Draw) -> Form:
    """A timer that is read in the middle of its coarse tick."""
    tick = _tick_us(d)
    hooks = _ticking(lambda at_us: np.round(at_us / tick) * tick)
    return Form(f"ticks of {tick:.4g} µs, rounded to the nearest", hooks)


def _odd_tick(d: Draw) -> Form:
    """A prescaler that is no multiple of the believed tick, with an origin of its own."""
    tick = _tick_us(d) * d.pick(1.1, 1.28, 1.5)
    origin = d.between(0.0, tick)
    hooks = _ticking(lambda at_us: np.floor((at_us - origin) / tick) * tick + origin)
    return Form(f"ticks of {tick:.4g} µs from an origin of their own", hooks)


def _ppm(d: Draw) -> float:
    """So many ppm that the last stamp is off by some spreads of the report, or by a lot more."""
    end_s = float(d.setup.touches.time_s[-1])
    own_us = d.size * (d.setup.nominal.report.jitter_us + d.setup.nominal.skip.tick_us)
    return d.sense() * min(own_us / end_s * d.pick(1.0, 10.0, 100.0, 1000.0), 300.0)


def _runs_fast(mean_ppm: Amount) -> Hook:
    """Run the device clock fast by so many ppm, in the mean since the start."""

    def hook(s: State) -> None:
        s.stamp_us = s.stamp_us * (1 + 1e-6 * mean_ppm(s))

    return hook


def _constant_rate(d: Draw) -> Form:
    ppm = _ppm(d)
    words = f"device clock off by {ppm:+.4g} ppm"
    return Form(words, {Step.STAMP: _runs_fast(lambda _: ppm)})


def _ageing_rate(d: Draw) -> Form:
    ppm, share = _ppm(d), d.between(0.1, 0.5) * d.sense()
    end = float(d.setup.touches.time_s[-1])
    words = f"device clock off by {ppm:+.4g} ppm, changing by {100 * share:+.0f} % to the end"

    def mean(s: State) -> FloatArray:
        return ppm * (1 + 0.5 * share * 1e-6 * s.stamp_us / end)

    return Form(words, {Step.STAMP: _runs_fast(mean)})


def _warm_rate(d: Draw) -> Form:
    """A quartz that follows the temperature, integrated over the campaign."""
    ppm, per_kelvin = _ppm(d), d.between(0.02, 0.1) * d.sense()
    words = f"device clock off by {ppm:+.4g} ppm, {100 * per_kelvin:+.1f} % of it more per K"

    def mean(s: State) -> FloatArray:
        step_s = np.diff(s.touches.time_s, prepend=0.0)
        over_k_s = np.cumsum((s.touches.temp_c - 20.0) * step_s)
        return ppm * (1 + per_kelvin * over_k_s / s.touches.time_s)

    return Form(words, {Step.STAMP: _runs_fast(mean)})


ISR_LATENCY: dict[str, Maker] = {
    "constant": _constant_latency,
    "Gaussian": _gaussian_latency,
    "triangular": _triangular_latency,
    "lognormal": _tailed_latency,
    "two ways": _two_ways,
}
ISR_BLOCKING: dict[str, Maker] = {
    "periodic": _periodic_mask,
    "three in a row": _burst_of_masks,
    "lognormal": _long_masks,
    "in spells": _masks_in_spells,
}
TIMER_QUANTISATION: dict[str, Maker] = {
    "floor": _coarse_tick,
    "nearest": _nearest_tick,
    "odd tick": _odd_tick,
}
TIMER_DRIFT: dict[str, Maker] = {
    "constant": _constant_rate,
    "ageing": _ageing_rate,
    "with temperature": _warm_rate,
}
