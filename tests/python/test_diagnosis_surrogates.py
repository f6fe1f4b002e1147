"""The laws that propose, against the simulator: nothing near the truth is much likelier than it."""

from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from played_campaigns import BENCH, MACHINE, played, played_again, stamped_machine
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.candidates.candidate import NO_SIZES
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.diagnosis.candidates.surrogates import HALF_WAY
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import Fit, fit, starts_of
from skiplatch.diagnosis.fit.intervals import estimates
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect, effects
from standing_fits import standing

RARE = 1e-3
"""False-alarm rate of each case, of which all are fixed by their seeds."""
ROUGH = 0.01
"""Of what an effect gains, that its law may lose for its boxes have not quite the right form."""


SEEN = 30.0
"""Nats that an effect gains at least, to be looked at here."""


def whole(effect_id: str, **known: float) -> Effect:
    described = effects()[effect_id].parameters
    return Effect(effect_id, {p.name: known.get(p.name, 0.0) for p in described})


@pytest.mark.parametrize(
    ("folder", "truth"),
    [
        (BENCH, whole("unfinished_acceleration", accel_ratio=0.6, by_feed=-0.4)),
        (BENCH, whole("scan_overrun", probability=0.03, overrun_us=9000.0)),
        (BENCH, whole("scan_overrun", probability=0.45, overrun_us=300.0, span_us=100.0)),
        (BENCH, whole("scan_overrun", probability=0.1, overrun_us=50.0, span_us=9000.0)),
        (BENCH, whole("scan_overrun", probability=0.05, overrun_us=9000.0, left_out=1.0)),
        (
            BENCH,
            whole(
                "scan_overrun",
                probability=0.03,
                overrun_us=1000.0,
                span_us=9000.0,
                left_out=1.0,
            ),
        ),
        (BENCH, whole("scan_jitter", jitter_us=400.0, tail_us=150.0)),
        (BENCH, whole("scan_phase_lock", phase=0.99, spread=0.1)),
        (
            BENCH,
            whole("scan_phase_lock", phase=0.9, spread=0.05, second_after=0.4, second_share=0.3),
        ),
        (BENCH, whole("timer_quantisation", tick_us=11.3, origin_us=-1.0, nearest=0.6)),
        (BENCH, whole("encoder_quantisation", resolution_um=1.37)),
        (BENCH, whole("encoder_quantisation", resolution_um=1.37, is_coordinate=1.0, origin=1.0)),
        (BENCH, whole("encoder_quantisation", resolution_um=0.9, is_coordinate=1.0, origin=0.3)),
        (BENCH, whole("timer_drift", drift_ppm=-0.2, ageing_ppm_h=0.3, warmth_ppm_k=0.5)),
        (MACHINE, whole("transmission_error", amplitude_um=2.0, period_mm=0.9)),
        (MACHINE, whole("transmission_error", amplitude_um=2.0, period_mm=0.9, at_surface=1.0)),
        (BENCH, whole("thermal_drift", drift_um_k=2.0, lag_s=400.0)),
        (BENCH, whole("thermal_drift", drift_um_k=2.0, lag_s=400.0, along_approach=1.0)),
        (BENCH, whole("thermal_drift", expansion_ppm_k=12.0, lag_s=400.0)),
        (BENCH, whole("servo_hold", period_us=400.0, dead_us=50.0)),
        (BENCH, whole("servo_hold", period_us=400.0, dead_us=50.0, phase_deg=200.0)),
        (BENCH, whole("following_error", lag_us=40.0)),
    ],
    ids=lambda given: given.name if isinstance(given, Path) else given.id,
)
@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.nightly)])
def test_nothing_near_the_truth_is_likelier(folder: Path, truth: Effect, seed: int) -> None:
    scene = Scene.of(played(folder, truth, seed=seed))
    there = standing(scene, truth)
    (found,) = estimates(scene, there, [truth])

    def total(fit: Fit) -> float:
        return likelihood(scene, fit.change(scene), there.reached).total

    free = np.count_nonzero(there.parameters[0])
    chance = stats.chi2.ppf(1.0 - RARE, free) / 2.0
    gained = total(there) - likelihood(scene, Change(), there.reached).total
    assert gained > SEEN
    assert total(standing(scene, found.effect)) - total(there) < chance + ROUGH * gained


