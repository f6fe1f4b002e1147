"""Two effects that go with each other, or of which one hides what the other one is."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again, stamped_machine
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.fit.fit import Fit, Target
from skiplatch.diagnosis.fit.least_squares import by_least_squares
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.replay import begun_anywhere
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.own_way import by_giving_way, own_way
from skiplatch.diagnosis.search.parts import split
from skiplatch.diagnosis.search.reform import reformed
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.simulator.effects import Effect

SCALE = Effect("scale_error", {"scale_ppm": 40.0})
BACKLASH = Effect("backlash", {"backlash_um": -4.0})
HELD = Effect("servo_hold", {"period_us": 1800.0})


def candidate(effect_id: str) -> Candidate:
    return catalogue()[effect_id]


def one_sided() -> Campaign:
    """A machine whose touches all lie on one side of the zero, as those of a calibration do."""
    machine = stamped_machine()
    touches = machine.touches
    return replace(
        machine, touches=replace(touches, position_mm=np.abs(touches.position_mm) + 100.0)
    )


def whole(effect_id: str, *first: float) -> FloatArray:
    values = np.zeros(len(candidate(effect_id).names))
    values[: len(first)] = first
    return values


def changed(scene: Scene, effect_id: str, *first: float) -> Change:
    return candidate(effect_id).change(scene, whole(effect_id, *first))


def test_of_effects_that_go_with_each_other_one_may_give_way() -> None:
    """A scale that has taken the backlash along leaves little of it, until it gives way."""
    scene = Scene.of(played_again(one_sided(), SCALE, BACKLASH))
    taken, rest = changed(scene, "scale_error", 25.0), changed(scene, "backlash", -1.0)
    right, own = changed(scene, "scale_error", 40.0), changed(scene, "backlash", -4.0)

    assert by_giving_way(scene, rest, taken) > 50.0
    assert by_giving_way(scene, own, right) < 5.0


def test_parameters_on_a_ridge_are_found_by_least_squares() -> None:
    """A tick, which keeps its lines or loses them, stays as it is known."""
    coarse = Effect("timer_quantisation", {"tick_us": 41.3, "origin_us": 30.0})
    scene = Scene.of(played_again(one_sided(), SCALE, BACKLASH, coarse))
    ids = ("scale_error", "backlash", "timer_quantisation")
    values = (whole(ids[0], 25.0), whole(ids[1], -1.0), whole(ids[2], 41.3, 30.0))
    start, candidates = np.concatenate(values), [candidate(name) for name in ids]
    target = Target(scene, candidates, [start], NOTHING)

    found = target.fit(by_least_squares(target, start))

    scale, backlash, tick = found.parameters
    assert scale[0] == pytest.approx(40.0, abs=1.0)
    assert backlash[0] == pytest.approx(-4.0, abs=0.3)
    assert tick.tolist() == values[2].tolist()


def test_what_is_larger_than_a_shift_is_no_form_of_it() -> None:
    """Beside a hold a backlash is 4 µm at all feeds: of a slow one no form is so far off.

    At three feeds some smooth function does all of what it does.
    """
    scene = Scene.of(played_again(stamped_machine(), HELD, BACKLASH))
    slow = scene.select(scene.touches.feed_mm_min < 2000.0)

    way = own_way(slow, changed(slow, "backlash", -4.0), changed(slow, "servo_hold", 1800.0))

    assert len(np.unique(slow.touches.feed_mm_min)) == 3
    assert way.beyond_form > 30.0


def test_a_form_of_an_effect_that_is_there_comes_before_another_effect() -> None:
    """A lag that scatters, beside a scale that hid it: no servo that holds."""
    lag = Effect("following_error", {"lag_us": 2000.0, "scatter_us": 40.0})
    scene = Scene.of(played_again(stamped_machine(), lag, SCALE))
    judge = Judge(scene, split(len(scene), 1))
    candidates = (candidate("following_error"), candidate("scale_error"))
    fit = Fit(
        candidates,
        (whole("following_error", 2000.0), whole("scale_error", 40.0)),
        frozenset({"position"}),
        0.02,
    )

    found = reformed(judge, judge.score(fit))

    assert found.fit.slack == 0.0
    assert abs(found.fit.parameters[0][3]) == pytest.approx(40.0, rel=0.2)
    assert found.score > judge.score(fit).score + 10.0


def test_an_effect_that_has_touches_scatter_less_is_no_form_of_the_others() -> None:
    lock = Effect("scan_phase_lock", {"phase": 0.4, "spread": 0.05})
    drift = Effect("timer_drift", {"drift_ppm": 60.0})
    scene = Scene.of(played(BENCH, drift, lock))
    judge = Judge(scene, split(len(scene), 1))

    def scored(**parameters: list[float]) -> Scored:
        candidates = tuple(candidate(name) for name in parameters)
        values = tuple(whole(name, *first) for name, first in parameters.items())
        return judge.score(Fit(candidates, values, frozenset(scene.streams)))

    alone = scored(timer_drift=[60.0])
    assert judge.is_narrower(scored(timer_drift=[60.0], scan_phase_lock=[0.4, 0.05]), alone)
    assert not judge.is_narrower(scored(timer_drift=[60.0], isr_latency=[0.0, 5.0]), alone)


def test_moves_that_began_with_the_scans_begin_anywhere_without_them() -> None:
    scene = Scene.of(read_campaign(BENCH))

    moved = begun_anywhere(scene, seed=1)

    later_s = moved.touches.time_s - scene.touches.time_s
    scan_s = scene.nominal.plc.scan_us * 1e-6
    assert np.all(later_s[~scene.plc] == 0.0)
    assert np.all((later_s[scene.plc] >= 0.0) & (later_s[scene.plc] <= scan_s))
    assert np.std(later_s[scene.plc]) > 0.2 * scan_s


def test_steps_of_coordinates_are_told_beneath_what_hides_their_scatter() -> None:
    """The recorded deviations lie on a finer grid, that of the nominal positions."""
    steps = Effect("encoder_quantisation", {"resolution_um": 5.0, "is_coordinate": 1.0})
    campaign = played_again(stamped_machine(), Effect("scale_error", {"scale_ppm": 80.0}), steps)
    scene = Scene.of(campaign)
    hidden = replace(changed(scene, "scale_error", 85.0), slack=0.2)

    starts = candidate("encoder_quantisation").starts(scene, hidden)

    assert any(start[0] == pytest.approx(5.0, rel=1e-6) and start[1] == 1.0 for start in starts)


def test_slots_are_told_behind_a_clock_that_drifts() -> None:
    """They end on the real clock, not on that of the stamps."""
    slots = Effect("link_slotting", {"slot_us": 2174.0, "phase_deg": 90.0})
    drift = Effect("timer_drift", {"drift_ppm": -42.0})
    scene = Scene.of(played_again(stamped_machine(), slots, drift))

    found = candidate("link_slotting").starts(scene, changed(scene, "timer_drift", -42.0))

    assert any(start[1] and start[0] == pytest.approx(2174.0, rel=1e-6) for start in found)


@pytest.mark.parametrize(
    ("effect_id", "first"), [("scan_period", ()), ("link_slotting", (41.3 / 2.0, 90.0))]
)
def test_that_stamps_lie_on_ticks_is_told_once(effect_id: str, first: tuple[float, ...]) -> None:
    """Neither scans a tick apart nor slots of half a tick are told by stamps on coarse ticks."""
    coarse = Effect("timer_quantisation", {"tick_us": 641.3, "origin_us": 30.0})
    scene = Scene.of(played_again(stamped_machine(), coarse))
    ticks = changed(scene, "timer_quantisation", 641.3, 30.0)
    parameters = first or (641.3 - scene.nominal.plc.scan_us,)
    both = ticks.joined(changed(scene, effect_id, *parameters))

    gained = likelihood(scene, both).total - likelihood(scene, ticks).total

    assert gained < 10.0


@pytest.mark.long
def test_a_grid_too_fine_to_matter_takes_no_place_from_what_does() -> None:
    """A controller that reckons in steps of 33 nm beside a scatter of a micrometre."""
    campaign = played(MACHINE, Effect("backlash", {"backlash_um": 6.0}))
    nominal = replace(campaign.nominal, axis=replace(campaign.nominal.axis, resolution_um=0.001))
    touches = campaign.touches
    noise_um = np.random.default_rng(3).normal(0.0, 0.3, len(touches))
    on_lines_um = np.rint((touches.deviation_um + noise_um) * 30.0) / 30.0

    found = diagnose(
        replace(campaign, nominal=nominal, touches=replace(touches, deviation_um=on_lines_um)),
        seed=1,
    )

    assert [named.effect.id for named in found.effects] == ["backlash"]
    assert "encoder_quantisation" not in found.effects[0].alternatives
