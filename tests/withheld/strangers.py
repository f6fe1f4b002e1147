"""Effects that no catalogue knows, and base models that are a little off and no more."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tests.withheld.chain import FloatArray, State, Step, lobes_um
from tests.withheld.forms import Draw, Form, Maker, adds, errs


@dataclass(frozen=True)
class Stranger:
    """An effect from outside the catalogue.

    Attributes:
        note: What it is, in a line.
        make: Draws a form of it.
        on_bench: Whether a bench can have it.
        on_machine: Whether a machine can.
        needs: Columns that must have been recorded.
    """

    note: str
    make: Maker
    on_bench: bool = False
    on_machine: bool = True
    needs: frozenset[str] = frozenset()


def _bending(d: Draw) -> Form:
    per_mm = d.sense() * d.amount_um / 3.0
    words = f"{per_mm:+.3g} µm per mm of approach"
    return Form(words, errs(lambda s: per_mm * s.touches.approach_mm))


def _short(d: Draw) -> Form:
    share, short = d.between(0.04, 0.2), d.between(15.0, 60.0)

    def error(s: State) -> FloatArray:
        size = np.abs(s.rng.normal(short, 0.2 * short, s.n))
        return np.where(s.rng.random(s.n) < share, -size, 0.0)

    return Form(f"{100 * share:.1f} % short by {short:.0f} µm", errs(error))


def _since_last_s(s: State) -> FloatArray:
    return np.diff(s.touches.time_s, prepend=s.touches.time_s[0] - 10.0)


def _rest(d: Draw) -> Form:
    most, relax_s = 2.5 * d.amount_um * d.sense(), d.between(8.0, 30.0)
    words = f"{most:+.3g} µm after a long rest, building up in {relax_s:.0f} s"
    return Form(words, errs(lambda s: most * -np.expm1(-_since_last_s(s) / relax_s)))


def _wake_up(d: Draw) -> Form:
    most, sleep_s = 4.0 * d.amount_us, d.between(8.0, 30.0)
    words = f"latched {most:.4g} µs late after a long rest, building up in {sleep_s:.0f} s"

    def late(s: State) -> FloatArray:
        return most * -(np.expm1(-_since_last_s(s) / sleep_s) ** 2)

    return Form(words, {Step.SKIP: adds("skip_us", late)})


def _one_lobe(d: Draw) -> Form:
    amplitude, azimuth = 1.4 * d.amount_um, d.angle()

    def error(s: State) -> FloatArray:
        return amplitude * np.cos(np.radians(s.touches.alpha_deg) - azimuth)

    return Form(f"one lobe of {amplitude:.3g} µm at {np.degrees(azimuth):.0f}°", errs(error))


def _two_clocks(d: Draw) -> Form:
    off = d.sense() * d.size * (50.0 + d.setup.nominal.report.jitter_us)
    spell = d.spell()
    words = f"stamps off by {off:+.0f} µs {spell.words()}"
    return Form(words, {Step.STAMP: adds("stamp_us", lambda s: off * spell.holds(s))})


def _feed_squared(d: Draw) -> Form:
    fast = float(np.quantile(d.setup.feed_um_us, 0.9))
    most = 2.0 * d.amount_um * d.sense()
    words = f"{most:+.3g} µm at {fast * 60_000:.0f} mm/min, with the feed squared"
    return Form(words, errs(lambda s: most * (s.speed_um_us / fast) ** 2))


def _feed_noise(d: Draw) -> Form:
    fast = float(np.quantile(d.setup.feed_um_us, 0.9))
    most = 2.0 * d.amount_um

    def error(s: State) -> FloatArray:
        return most * np.sqrt(s.speed_um_us / fast) * s.rng.normal(0.0, 1.0, s.n)

    return Form(f"noise of {most:.3g} µm at high feeds, with the feed's root", errs(error))


def _step(d: Draw) -> Form:
    at_s = d.between(0.25, 0.75) * float(d.setup.touches.time_s[-1])
    step = 2.0 * d.amount_um * d.sense()
    words = f"{step:+.3g} µm from {at_s:.0f} s on"
    return Form(words, errs(lambda s: step * (s.touches.time_s > at_s)))


def _seat(d: Draw) -> Form:
    """The stylus comes back to a seat that depends on where it was pushed before."""
    amplitude, azimuth = 1.4 * d.amount_um, d.angle()

    def error(s: State) -> FloatArray:
        before = np.roll(s.touches.alpha_deg, 1)
        return amplitude * np.cos(np.radians(before) - azimuth)

    return Form(f"{amplitude:.3g} µm with the direction of the touch before", errs(error))


def _slow_wave(d: Draw) -> Form:
    end_s = float(d.setup.touches.time_s[-1])
    period_s, phase = end_s / d.between(2.5, 8.0), d.angle()
    amplitude = 1.4 * d.amount_um
    words = f"{amplitude:.3g} µm swinging in {period_s:.0f} s"
    return Form(
        words,
        errs(lambda s: amplitude * np.sin(2 * np.pi * s.touches.time_s / period_s + phase)),
    )


def _latency_wave(d: Draw) -> Form:
    end_s = float(d.setup.touches.time_s[-1])
    period_s, phase = end_s / d.between(2.5, 8.0), d.angle()
    amplitude = 2.0 * d.amount_us

    def late(s: State) -> FloatArray:
        return amplitude * (1 + np.sin(2 * np.pi * s.touches.time_s / period_s + phase))

    words = f"skip late by up to {2 * amplitude:.4g} µs, swinging in {period_s:.0f} s"
    return Form(words, {Step.SKIP: adds("skip_us", late)})


def _sag(d: Draw) -> Form:
    amplitude = 2.0 * d.amount_um * d.sense()
    words = f"{amplitude:+.3g} µm with the sine of the elevation"
    return Form(words, errs(lambda s: amplitude * np.sin(np.radians(s.touches.beta_deg))))


def _every_nth(d: Draw) -> Form:
    every, error = int(d.pick(5, 7, 8, 12)), 3.0 * d.amount_um * d.sense()
    words = f"{error:+.3g} µm at every {every}th touch"
    return Form(words, errs(lambda s: error * (s.touches.touch % every == 0)))


def _false_trigger(d: Draw) -> Form:
    """Vibration triggers before the contact."""
    share, early = d.between(0.02, 0.15), d.between(0.2, 0.8)

    def hook(s: State) -> None:
        s.false = s.rng.random(s.n) < share
        moving = s.contact_us - s.touches.time_s * 1e6
        before = s.rng.uniform(0.0, early, s.n) * moving
        s.edge_us = np.where(s.false, s.contact_us - before, s.edge_us)

    words = f"{100 * share:.1f} % of the moves trigger before the contact"
    return Form(words, {Step.EDGE: hook})


def _shaken(d: Draw) -> Form:
    spell, noise = d.spell(), 2.5 * d.amount_um
    words = f"noise of {noise:.3g} µm {spell.words()}"

    def error(s: State) -> FloatArray:
        return noise * spell.holds(s) * s.rng.normal(0.0, 1.0, s.n)

    return Form(words, errs(error))


ALPHA = frozenset({"alpha_deg", "beta_deg"})
STAMPS = frozenset({"latch_us"})
REPORTS = frozenset({"latch_us", "report_us"})

STRANGERS: Mapping[str, Stranger] = {
    "stylus_bending": Stranger("the deviation grows with the length of the approach", _bending),
    "short_readings": Stranger(
        "now and then the deviation falls short by tens of µm, at every feed", _short, on_bench=True
    ),
    "rest_error": Stranger("the error grows with the time since the last touch", _rest),
    "wake_up": Stranger(
        "the skip input latches the later the longer it slept", _wake_up, on_bench=True
    ),
    "one_lobe": Stranger("one lobe: the error goes with cos α", _one_lobe, needs=ALPHA),
    "two_state_clock": Stranger(
        "the device clock jumps between two offsets", _two_clocks, on_bench=True, needs=STAMPS
    ),
    "feed_squared": Stranger("the deviation goes with the feed squared", _feed_squared),
    "feed_noise": Stranger("the scatter grows with the feed", _feed_noise, on_bench=True),
    "step_in_time": Stranger("the deviation jumps once in the campaign", _step),
    "seat_error": Stranger("the error depends on the direction of the touch before", _seat),
    "slow_wave": Stranger("the deviation swings slowly with time", _slow_wave),
    "latency_wave": Stranger(
        "the skip latency swings slowly with time", _latency_wave, on_bench=True, on_machine=False
    ),
    "elevation_sag": Stranger("the error goes with sin β", _sag),
    "every_nth": Stranger("every nth touch is off by the same", _every_nth, on_bench=True),
    "false_triggers": Stranger("vibration triggers before the contact", _false_trigger),
    "shaken": Stranger("the scatter is larger in spells", _shaken, on_bench=True),
}


def _heavy_tails(d: Draw) -> Form:
    """Pretravel scatter as large as believed, of Student's t with five degrees of freedom."""
    repeatability = d.setup.nominal.probe.repeatability_um

    def hook(s: State) -> None:
        probe = s.setup.nominal.probe
        lobes = lobes_um(s.touches, probe.lobe_um, probe.lobe_phase_deg)
        scatter = repeatability * s.rng.standard_t(5, s.n) / np.sqrt(5 / 3)
        s.pretravel_um = probe.pretravel_um + lobes + scatter

    return Form("repeatability with heavier tails, Student's t with 5", {Step.PROBE: hook})


