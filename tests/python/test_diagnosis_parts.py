"""The laws, the streams and the grid that a diagnosis rests on."""

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again, stamped_machine
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Touches, read_campaign
from skiplatch.diagnosis.candidates.grid_starts import holds, resolutions, slots
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra, Law, extra_variance
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.scene.grid import grid_period
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.own_way import OwnWay, own_way
from skiplatch.diagnosis.search.parts import split
from skiplatch.diagnosis.search.scored import IMPOSSIBLE, worth
from skiplatch.simulator.effects import Effect

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
DATA = Path(__file__).parent / "data"
NO_GAP = [SAMPLES / "machine_no_gap", DATA / "bench_no_gap"]


@pytest.mark.parametrize("folder", NO_GAP)
def test_streams_of_a_campaign_without_a_gap_are_as_wide_as_believed(folder: Path) -> None:
    """Mean and scatter of a few hundred residuals within five standard errors."""
    scene = Scene.of(read_campaign(folder))
    for stream in scene.streams.values():
        law = stream.law.select(stream.rows)
        scores = (stream.residuals[stream.rows] - law.mean) / law.spread
        error = 1.0 / np.sqrt(len(scores))

        assert abs(scores.mean()) < 5.0 * error + 0.1, stream.name
        assert scores.std() < 1.0 + 5.0 * error, stream.name


def off_by(shift_um: Callable[[Scene], FloatArray]) -> Scene:
    """A machine without a gap, but that its positions are off."""
    campaign = read_campaign(SAMPLES / "machine_no_gap")
    touches = campaign.touches
    deviation_um = touches.deviation_um + shift_um(Scene.of(campaign))
    return Scene.of(replace(campaign, touches=replace(touches, deviation_um=deviation_um)))


def of_scale(scene: Scene) -> FloatArray:
    return 0.05 * scene.sign * scene.touches.position_mm


def of_bend(scene: Scene) -> FloatArray:
    return 0.05 * scene.sign * scene.touches.position_mm**2 / 100.0


def of_sense(scene: Scene) -> FloatArray:
    return 2.0 * scene.sign


def way_of_sense(scene: Scene) -> OwnWay:
    return own_way(scene, Change(position_um=of_sense(scene)), Change(position_um=of_scale(scene)))


def test_what_another_form_of_a_shift_does_is_no_shift_of_its_own() -> None:
    """A bent scale is off by the sense as well, in the mean of its positions."""
    bent = way_of_sense(off_by(lambda scene: of_scale(scene) + of_bend(scene)))

    assert bent.as_formed > 20.0
    assert bent.beyond_form < 0.1 * bent.as_formed


def test_a_shift_of_its_own_stays_beyond_any_form_of_another() -> None:
    both = way_of_sense(off_by(lambda scene: of_scale(scene) + of_sense(scene)))

    assert both.as_formed > 20.0
    assert both.beyond_form > 0.3 * both.as_formed


def test_what_no_datum_moves_is_shifted_by_its_whole_mean() -> None:
    """A surface that lies elsewhere makes no report late."""
    scene = Scene.of(played(BENCH, Effect("report_delay", {"delay_us": 100.0})))

    way = own_way(scene, Change(report_us=100.0), Change())

    assert way.as_formed == way.beyond_form > 100.0


def test_what_shifts_nothing_has_no_way_of_its_own() -> None:
    scene = off_by(of_scale)

    assert own_way(scene, Change(), Change(position_um=of_scale(scene))) == OwnWay(0.0, 0.0)


def test_the_likelihood_prefers_the_truth() -> None:
    scene = Scene.of(read_campaign(SAMPLES / "bench_isr_latency"))
    nothing = likelihood(scene, Change()).total

    assert likelihood(scene, Change(skip_us=41.7)).total > nothing + 1000.0
    assert (
        likelihood(scene, Change(skip_us=30.0)).total
        < likelihood(scene, Change(skip_us=41.7)).total
    )


