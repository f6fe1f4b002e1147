"""Forms of the effects of the input and of the report."""

import numpy as np

from tests.withheld.chain import FloatArray, Numbers, State, Step
from tests.withheld.forms import (
    Amount,
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


def _filter_us(d: Draw) -> float:
    return d.amount_us * d.between(1.0, 2.0)


def _constant_filter(d: Draw) -> Form:
    more = _filter_us(d)
    if d.setup.nominal.input.filter_us > 1.5 * more:
        more *= d.sense()
    return Form(f"filter {more:+.4g} µs", {Step.RIG: adds("filter_us", more)})


def _resistor_capacitor(d: Draw) -> Form:
    """An edge of uneven height crosses the threshold of an RC filter unevenly late."""
    more, scatter = _filter_us(d), d.between(0.03, 0.15)
    words = f"RC filter {more:+.4g} µs, scattering by {100 * scatter:.0f} %"

    def late(s: State) -> FloatArray:
        return more * np.exp(scatter * s.rng.normal(0.0, 1.0, s.n))

    return Form(words, {Step.PIN: adds("pin_us", late)})


def _sampled_filter(d: Draw) -> Form:
    """So many equal samples in a row."""
    samples = int(d.pick(4, 6, 8))
    period = _filter_us(d) / samples
    words = f"{samples} equal samples, one every {period:.3g} µs, on top"

    def late(s: State) -> FloatArray:
        return s.rng.uniform(samples - 1, samples, s.n) * period

    return Form(words, {Step.PIN: adds("pin_us", late)})


def _bounce(late: Amount, d: Draw, words: str) -> Form:
    share = d.often()
    words = f"{100 * share:.1f} % of the edges late by {words}"
    return Form(words, {Step.PIN: adds("pin_us", now_and_then(share, late))})


def _bounce_us(d: Draw) -> float:
    return 4 * d.amount_us * d.between(0.8, 2.0)


def _uniform_bounce(d: Draw) -> Form:
    most = 2 * _bounce_us(d)
    return _bounce(uniform(0.0, most), d, f"0…{most:.4g} µs")


def _gamma_bounce(d: Draw) -> Form:
    mean, shape = _bounce_us(d), d.between(1.5, 5.0)
    return _bounce(gamma(shape, mean), d, f"{mean:.4g} µs, gamma of shape {shape:.1f}")


def _fixed_bounce(d: Draw) -> Form:
    late = _bounce_us(d)
    return _bounce(uniform(0.97 * late, 1.03 * late), d, f"{late:.4g} µs")


def _two_bounces(d: Draw) -> Form:
    late, share = _bounce_us(d), d.between(0.2, 0.5)

    def clusters(s: State) -> FloatArray:
        once = s.rng.normal(late, 0.1 * late, s.n)
        return np.abs(once + (s.rng.random(s.n) < share) * s.rng.normal(late, 0.1 * late, s.n))

    return _bounce(clusters, d, f"{late:.4g} µs or twice that ({100 * share:.0f} %)")


def _slow_bounce(d: Draw) -> Form:
    """The slower the touch, the more it bounces."""
    share, mean = d.often(), _bounce_us(d)
    slow = float(np.median(d.setup.feed_um_us))
    late = gamma(2.0, mean)

    def bounce(s: State) -> Numbers:
        often = 2 * share / (1 + s.speed_um_us / slow)
        return (s.rng.random(s.n) < often) * late(s)

    words = f"{200 * share:.1f} % of the slow edges and fewer fast ones late by {mean:.4g} µs"
    return Form(words, {Step.PIN: adds("pin_us", bounce)})


def _losing(often: Amount, words: str) -> Form:
    def hook(s: State) -> None:
        s.missed = s.missed | (s.rng.random(s.n) < often(s))

    return Form(words, {Step.PIN: hook})


def _even_loss(d: Draw) -> Form:
    share = d.often()
    return _losing(lambda _: share, f"{100 * share:.1f} % of the edges lost")


def _loss_in_spells(d: Draw) -> Form:
    share, spell = d.often(), d.spell()

    def often(s: State) -> FloatArray:
        return min(share / spell.share, 0.8) * spell.holds(s)

    return _losing(often, f"{100 * share:.1f} % of the edges lost, {spell.words()}")


def _fast_loss(d: Draw) -> Form:
    share = d.often()
    fast = float(d.setup.feed_um_us.max())

    def often(s: State) -> FloatArray:
        return np.minimum(2 * share * np.sqrt(s.speed_um_us / fast), 0.9)

    return _losing(often, f"up to {200 * share:.1f} % of the edges lost, most at high feeds")


def _report_us(d: Draw) -> float:
    report = d.setup.nominal.report
    return d.size * (report.jitter_us / 3 + d.setup.nominal.skip.tick_us) * d.between(0.8, 1.5)


def _constant_report(d: Draw) -> Form:
    late = _report_us(d)
    return Form(f"reports {late:.4g} µs late", {Step.REPORT: adds("report_us", late)})


def _queue(d: Draw) -> Form:
    late, busy = _report_us(d), d.between(0.3, 0.8)
    words = f"{100 * busy:.0f} % of the reports queue for {late:.4g} µs, exponential"
    wait = now_and_then(busy, gamma(1.0, late))
    return Form(words, {Step.REPORT: adds("report_us", wait)})


def _other_frame(d: Draw) -> Form:
    """Another frame is on the bus, and the report waits for its end, or for two of them."""
    late, share = 2 * _report_us(d), d.between(0.15, 0.5)

    def frames(s: State) -> FloatArray:
        return late * (1.0 + (s.rng.random(s.n) < 0.25)) * s.rng.uniform(0.95, 1.05, s.n)

    words = f"{100 * share:.0f} % of the reports one or two frames of {late:.4g} µs late"
    return Form(words, {Step.REPORT: adds("report_us", now_and_then(share, frames))})


def _busy_spells(d: Draw) -> Form:
    late, spell = 1.5 * _report_us(d), d.spell()
    words = f"reports {late:.4g} µs late, lognormal, {spell.words()}"
    wait = in_spells(spell, 0.9 * spell.share, long_tailed(late, 0.5))
    return Form(words, {Step.REPORT: adds("report_us", wait)})


INPUT_FILTER: dict[str, Maker] = {
    "constant": _constant_filter,
    "scattering RC": _resistor_capacitor,
    "equal samples": _sampled_filter,
}
CONTACT_BOUNCE: dict[str, Maker] = {
    "uniform": _uniform_bounce,
    "gamma": _gamma_bounce,
    "fixed": _fixed_bounce,
    "two clusters": _two_bounces,
    "more when slow": _slow_bounce,
}
LOST_TRIGGER: dict[str, Maker] = {
    "even": _even_loss,
    "in spells": _loss_in_spells,
    "more when fast": _fast_loss,
}
REPORT_DELAY: dict[str, Maker] = {
    "constant": _constant_report,
    "queue": _queue,
    "one or two frames": _other_frame,
    "in spells": _busy_spells,
}