def _lobes_off(d: Draw) -> Form:
    probe = d.setup.nominal.probe
    off = 0.05 * probe.lobe_um * d.sense()

    def more(s: State) -> FloatArray:
        return lobes_um(s.touches, off, probe.lobe_phase_deg)

    return Form(f"lobes off by {off:+.3g} µm", {Step.PROBE: adds("pretravel_um", more)})


def _triangular_jitter(d: Draw) -> Form:
    skip = d.setup.nominal.skip

    def hook(s: State) -> None:
        span = skip.jitter_us
        s.skip_us = s.pin_us + skip.latency_us + s.rng.triangular(0, span / 2, span, s.n)

    return Form("skip jitter triangular over the believed span", {Step.SKIP: hook})


def _report_shape(d: Draw) -> Form:
    report = d.setup.nominal.report

    def hook(s: State) -> None:
        share = s.rng.beta(1.3, 1.3, s.n)
        s.report_us = s.latch_us + report.latency_us + report.jitter_us * share

    return Form("report jitter a little rounder than even", {Step.REPORT: hook})


DULL: Mapping[str, Stranger] = {
    "heavy_tails": Stranger("the repeatability has heavier tails", _heavy_tails),
    "lobes_off": Stranger("the lobes are 5 % off", _lobes_off),
    "triangular_jitter": Stranger(
        "the skip jitter is triangular", _triangular_jitter, on_bench=True
    ),
    "report_shape": Stranger(
        "the report jitter is rounder", _report_shape, on_bench=True, needs=REPORTS
    ),
}