def test_moments_of_a_law_are_those_of_draws() -> None:
    """Mean and variance of 200,000 draws, within five standard errors."""
    rng, n = np.random.default_rng(1), 200_000
    one = np.ones(1)
    extra = Extra(0.4, offset=1.0, width=2.0, mean=0.5, sigma=0.3, boxless=1.0)
    law = Law(0.2 * one, 0.1 * one, 3.0 * one, 0.5 * one, (extra,))
    base = 0.2 + rng.normal(0.0, 0.1, n) + 0.5 * rng.random(n)
    late = 1.0 + 2.0 * rng.random(n) + rng.exponential(0.5, n) + rng.normal(0.0, 0.3, n)
    draws = base + np.where(rng.random(n) < 0.4, late, 3.0 * rng.random(n))
    variance = float((law.spread**2 + extra_variance(law))[0])

    assert draws.mean() == pytest.approx(law.mean[0], abs=5.0 * draws.std() / np.sqrt(n))
    assert draws.var() == pytest.approx(variance, rel=5.0 * np.sqrt(2.0 / n))


def test_extras_of_two_causes_have_the_mean_and_the_variance_of_their_sum() -> None:
    def moments(*extras: Extra) -> tuple[float, float]:
        none = np.zeros(1)
        law = Law(none, none, none, none, extras)
        return float(law.mean[0]), float(extra_variance(law)[0])

    one = Extra(1.0, offset=3.0, width=700.0, mean=200.0, sigma=4.0)
    other = Extra(1.0, offset=5.0, width=1500.0, mean=90.0, sigma=7.0)
    both = Change(pin_extra=(one,)).joined(Change(pin_extra=(other,))).pin_extra

    assert moments(*both) == pytest.approx(np.add(moments(one), moments(other)))


def test_slack_scatters_a_shift_by_a_share_of_it() -> None:
    scene = Scene.of(read_campaign(SAMPLES / "machine_no_gap"))
    stream = scene.streams["deviation_skip"]
    shift = 7.0 * scene.sign
    firm = law_under(scene, stream, Change(position_um=shift))
    loose = law_under(scene, stream, Change(position_um=shift, slack=0.4))

    scatter = np.sqrt(loose.sigma**2 - firm.sigma**2)[stream.rows]
    np.testing.assert_allclose(scatter, 2.8, rtol=1e-6)
    assert law_under(scene, stream, Change(slack=0.4)).sigma == pytest.approx(stream.law.sigma)


@pytest.mark.parametrize("name", ["position", "report"])
def test_what_a_stamp_tells_of_a_slack_is_not_left_open_after_it(name: str) -> None:
    """A clock is off by 100 µs and by 20 µs more or less from touch to touch."""
    plain = Scene.of(read_campaign(DATA / "bench_no_gap"))
    off_us = 100.0 + 20.0 * np.random.default_rng(1).normal(size=len(plain))
    touches = replace(plain.touches, latch_us=plain.touches.latch_us + off_us)
    scene = Scene(plain.nominal, touches)
    stream = scene.streams[name]
    skip = stream.rows & ~scene.plc
    believed = Scene(plain.nominal, plain.touches).streams[name].law.spread[skip]
    scale = scene.speed[skip] if name == "position" else 1.0

    law = law_under(scene, stream, Change(stamp_us=100.0, slack=0.2))

    missed = (stream.residuals - law.mean)[skip]
    assert np.all(law.spread[skip] < believed + 3.0 * scale)
    assert np.sqrt(np.mean((missed / law.spread[skip]) ** 2)) < 1.5


def test_a_touch_whose_predecessor_was_not_recorded_follows_none() -> None:
    touches = played(BENCH).touches.in_order_of_time()
    kept = np.array([0, 1, 2, 4, 5, 8])

    scene = Scene(played(BENCH).nominal, touches.select(kept))

    np.testing.assert_array_equal(scene.follows, np.diff(scene.touches.touch, prepend=-9) == 1)
    assert scene.follows.sum() == np.sum(np.diff(touches.touch[kept]) == 1)
    np.testing.assert_array_equal(scene.select(np.arange(6) > 2).follows, scene.follows[3:])


