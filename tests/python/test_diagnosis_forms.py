"""Effects in forms other than the plainest, and what is no effect of the catalogue at all."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosed import found, groups
from played_campaigns import BENCH, played, played_again, stamped_machine, thinned
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis import Verdict, diagnose
from skiplatch.diagnosis.candidates.table import candidate
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.fit import fit
from skiplatch.diagnosis.fit.forms import polish
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
MACHINE = read_campaign(SAMPLES / "machine_no_gap")


def simulated(*switched_on: Effect) -> Campaign:
    """Play the touches of a recorded campaign with other effects and other random numbers."""
    nominal, touches = MACHINE.nominal, MACHINE.touches
    controller = Controller.for_campaign(nominal, touches)
    outcome = play(nominal, controller, touches, seed=5, switched_on=switched_on)
    outcomes = {
        name: getattr(outcome, name)[0] for name in ("latch_us", "report_us", "deviation_um")
    }
    return replace(MACHINE, touches=replace(touches, **outcomes))


SOME = {
    "feed_error": {"limit_mm_min": 1900.0},
    "rotary_pivot": {"x_um": 5.0, "y_um": -3.0, "set_on_believed_centre": 1.0, "mirrored": 1.0},
    "servo_hold": {"period_us": 400.0, "phase_deg": 100.0},
}
OTHERS = {
    "backlash": {"backlash_um": 2.5, "positive_um": 2.5, "y_excess_ratio": 0.5},
    "encoder_quantisation": {"resolution_um": 7.3, "is_coordinate": 1.0},
    "thermal_drift": {"drift_um_k": 2.5, "along_approach": 1.0},
    "isr_latency": {"latency_us": 20.0, "tail_us": 15.0},
    "timer_drift": {"drift_ppm": -20.0, "warmth_ppm_k": -2.0},
    "transmission_error": {
        "amplitude_um": 4.0,
        "period_mm": 10.0,
        "y_excess_ratio": 0.5,
        "y_ahead_deg": 120.0,
    },
}
"""Effects that other tests name in a plainer form."""


@pytest.mark.long
@pytest.mark.parametrize(("effect_id", "parameters"), SOME.items())
def test_another_form_is_found_as_the_same_effect(
    effect_id: str, parameters: Mapping[str, float]
) -> None:
    finding = found(thinned(simulated(Effect(effect_id, parameters))))

    assert finding.model is not None
    assert finding.model.ids == (effect_id,)


@pytest.mark.nightly
@pytest.mark.parametrize(("effect_id", "parameters"), {**SOME, **OTHERS}.items())
def test_another_form_has_the_same_name(effect_id: str, parameters: Mapping[str, float]) -> None:
    diagnosis = diagnose(simulated(Effect(effect_id, parameters)), seed=1)

    assert [named.effect.id for named in diagnosis.effects] == [effect_id]


@pytest.mark.parametrize(
    ("effect_id", "parameters"),
    [
        ("scale_error", {"scale_ppm": -15.0}),
        ("following_error", {"lag_us": 30.0}),
        ("backlash", {"backlash_um": 4.0}),
        ("thermal_drift", {"drift_um_k": 3.0}),
    ],
)
def test_axes_that_err_to_opposite_sides_are_found(
    effect_id: str, parameters: Mapping[str, float]
) -> None:
    """What all axes have in common is nothing then, and no search begins from there."""
    scene = Scene.of(played(BENCH, Effect(effect_id, {**parameters, "y_excess_ratio": -2.0})))
    effect = candidate(effect_id)

    found = fit(scene, [effect], effect.starts(scene, Change()))

    fitted = dict(zip(effect.names, found.parameters[0], strict=True))
    size = effect.names[0]
    assert fitted[size] == pytest.approx(parameters[size], rel=0.05)
    assert fitted["y_excess_ratio"] == pytest.approx(-2.0, abs=0.1)


def test_axes_that_hardly_differ_are_told_apart_without_slack() -> None:
    backlash = candidate("backlash")
    more = Effect("backlash", {"backlash_um": 40.0, "y_excess_ratio": -0.01})
    scene = Scene.of(played(BENCH, more))

    found = polish(scene, fit(scene, [backlash], backlash.starts(scene, Change())))

    assert found.slack == 0.0
    assert found.parameters[0][:3] == pytest.approx([40.0, 0.0, -0.01], abs=1e-3)


@pytest.mark.nightly
def test_a_delay_with_a_tail_is_seen_beside_a_clock_that_follows_the_temperature() -> None:
    clock = Effect("timer_drift", {"drift_ppm": -20.0, "warmth_ppm_k": -2.0})
    delay = Effect("trigger_delay", {"delay_us": 10.0, "tail_us": 60.0})

    drift, late = groups(found(simulated(clock, delay)))

    assert drift == {"timer_drift"}
    assert "trigger_delay" in late


def test_beside_slack_a_delay_shows_in_what_comes_after_the_latch_too() -> None:
    scene = Scene.of(simulated())
    drift = Change(stamp_us=20e-6 * scene.touches.latch_us)
    delay = candidate("trigger_delay")
    found, beside = (
        fit(scene, [delay], [[50.0, 0.0, 0.0]], given)
        for given in (drift, replace(drift, slack=0.01))
    )

    assert found.reached == {"latch_skip", "latch_plc"}
    assert beside.reached == {"latch_skip", "latch_plc", "position", "report"}


@pytest.mark.parametrize("share", [0.02, 0.004])
def test_slack_is_known_as_closely_as_parameters(share: float) -> None:
    """Short of it, steps of the position would be found beside a scale that varies."""
    plain = played_again(stamped_machine(), Effect("scale_error", {"scale_ppm": 400.0}))
    shift_um = 0.4 * plain.touches.position_mm
    size_um = float(np.sqrt(np.mean(shift_um**2)))
    more_um = np.random.default_rng(2).normal(0.0, share * size_um, len(shift_um))
    deviation_um = (plain.touches.deviation_um + more_um).round(3)
    scene = Scene.of(replace(plain, touches=replace(plain.touches, deviation_um=deviation_um)))

    found = polish(scene, fit(scene, [candidate("scale_error")], [[400.0, 0.0, 0.0, 0.0]]))

    assert found.slack == pytest.approx(share, rel=0.15)


def test_a_lag_that_varies_scatters_by_itself_and_needs_no_slack() -> None:
    truth = Effect("following_error", {"lag_us": 2000.0, "scatter_us": 40.0})
    scene = Scene.of(played_again(stamped_machine(), truth))

    found = polish(scene, fit(scene, [candidate("following_error")], [[2000.0, 0.0, 0.0, 0.0]]))

    assert found.slack == 0.0
    assert found.parameters[0][3] == pytest.approx(40.0, rel=0.15)


@pytest.mark.long
def test_slack_is_a_share_of_a_shift_and_no_scatter_of_its_own() -> None:
    plain = simulated()
    scatter_us = np.random.default_rng(4).standard_cauchy(len(plain.touches)).round(1)
    stamps_us = plain.touches.latch_us + 20.0 * scatter_us
    scene = Scene.of(replace(plain, touches=replace(plain.touches, latch_us=stamps_us)))

    found = polish(scene, fit(scene, [candidate("timer_drift")], [[1.0, 0.0, 0.0]]))

    assert found.slack == 0.0


@pytest.mark.nightly
def test_an_error_with_the_approach_gets_no_name() -> None:
    plain = simulated()
    off = plain.touches.deviation_um + 1.5 * plain.touches.approach_mm
    touches = replace(plain.touches, deviation_um=np.round(off, 1))
    diagnosis = diagnose(replace(plain, touches=touches), seed=1)

    assert diagnosis.verdict == Verdict.UNKNOWN
    assert not diagnosis.effects


@pytest.mark.long
def test_an_effect_of_a_form_far_off_explains_in_part() -> None:
    plain = simulated()
    touches = plain.touches
    share = 1.0 + 0.4 * np.random.default_rng(3).standard_normal(len(touches))
    off = touches.deviation_um + 0.05 * touches.position_mm * touches.sign * share
    odd = replace(plain, touches=replace(touches, deviation_um=np.round(off, 1)))
    diagnosis = diagnose(odd, seed=1)

    assert diagnosis.verdict == Verdict.PARTLY_EXPLAINED
    assert [named.effect.id for named in diagnosis.effects] == ["scale_error"]
