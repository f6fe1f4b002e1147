"""Forms of the effects of the scan."""

from collections.abc import Callable

import numpy as np

from tests.withheld.chain import BEFORE, FloatArray, Hook, Numbers, State, Step, play
from tests.withheld.forms import Amount, Draw, Form, Maker


def _strength(d: Draw, per_size: float, most: float) -> float:
    """A share of the scan period."""
    return float(min(per_size * d.size * d.between(0.6, 1.6), most))


def _other_period(d: Draw) -> float:
    """So far off that the scans slip by a good part of a period, or by many, over the campaign."""
    scans = float(d.setup.touches.time_s[-1]) * 1e6 / d.setup.nominal.plc.scan_us
    coarse = _strength(d, 0.005, 0.3)
    fine = 0.1 * d.size / scans
    return d.sense() * d.pick(coarse, coarse, 1e-5 * d.size, fine)


def _sets_period(off: float) -> Hook:
    def hook(s: State) -> None:
        s.scan_us *= 1 + off

    return hook


def _constant_period(d: Draw) -> Form:
    off = _other_period(d)
    return Form(f"scan period off by {100 * off:.4g} %", {Step.RIG: _sets_period(off)})


def _drifting_period(d: Draw) -> Form:
    """The scans run ahead and lag again, by a share of a period, in slow swings."""
    off, period_s, phase = _other_period(d), d.between(300.0, 3000.0), d.angle()
    swing = d.between(0.02, 0.4)

    def hook(s: State) -> None:
        turns = np.sin(2 * np.pi * s.touches.time_s / period_s + phase)
        s.start_us = s.start_us + (swing * s.scan_us * turns)[:, None]

    words = f"scan period off by {100 * off:.4g} %, and {swing:.2f} of a period to and fro"
    return Form(words, {Step.RIG: _sets_period(off), Step.SCAN: hook})


def _limping_period(d: Draw) -> Form:
    """Off, and in turns a little longer and a little shorter."""
    off, limp = _other_period(d), d.between(0.005, 0.05)

    def hook(s: State) -> None:
        s.start_us = s.start_us + limp * (s.scan_number % 2) * np.reshape(s.scan_us, (-1, 1))

    words = f"scan period off by {100 * off:.4g} %, in turns {100 * limp:.2g} % longer and shorter"
    return Form(words, {Step.RIG: _sets_period(off), Step.SCAN: hook})


ScanTimes = Callable[[State], Numbers]


def _late_scans(amount: ScanTimes, words: str) -> Form:
    def hook(s: State) -> None:
        s.start_us = s.start_us + amount(s)

    return Form(words, {Step.SCAN: hook})


def _one_sided_jitter(d: Draw) -> Form:
    spread = _strength(d, 0.01, 0.4) * d.setup.nominal.plc.scan_us
    words = f"scans late by half a Gaussian of {spread:.4g} µs"
    return _late_scans(lambda s: np.abs(s.rng.normal(0.0, spread, s.start_us.shape)), words)


def _uniform_jitter(d: Draw) -> Form:
    most = 2 * _strength(d, 0.01, 0.4) * d.setup.nominal.plc.scan_us
    words = f"scans late by up to {most:.4g} µs, evenly"
    return _late_scans(lambda s: s.rng.uniform(0.0, most, s.start_us.shape), words)


def _two_sided_jitter(d: Draw) -> Form:
    spread = _strength(d, 0.01, 0.25) * d.setup.nominal.plc.scan_us
    words = f"scans scatter about their grid by {spread:.4g} µs, Gaussian"
    return _late_scans(lambda s: s.rng.normal(0.0, spread, s.start_us.shape), words)


def _tailed_jitter(d: Draw) -> Form:
    mean = _strength(d, 0.01, 0.25) * d.setup.nominal.plc.scan_us
    tail = d.between(0.6, 1.2)

    def late(s: State) -> FloatArray:
        return mean * np.exp(s.rng.normal(-(tail**2) / 2, tail, s.start_us.shape))

    return _late_scans(late, f"scans late by {mean:.4g} µs in the mean, lognormal, σ {tail:.2f}")