def test_a_grid_of_no_whole_number_of_believed_steps_is_proposed() -> None:
    plain = Scene.of(read_campaign(SAMPLES / "machine_no_gap"))
    pitch, n = 9.2375 * plain.nominal.axis.resolution_um, len(plain)
    coarse = np.rint(plain.touches.deviation_um / pitch) * pitch
    scene = Scene(plain.nominal, replace(plain.touches, deviation_um=np.round(coarse, 3)))

    def on_lines(count: int) -> Scene:
        lines = np.round(pitch * np.arange(1, count + 1), 3)
        return Scene(plain.nominal, replace(plain.touches, deviation_um=np.resize(lines, n)))

    def odd(of: Scene) -> list[float]:
        proposed = (start[0] for start in resolutions(of, Change()) if start[1] == 0.0)
        steps = [pitch / of.nominal.axis.resolution_um for pitch in proposed]
        return [count for count in steps if abs(count - round(count)) > 1e-6]

    assert odd(scene) == [pytest.approx(9.2375, rel=1e-4)]
    assert odd(on_lines(3)) == [pytest.approx(9.2375, rel=1e-3)]
    assert not odd(plain)


STAMPED = replace(
    read_campaign(MACHINE),
    touches=replace(
        read_campaign(MACHINE).touches, latch_us=np.zeros(len(read_campaign(MACHINE).touches))
    ),
)
"""A machine campaign in which latches will be stamped when it is played."""


@pytest.mark.parametrize("slot_us", [100.0, 1000.0])
def test_the_slots_that_stamps_keep_are_proposed(slot_us: float) -> None:
    slotted = Effect("link_slotting", {"slot_us": slot_us, "phase_deg": 130.0})
    scene = Scene.of(played_again(STAMPED, slotted))

    proposed = np.array(slots(scene, Change()))
    off = np.abs(proposed - [slot_us, 130.0])
    best = proposed[int(np.argmin(off[:, 0]))]

    assert np.any(np.all(off < [1e-4, 8.0], axis=1))
    effect = CANDIDATES["link_slotting"]
    gained = [
        likelihood(scene, effect.change(scene, np.array([slot_us, phase_deg]))).total
        for phase_deg in (best[1], 0.0)
    ]
    assert gained[0] > gained[1] + 300.0


def test_slots_are_proposed_wherever_the_surfaces_are() -> None:
    """Data of axes that are far apart are no scatter, by which the width of slots is guessed."""
    slotted = Effect("link_slotting", {"slot_us": 1000.0, "phase_deg": 130.0})
    surfaces = FittedDatum({"X": 400.0, "Y": -300.0, "Z": 100.0})
    (stamps,) = (
        Rig(STAMPED.nominal, [slotted], surfaces)
        .play(STAMPED.touches, seed=5, replicates=1)
        .latch_us
    )
    touches = replace(STAMPED.touches, latch_us=stamps)

    proposed = slots(Scene.of(replace(STAMPED, touches=touches)), Change())

    assert any(slot_us == pytest.approx(1000.0, rel=1e-6) for slot_us, _ in proposed)


def test_values_that_are_all_the_same_keep_the_period_that_was_guessed() -> None:
    assert grid_period(np.full(20, 7.0), 3.0, first=16) == 3.0


def test_stamps_that_keep_no_slots_propose_none() -> None:
    late = Effect("trigger_delay", {"jitter_us": 300.0})
    scene = Scene.of(played_again(STAMPED, late))

    assert all(phase_deg == 0.0 for _, phase_deg in slots(scene, Change()))


@pytest.mark.parametrize(("period_us", "dead_us"), [(250.0, 100.0), (1000.0, 0.0)])
def test_the_updates_of_a_held_position_are_proposed(period_us: float, dead_us: float) -> None:
    numbers = {"period_us": period_us, "dead_us": dead_us, "phase_deg": 130.0}
    scene = Scene.of(played(BENCH, Effect("servo_hold", numbers)))

    proposed = np.array(holds(scene, Change()))

    proposed[:, 2] += (dead_us - proposed[:, 1]) / period_us * 360.0  # longer dead, updated later
    off = np.abs(proposed - [period_us, dead_us, 130.0])
    assert np.any(np.all(off < [1e-4, 6.0, 2.0], axis=1))
    plain = Scene.of(read_campaign(BENCH))
    assert all(phase_deg == 0.0 for _, _, phase_deg in holds(plain, Change()))


