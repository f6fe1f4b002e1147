"""Touches that a PLC polls, without stamps, tell errors of the position: the slow ones best."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played_again, stamped_machine, thinned
from skiplatch.campaign import Axis, Campaign, Datum, InputPath, Kind, Touches, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.positions import positions
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.places import are_told_by_places
from skiplatch.diagnosis.search.tasks import fit_in_forms, fit_plainly
from skiplatch.diagnosis.verdict.cell_scores import Ensemble, floor_of
from skiplatch.diagnosis.verdict.shrink import PlayedRigs
from skiplatch.simulator.effects import Effect
from standing_fits import standing

TOUCHES = 260
SPAN_MM = 190.0
WAVE = Effect("transmission_error", {"amplitude_um": 6.0, "period_mm": 24.0, "phase_deg": 40.0})


def polled(*, stamped: bool = False) -> Campaign:
    """Touches of two axes in either sense, at feeds of 120 to 2600 mm/min, that a PLC polls.

    In a scan the axis goes 2 to 43 µm.
    """
    rng = np.random.default_rng(3)
    base = stamped_machine() if stamped else read_campaign(MACHINE)
    whole = np.full(TOUCHES, 0.0 if stamped else np.nan)
    touches = Touches.from_columns(
        touch=np.arange(TOUCHES),
        time_s=np.cumsum(rng.uniform(1.0, 4.0, TOUCHES)),
        path=np.full(TOUCHES, InputPath.PLC),
        axis=rng.choice([Axis.X, Axis.Y], TOUCHES),
        sign=rng.choice([1.0, -1.0], TOUCHES),
        feed_mm_min=rng.choice([120.0, 480.0, 1200.0, 2600.0], TOUCHES),
        approach_mm=rng.uniform(0.5, 1.5, TOUCHES),
        position_mm=rng.uniform(-0.5, 0.5, TOUCHES).round(3) * SPAN_MM,
        latch_us=whole,
        report_us=whole,
        deviation_um=np.zeros(TOUCHES),
    )
    probe = replace(base.nominal.probe, repeatability_um=1.0, lobe_um=0.0)
    axis = replace(base.nominal.axis, resolution_um=0.001)
    nominal = replace(base.nominal, probe=probe, axis=axis, datum=Datum.of_kind(Kind.MACHINE))
    return replace(base, nominal=nominal, touches=touches)


@pytest.mark.long
@pytest.mark.parametrize("datum_um", [0.0, 60.0])
@pytest.mark.parametrize("stamped", [False, True])
def test_a_wave_is_proposed_and_fitted_wherever_the_surface_is(
    datum_um: float, *, stamped: bool
) -> None:
    campaign = played_again(polled(stamped=stamped), WAVE)
    touches = campaign.touches
    moved = replace(touches, deviation_um=touches.deviation_um + datum_um)
    scene, wave = Scene.of(replace(campaign, touches=moved)), CANDIDATES[WAVE.id]

    first, *_ = wave.starts(scene, NOTHING)
    (found,) = fit_plainly((scene, wave, NOTHING)).parameters

    assert first[1] == pytest.approx(24.0, abs=0.5)
    assert found[:2] == pytest.approx((6.0, 24.0), rel=0.07)


@pytest.mark.parametrize(
    "effect",
    [
        Effect("scale_error", {"scale_ppm": -60.0, "y_excess_ratio": -2.0}),
        Effect("backlash", {"backlash_um": 4.0, "y_excess_ratio": -2.0}),
    ],
)
def test_axes_that_err_to_opposite_sides_are_proposed(effect: Effect) -> None:
    scene, candidate = Scene.of(played_again(polled(), effect)), CANDIDATES[effect.id]
    truth = dict(zip(candidate.names, candidate.starts(scene, NOTHING)[1], strict=True))

    for name, value in effect.parameters.items():
        assert truth[name] == pytest.approx(value, rel=0.3)


def test_coordinates_of_a_coarse_encoder_propose_its_lines() -> None:
    encoder = Effect(
        "encoder_quantisation", {"resolution_um": 10.0, "is_coordinate": 1.0, "origin": 0.3}
    )
    scene, candidate = Scene.of(played_again(polled(), encoder)), CANDIDATES[encoder.id]

    (found,) = fit_plainly((scene, candidate, NOTHING)).parameters

    assert found == pytest.approx((10.0, 1.0, 0.3), abs=0.01)


def test_each_touch_is_taken_once_beside_the_datum_of_what_was_recorded() -> None:
    campaign = played_again(polled(stamped=True))
    touches = campaign.touches
    half = np.arange(TOUCHES) < TOUCHES // 2
    partly = replace(touches, latch_us=np.where(half, touches.latch_us, np.nan))

    told = positions(Scene.of(replace(campaign, touches=partly)), NOTHING)

    np.testing.assert_array_equal(told.rows, np.arange(TOUCHES))
    np.testing.assert_array_equal(told.data.sum(axis=1), 1.0)
    assert np.median(told.spread_um[half]) < 0.1 * np.median(told.spread_um[~half])
    assert not np.any(told.data[half].any(axis=0) & told.data[~half].any(axis=0))


def test_a_wave_shrinks_in_touches_that_share_the_phases_of_all_plays() -> None:
    campaign = played_again(polled(), WAVE)
    scene = Scene.of(campaign)
    rigs = (Rig(scene.nominal, effects) for effects in ((), (WAVE,)))

    every = np.full(TOUCHES, fill_value=True)
    gap = PlayedRigs.of(scene, *rigs, seed=1, jobs=2).gaps(every)["deviation_um"]

    assert gap.is_clear
    assert gap.shrink.low > 0.8


def test_what_plays_do_not_tell_of_touches_is_that_of_their_pool() -> None:
    """Means of a hundred plays differ by the phases that these have, and by nothing else."""
    rng = np.random.default_rng(4)
    recorded, plays = rng.random(400), rng.random((100, 400))
    place = 5.0 * np.arange(400.0)

    apart, alike = (
        Ensemble.of(plays + there, np.ones(400), is_pooled=True, has_places=True).scored(
            recorded + there
        )
        for there in (place, 0.0)
    )

    floor = float(floor_of(rng.random((1, 4000)))[0])
    assert alike.scores.mean() == pytest.approx(floor, rel=0.05)
    assert apart.scores.mean() == pytest.approx(floor, rel=0.05)
    assert apart.floor.mean() == pytest.approx(alike.floor.mean(), rel=0.02)


@pytest.mark.long
@pytest.mark.parametrize(
    ("places", "surface_um", "is_told"),
    [(12, 0.0, False), (60, 0.0, True), (60, 500.0, True), (12, 500.0, False)],
)
def test_a_wave_through_a_few_places_that_are_off_anyhow_is_not_told(
    places: int, surface_um: float, *, is_told: bool
) -> None:
    """One of so many periods and orders runs through them; through five times as many, a true one.

    The errors of few places are drawn by lot, those of many are of a wave. By what surfaces lie
    farther the senses are apart at each place.
    """
    rng = np.random.default_rng(2)
    campaign = polled()
    place = rng.integers(0, places, TOUCHES)
    where_mm = rng.uniform(-0.5, 0.5, places).round(3) * SPAN_MM
    along_x = np.full(TOUCHES, Axis.X, dtype=np.int8)
    touches = replace(campaign.touches, axis=along_x, position_mm=where_mm[place])
    campaign = replace(campaign, touches=touches)
    played = played_again(campaign, *([WAVE] if is_told else []))
    by_lot = np.zeros(places) if is_told else rng.normal(0.0, 20.0, places)
    sign = Scene.of(campaign).sign
    off = played.touches.deviation_um + surface_um + sign * by_lot[place]
    scene = Scene.of(replace(played, touches=replace(played.touches, deviation_um=off)))
    wave = CANDIDATES[WAVE.id]

    found = fit_in_forms((scene, fit_plainly((scene, wave, NOTHING)), NOTHING))

    base, reached = (likelihood(scene, c).total for c in (NOTHING, found.change(scene)))
    assert reached > base + 30.0
    assert are_told_by_places(scene, found) == [is_told]


def test_a_wave_without_a_length_is_told_by_no_place() -> None:
    scene = Scene.of(played_again(polled(), WAVE))
    flat = Effect("transmission_error", {**WAVE.parameters, "period_mm": 0.0})

    assert are_told_by_places(scene, standing(scene, flat)) == [False]


@pytest.mark.parametrize(
    ("places", "y_excess_ratio", "is_told"),
    [(2, 0.0, True), (2, -3.0, False), (3, -3.0, True), (1, 0.0, False)],
)
def test_a_line_through_two_points_of_each_axis_says_nothing(
    places: int, y_excess_ratio: float, *, is_told: bool
) -> None:
    """Each axis has a datum of its own: one place of it is that."""
    campaign = polled()
    touches = campaign.touches
    where_mm = np.asarray(40.0 * (np.arange(TOUCHES) % places), dtype=np.float64)
    few = replace(touches, position_mm=where_mm)
    warm, warmer = (replace(few, temp_c=np.linspace(25.0, to_c, TOUCHES)) for to_c in (25.1, 31.0))
    scale = Effect("scale_error", {"scale_ppm": 50.0, "y_excess_ratio": y_excess_ratio})
    growing = {"expansion_ppm_k": 10.0, "y_excess_ratio": y_excess_ratio}
    grown = Effect("thermal_drift", growing)

    for own, effect in ((few, scale), (warm, grown), (warmer, grown)):
        scene = Scene.of(replace(campaign, touches=own))
        told = are_told_by_places(scene, standing(scene, effect))
        assert told == [is_told or (own is warmer and places > 1)]


def test_a_drift_where_no_place_was_recorded_goes_with_none() -> None:
    campaign = polled()
    nowhere = replace(campaign.touches, position_mm=np.full(TOUCHES, np.nan))
    scene = Scene.of(replace(campaign, touches=nowhere))
    drift = standing(scene, Effect("thermal_drift", {"drift_um_k": 3.0}))

    assert are_told_by_places(scene, drift) == [True]


@pytest.mark.parametrize(
    "stamped",
    [pytest.param(False, marks=pytest.mark.long), pytest.param(True, marks=pytest.mark.nightly)],
)
def test_a_wave_is_named(*, stamped: bool) -> None:
    found = diagnose(thinned(played_again(polled(stamped=stamped), WAVE)), seed=1)

    assert [effect.effect.id for effect in found.effects] == [WAVE.id]
    assert found.effects[0].effect.parameters["amplitude_um"] == pytest.approx(6.0, rel=0.1)