@pytest.mark.long
@pytest.mark.parametrize(
    "truth",
    [
        whole("thermal_drift", drift_um_k=2.0, lag_s=400.0, along_approach=1.0, moves_surface=1.0),
        whole("rotary_pivot", x_um=6.0, y_um=-9.0, moves_surface=1.0),
        whole("backlash", backlash_um=6.0, moves_surface=1.0),
        whole("scale_error", scale_ppm=60.0, moves_surface=1.0),
        whole("transmission_error", amplitude_um=5.0, period_mm=40.0, moves_surface=1.0),
    ],
    ids=lambda truth: truth.id,
)
def test_a_surface_that_moves_is_found_where_it_shows_when_it_is_met(truth: Effect) -> None:
    machine = stamped_machine()
    turned = np.resize([0.0, 90.0, 180.0, 270.0], len(machine.touches))
    touches = replace(machine.touches, rotary_deg=turned)
    scene = Scene.of(played_again(replace(machine, touches=touches), truth))
    candidate = catalogue()[truth.id]

    found = fit(scene, [candidate], starts_of(scene, candidate, NOTHING))

    sizes = dict(zip(candidate.names, found.parameters[0].tolist(), strict=True))
    assert sizes["moves_surface"] > HALF_WAY
    for name in ("drift_um_k", "x_um", "y_um", "backlash_um", "scale_ppm", "amplitude_um"):
        if value := truth.parameters.get(name):
            assert sizes[name] == pytest.approx(value, rel=0.1)
    left = likelihood(scene, standing(scene, truth).change(scene)).total
    assert likelihood(scene, found.change(scene)).total > left - 2.0


@pytest.mark.long
def test_a_drift_is_found_with_the_thermometer_that_it_follows() -> None:
    machine = stamped_machine()
    count = len(machine.touches)
    spindle_c = 20.0 + 6.0 * np.sin(np.linspace(0.0, 9.0, count))
    places = {"bed": machine.touches.temp_c, "spindle": spindle_c}
    touches = replace(machine.touches, thermometers=places)
    truth = whole("thermal_drift", drift_um_k=1.5, thermometer=2.0)
    scene = Scene.of(played_again(replace(machine, touches=touches), truth))
    candidate = catalogue()["thermal_drift"]

    begun = starts_of(scene, candidate, NOTHING)
    found = fit(scene, [candidate], begun)

    sizes = dict(zip(candidate.names, found.parameters[0].tolist(), strict=True))
    assert round(sizes["thermometer"]) == 2
    assert sizes["drift_um_k"] == pytest.approx(1.5, rel=0.05)
    # The bed's is that of temp_c, and told by it.
    assert {start[-1] for start in begun} == {0.0, 2.0}
    (told,) = estimates(scene, found, as_effects(found))
    assert told.intervals["thermometer"] == (2.0, 2.0)


@pytest.mark.parametrize("percent", [-30.0, 40.0])
def test_a_probe_scatters_in_time_by_the_real_speed(percent: float) -> None:
    """Not by the believed one: as far as the noise is uncertain, that would be taken for less."""
    truth = whole("feed_error", feed_percent=percent)
    machine = stamped_machine()
    probe = replace(machine.nominal.probe, repeatability_um=0.5)
    scattering = replace(machine, nominal=replace(machine.nominal, probe=probe))
    scene = Scene.of(played_again(scattering, truth))
    touches, stream = scene.touches, scene.streams["latch_skip"]

    law = law_under(scene, stream, standing(scene, truth).change(scene))

    plays = Rig(scene.nominal, [truth]).play(touches, seed=5, replicates=200)
    slowest = stream.rows & (touches.feed_mm_min == touches.feed_mm_min.min())
    scatter_us = np.std(plays.latch_us[:, slowest], axis=0)
    assert np.median(law.spread[slowest]) == pytest.approx(np.median(scatter_us), rel=0.03)


@pytest.mark.parametrize("effect_id", sorted(CANDIDATES))
def test_a_size_beyond_its_range_does_what_the_end_of_the_range_does(effect_id: str) -> None:
    scene, candidate = Scene.of(read_campaign(BENCH)), CANDIDATES[effect_id]
    ends = np.array([p.high for p in effects()[effect_id].parameters])
    is_size = np.array([p.unit not in NO_SIZES for p in effects()[effect_id].parameters])

    last, beyond = (
        candidate.acting(scene, np.where(is_size, over * ends, 0.5 * ends)) for over in (1.0, 3.0)
    )

    np.testing.assert_equal(asdict(beyond), asdict(last))