@pytest.mark.parametrize("steps", [2.2, 9.2375])
def test_the_lines_of_a_coarse_coordinate_are_proposed(steps: float) -> None:
    plain = Scene.of(read_campaign(SAMPLES / "machine_no_gap"))
    fine, touches = plain.nominal.axis.resolution_um, plain.touches
    pitch_um = steps * fine
    lines_um = (np.rint(plain.latched_mm * 1e3 / pitch_um - 0.3) + 0.3) * pitch_um
    off_um = plain.sign * (lines_um - touches.position_mm * 1e3)
    coarse = replace(touches, deviation_um=np.rint(off_um / fine) * fine)

    proposed = [start for start in resolutions(Scene(plain.nominal, coarse), Change()) if start[2]]

    assert [pytest.approx(pitch_um, rel=1e-4), 1.0, pytest.approx(0.3, abs=0.05)] in proposed
    assert not [start for start in resolutions(plain, Change()) if start[2]]


def test_the_lines_of_few_places_are_proposed_by_what_these_are_apart() -> None:
    plain = Scene.of(read_campaign(SAMPLES / "machine_no_gap"))
    fine_um, n = plain.nominal.axis.resolution_um, len(plain)
    pitch_um = 76.0 * fine_um
    line_um = np.resize(np.array([-3102.0, -3101.0, 2447.0]), n) * pitch_um + 30.0 * fine_um
    deviation_um = plain.sign * (line_um - plain.touches.position_mm * 1e3)
    scene = Scene(plain.nominal, replace(plain.touches, deviation_um=deviation_um))

    proposed = [start for start in resolutions(scene, Change()) if start[1] == 1.0]

    assert [pytest.approx(pitch_um), 1.0, pytest.approx(30.0 / 76.0)] in proposed


@pytest.mark.parametrize(("turns", "origin"), [(1.0, 1.0), (-2.0, 1.0), (1.3, 0.3), (0.0, 0.0)])
def test_a_line_at_nothing_is_played_there_and_not_anywhere(turns: float, origin: float) -> None:
    coarse = CANDIDATES["encoder_quantisation"]
    found = Fit((coarse,), (np.array([76.0, 1.0, turns]),), frozenset({"position"}))

    (effect,) = as_effects(found)

    assert effect.parameters["origin"] == pytest.approx(origin)


def test_scatter_without_steps_is_none_of_coarse_positions() -> None:
    """Steps are proposed by their lines alone: without them any scatter would do as well."""
    plain = Scene.of(read_campaign(SAMPLES / "machine_no_gap"))
    fine_um, touches = plain.nominal.axis.resolution_um, plain.touches
    off_um = np.random.default_rng(3).uniform(-20.0, 20.0, len(touches)) * fine_um
    scattered = np.rint((touches.deviation_um + off_um) / fine_um) * fine_um
    scene = Scene(plain.nominal, replace(touches, deviation_um=scattered))
    coarse = CANDIDATES["encoder_quantisation"]

    without_lines = [start for start in coarse.starts(scene, Change()) if start[1] and not start[2]]
    unseen = [coarse.change(scene, np.array([n * fine_um, 1.0, 0.0])) for n in (2.5, 40.0)]

    assert without_lines == []
    assert unseen == [Change(), Change()]


@pytest.mark.parametrize("rounded", [np.rint, np.floor])
def test_what_lies_on_a_coarse_grid_does_so_however_the_fine_one_rounds_it(
    rounded: Callable[[FloatArray], FloatArray],
) -> None:
    plain = Scene.of(read_campaign(DATA / "bench_no_gap"))
    fine = plain.nominal.axis.resolution_um
    lines = np.rint(plain.touches.deviation_um / (7.37 * fine)) * 7.37
    touches = replace(plain.touches, deviation_um=rounded(lines + 1e-6) * fine)
    scene = Scene(plain.nominal, touches)

    def total(change: Change) -> float:
        return likelihood(scene, change, names=["position"]).total

    off_grid = Change(coarse_um=7.37 * fine, line_um=np.nan)
    gained = total(Change(coarse_um=7.37 * fine)) - total(off_grid)

    assert gained == pytest.approx(np.log(7.37) * plain.streams["position"].rows.sum(), rel=0.05)