def _alternating_jitter(d: Draw) -> Form:
    late = 1.5 * _strength(d, 0.01, 0.4) * d.setup.nominal.plc.scan_us

    def amount(s: State) -> FloatArray:
        odd = s.scan_number % 2
        return late * odd + np.abs(s.rng.normal(0.0, 0.2 * late, s.start_us.shape))

    return _late_scans(
        amount, f"every other scan late by {late:.4g} µs, and a fifth of it of noise"
    )


def _overrun(d: Draw) -> tuple[float, float]:
    """Of how many scans, and by how much."""
    share = float(np.clip(0.01 * d.size ** d.between(0.3, 0.9), 0.01, 0.25))
    return share, d.setup.nominal.plc.scan_us * d.between(0.5, 3.0)


def _delays_the_rest(late: FloatArray, s: State) -> FloatArray:
    """Let the scans after a late one wait for it and then catch up, a fifth of a period each."""
    shortest = 0.2 * s.scan_us * np.arange(late.shape[1])
    starts = s.start_us + late
    delayed: FloatArray = np.maximum.accumulate(starts - shortest, axis=1) + shortest
    return delayed - s.start_us


def _lone_overruns(d: Draw) -> Form:
    share, length = _overrun(d)

    def amount(s: State) -> FloatArray:
        hit = s.rng.random(s.start_us.shape) < share
        return _delays_the_rest(hit * length * s.rng.gamma(4.0, 0.25, hit.shape), s)

    return _late_scans(amount, f"{100 * share:.1f} % of the scans {length:.4g} µs late, gamma")


def _left_out(d: Draw) -> Form:
    """A scan that overruns takes the place of the next ones, which are left out."""
    share, _ = _overrun(d)

    def amount(s: State) -> Numbers:
        hit = s.rng.random(s.start_us.shape) < share
        return hit * s.rng.integers(1, 4, hit.shape) * s.scan_us

    return _late_scans(amount, f"{100 * share:.1f} % of the scans left out, up to three in a row")


def _overruns_in_spells(d: Draw) -> Form:
    share, length = _overrun(d)
    spell = d.spell()

    def amount(s: State) -> FloatArray:
        often = min(share / spell.share, 0.6) * spell.holds(s)[:, None]
        hit = s.rng.random(s.start_us.shape) < often
        return _delays_the_rest(hit * length * s.rng.uniform(0.6, 1.4, hit.shape), s)

    words = f"{100 * share:.1f} % of the scans {length:.4g} µs late, {spell.words()}"
    return _late_scans(amount, words)


def _housekeeping(d: Draw) -> Form:
    """Every so many scans one does more."""
    share, length = _overrun(d)
    every = max(4, round(1 / share))

    def amount(s: State) -> FloatArray:
        hit = s.scan_number % every == 0
        return _delays_the_rest(hit * length * s.rng.uniform(0.9, 1.1, hit.shape), s)

    return _late_scans(amount, f"every {every}th scan {length:.4g} µs late")


def _old_image(d: Draw) -> Form:
    scans = int(d.pick(1, 1, 2, 3))

    def hook(s: State) -> None:
        s.image_us = s.image_us - scans * s.scan_us

    return Form(f"image {scans} scans old", {Step.IMAGE: hook})


def _unevenly_old_image(d: Draw) -> Form:
    scans, share = int(d.pick(0, 1, 1)), d.between(0.2, 0.8)

    def hook(s: State) -> None:
        older = s.rng.random((s.n, 1)) < share
        s.image_us = s.image_us - (scans + older) * s.scan_us

    return Form(f"image {scans} scans old, {100 * share:.0f} % one more", {Step.IMAGE: hook})


def _refreshed_image(d: Draw) -> Form:
    """The image is refreshed by a module with a cycle of its own and a transport."""
    cycle = d.setup.nominal.plc.scan_us * d.between(0.3, 0.9)
    transport = d.setup.nominal.plc.scan_us * d.between(0.5, 1.5)

    def hook(s: State) -> None:
        at = s.rng.uniform(0.0, cycle, (s.n, 1))
        s.image_us = np.floor((s.image_us - transport - at) / cycle) * cycle + at

    words = f"image refreshed every {cycle:.4g} µs and {transport:.4g} µs on its way"
    return Form(words, {Step.IMAGE: hook})


def _locks(share: Amount, partly: float, words: str) -> Form:
    """Shift the scans of some touches so that an edge waits so large a share of a period."""

    def hook(s: State) -> None:
        wait = (share(s) % 1.0) * s.scan_us
        shift = wait - (s.start_us[:, BEFORE] - s.pin_us)
        locked = s.rng.random(s.n) < partly
        s.start_us = s.start_us + np.where(locked, shift, 0.0)[:, None]

    return Form(words, {Step.SCAN: hook})


def _beta_parameters(d: Draw) -> tuple[float, float]:
    total = 2 + d.size
    mean = d.between(0.15, 0.85)
    return total * mean, total * (1 - mean)


def _beta_lock(d: Draw) -> Form:
    a, b = _beta_parameters(d)
    words = f"edges wait a share of the scan that is beta({a:.2f}, {b:.2f})"
    return _locks(lambda s: s.rng.beta(a, b, s.n), 1.0, words)


def _two_cluster_lock(d: Draw) -> Form:
    first, gap, width = d.between(0.0, 1.0), d.between(0.25, 0.5), 0.3 / (1 + d.size) + 0.01

    def share(s: State) -> FloatArray:
        centre = first + gap * (s.rng.random(s.n) < 0.4)
        return centre + width * s.rng.normal(0.0, 1.0, s.n)

    words = f"edges wait {first:.2f} or {(first + gap) % 1:.2f} of the scan, ± {width:.3f}"
    return _locks(share, 1.0, words)


def _partial_lock(d: Draw) -> Form:
    partly = float(np.clip(0.1 * d.size**0.6, 0.15, 0.9))
    centre, sharp = d.angle(), 20.0

    def share(s: State) -> FloatArray:
        return s.rng.vonmises(centre, sharp, s.n) / (2 * np.pi)

    words = f"{100 * partly:.0f} % of the edges wait {centre / (2 * np.pi):.2f} of the scan, ± 0.04"
    return _locks(share, partly, words)


def _timed_lock(d: Draw) -> Form:
    """The moves start at such moments: the scans themselves keep their grid."""
    a, b = _beta_parameters(d)
    _, state = play(d.setup, [], d.rng)
    period = d.setup.nominal.plc.scan_us
    wait = d.rng.beta(a, b, state.n) * period
    later = (state.start_us[:, BEFORE] - state.pin_us - wait) % period
    words = f"moves start so that edges wait a share of the scan that is beta({a:.2f}, {b:.2f})"
    spread = np.sqrt(a * b / (a + b + 1)) / (a + b)
    own_size = abs(1 - spread * np.sqrt(12)) + abs(a / (a + b) - 0.5) * np.sqrt(12)
    return Form(words, delay_s=later * 1e-6, own_size=float(own_size))


SCAN_PERIOD: dict[str, Maker] = {
    "constant": _constant_period,
    "drifting": _drifting_period,
    "limping": _limping_period,
}
SCAN_JITTER: dict[str, Maker] = {
    "half Gaussian": _one_sided_jitter,
    "uniform": _uniform_jitter,
    "two-sided": _two_sided_jitter,
    "lognormal": _tailed_jitter,
    "alternating": _alternating_jitter,
}
SCAN_OVERRUN: dict[str, Maker] = {
    "lone": _lone_overruns,
    "left out": _left_out,
    "in spells": _overruns_in_spells,
    "every nth": _housekeeping,
}
INPUT_IMAGE_DELAY: dict[str, Maker] = {
    "whole scans": _old_image,
    "unevenly old": _unevenly_old_image,
    "refreshed": _refreshed_image,
}
SCAN_PHASE_LOCK: dict[str, Maker] = {
    "beta": _beta_lock,
    "two clusters": _two_cluster_lock,
    "partial von Mises": _partial_lock,
    "timed moves": _timed_lock,
}