def test_a_position_that_shows_less_than_a_period_is_not_periodic() -> None:
    scene = Scene.of(read_campaign(SAMPLES / "machine_no_gap"))
    span_mm = float(np.ptp(scene.touches.position_mm))

    def largest_um(period_mm: float) -> float:
        parameters = np.array([3.0, period_mm, 20.0, *[0.0] * 10])
        change = CANDIDATES["transmission_error"].change(scene, parameters)
        return float(np.max(np.abs(change.position_um)))

    assert largest_um(0.99 * span_mm) > 2.0
    assert largest_um(1.01 * span_mm) == 0.0


def test_what_hardly_moves_all_the_while_does_not_follow_the_temperature() -> None:
    """It would be as good as constant, which is backlash."""
    scene = Scene.of(read_campaign(DATA / "bench_no_gap"))
    takes_s = float(np.ptp(scene.touches.time_s))

    def largest_um(lag_s: float) -> float:
        parameters = np.array([50.0, 0.0, lag_s, *[0.0] * 6])
        change = CANDIDATES["thermal_drift"].change(scene, parameters)
        return float(np.max(np.abs(change.position_um)))

    assert largest_um(takes_s) > 1.0
    assert largest_um(4.0 * takes_s) == 0.0


def test_lobes_are_seen_at_both_senses_of_two_axes() -> None:
    campaign = read_campaign(MACHINE)
    lobes = CANDIDATES["pretravel_lobing"]

    def shows(step_deg: float, touches: Touches) -> bool:
        alpha_deg = np.round(touches.alpha_deg / step_deg) * step_deg % 360.0
        level = np.zeros(len(touches))
        turned = replace(touches, alpha_deg=alpha_deg, beta_deg=level)
        return lobes.applies(Scene.of(replace(campaign, touches=turned)))

    for touches in (campaign.touches, stamped_machine().touches):
        assert [shows(step_deg, touches) for step_deg in (180.0, 90.0)] == [False, True]


@pytest.mark.parametrize(("period", "jitter"), [(2200.0, 0.0), (2200.0, 30.0), (4123.456, 0.0)])
def test_the_period_of_a_grid_is_found_from_far_apart_stamps(period: float, jitter: float) -> None:
    rng = np.random.default_rng(1)
    number = np.sort(rng.integers(0, int(5e9 / period), 200))
    stamps = 123.0 + number * period + jitter * rng.normal(size=200)

    assert grid_period(np.floor(stamps), 1.06 * period) == pytest.approx(period, rel=1e-8)


@pytest.mark.parametrize(("delay_us", "impossible"), [(-3.0, 0), (-20.0, 1), (20.0, 0)])
def test_an_interrupt_cannot_come_before_its_edge(delay_us: float, impossible: int) -> None:
    scene = Scene.of(read_campaign(DATA / "bench_no_gap"))
    judge = Judge(scene, split(len(scene), seed=1))
    parameters = np.array([delay_us, 0.0, 0.0])

    scored = judge.score(Fit((CANDIDATES["isr_latency"],), (parameters,), frozenset()))

    assert 3.0 < scene.nominal.skip.latency_us < 20.0 - scene.nominal.skip.tick_us
    assert scored.impossible == impossible
    speaks_against = worth(1) + IMPOSSIBLE * impossible
    assert scored.score == pytest.approx(scored.fitted + scored.checked - speaks_against)


LIKELIHOODS = """
from pathlib import Path
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.likelihood.likelihood import likelihood
scene = scene_of(read_campaign(Path("scripts/samples/machine_no_gap")))
print([likelihood(scene, Change(pin_us=1.3 * k, slack=0.01)).total for k in range(40)])
"""


def test_a_likelihood_is_the_same_to_the_last_digit_whatever_strings_hash_to() -> None:
    """Sets of names have another order in another process."""
    printed = {
        subprocess.run(
            [sys.executable, "-c", LIKELIHOODS],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("1", "3", "4")
    }

    assert len(printed) == 1
