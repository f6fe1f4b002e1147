"""What stands in for conditions that were not recorded, and what is emptied for want of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import played_again
from refusals import refusal
from skiplatch.campaign import Axis, BelievedEffect, Campaign, Nominal, Touches, read_campaign
from skiplatch.campaign.plausibility import oddities
from skiplatch.comparison import as_json, as_text, compare
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.belief_fit import fit_beliefs
from skiplatch.diagnosis.fit.beliefs import believing, uncertain
from skiplatch.diagnosis.scene.covariates import recorded_only, sequence
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.motion import expected_contact
from skiplatch.report.conditions import conditions
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import SimulationError, connection
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller, filled_rig
from skiplatch.stand_ins import (
    PLAYED,
    PLAYED_TOUCHES,
    playable,
    refuse_unplayable,
    refuse_unplayable_touches,
)


def without(campaign: Campaign, *names: str) -> Campaign:
    nothing = np.full(len(campaign.touches), np.nan)
    touches = replace(campaign.touches, **dict.fromkeys(names, nothing))
    return replace(campaign, touches=touches)


def said_of(campaign: Campaign) -> tuple[Campaign, list[str]]:
    with pytest.warns(CampaignWarning) as caught:
        made = playable(campaign)
    return made, [str(w.message).split("touches.csv: ")[1] for w in caught]


def test_what_was_all_recorded_stays_as_it_is(bench_sample: Path) -> None:
    campaign = read_campaign(bench_sample)

    assert playable(campaign).touches is campaign.touches


def test_time_that_stands_in_for_another_is_not_odd(machine_sample: Path) -> None:
    recorded = read_campaign(machine_sample)
    recorded.touches.time_s[:] -= recorded.touches.time_s[2]
    recorded.touches.time_s[:2] = np.nan  # and before the first known time there is none

    campaign, _ = said_of(recorded)

    assert len(np.unique(campaign.touches.time_s)) < len(campaign.touches)
    assert not any("more than once" in oddity.line for oddity in oddities(campaign))


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
def test_what_stands_in_is_neither_drawn_nor_told_as_recorded(bench_sample: Path) -> None:
    bare = without(read_campaign(bench_sample), "time_s", "feed_mm_min")
    bare.touches.edge_us[0] = np.nan  # or the edges would tell the times
    campaign = playable(bare)

    titles = [one.title for one in conditions(campaign.touches, campaign.stood_in)]
    compared = compare(campaign, seed=1)
    cells = as_json(compared)["cells"]

    assert campaign.stood_in == {"time_s", "feed_mm_min"}
    assert not {"feed", "time", "rest since the touch before"} & set(titles)
    assert "position" in titles
    assert {cell["feed_mm_min"] for cell in cells} == {None}
    assert {gap.feed_words for gap in compared.gaps} == {"feed not recorded"}
    assert "60" not in {
        line.split()[1] for line in as_text(compared).splitlines() if "skip " in line
    }


def test_bench_without_motion_keeps_edges_and_latches(bench_sample: Path) -> None:
    campaign = read_campaign(bench_sample)

    made, said = said_of(without(campaign, "time_s", "feed_mm_min", "approach_mm"))

    assert [line.split(":")[0] for line in said] == ["feed_mm_min", "approach_mm"]
    np.testing.assert_array_equal(made.touches.latch_us, campaign.touches.latch_us)
    assert np.isnan(made.touches.deviation_um).all()
    np.testing.assert_allclose(
        expected_contact(made.nominal, made.touches).time_us, made.touches.edge_us, atol=1e-3
    )


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
def test_edges_tell_how_long_a_bench_rested(bench_sample: Path) -> None:
    """Or a latch that is late after a rest looks like one that jitters."""
    campaign = read_campaign(bench_sample)
    bare = without(campaign, "time_s", "feed_mm_min", "approach_mm")

    made = [playable(one) for one in (bare, without(bare, "edge_us", "latch_us"))]
    scene, lost = (replace(Scene.of(one), stood_in=one.stood_in) for one in made)

    told = recorded_only(scene, sequence(scene))
    rest_s = told["rest before"][1:]
    known = ~np.isnan(rest_s)  # the touch before is in the record
    between_s = np.diff(campaign.touches.edge_us) / 1e6
    assert known.sum() > 200
    assert rest_s[known] == pytest.approx(between_s[known], abs=0.05)
    assert "rest before" not in recorded_only(lost, sequence(lost))


def test_capture_that_begins_with_an_edge_has_time_for_its_move(bench_sample: Path) -> None:
    """Its clock starts at the trigger: the way to the first surface lies before it."""
    campaign = without(read_campaign(bench_sample), "time_s", "feed_mm_min", "approach_mm")
    touches, begin_us = campaign.touches, float(np.min(campaign.touches.edge_us))
    stamps = ("edge_us", "latch_us", "report_us")
    early = replace(touches, **{name: getattr(touches, name) - begin_us for name in stamps})

    made, _ = said_of(replace(campaign, touches=early))

    met_us = expected_contact(made.nominal, made.touches).time_us
    np.testing.assert_allclose(met_us, made.touches.edge_us, atol=1e-3)
    late_us, was_us = (t.latch_us - t.edge_us for t in (made.touches, touches))
    np.testing.assert_allclose(late_us, was_us, atol=1e-3)


@pytest.mark.parametrize("unknown", ["feed_mm_min", "approach_mm"])
def test_start_of_a_move_that_nobody_knows_tells_nothing_of_its_edge(
    bench_sample: Path, unknown: str
) -> None:
    """Rigs log when they began to arm, or to wait: the edge came when it came."""
    campaign = read_campaign(bench_sample)
    waited_s = np.random.default_rng(1).uniform(0.0, 5.0, len(campaign.touches))
    armed = replace(campaign.touches, time_s=campaign.touches.edge_us / 1e6 - waited_s)

    made, _ = said_of(without(replace(campaign, touches=armed), unknown))

    np.testing.assert_allclose(
        expected_contact(made.nominal, made.touches).time_us, made.touches.edge_us, atol=1e-3
    )
    assert "motion" not in Scene.of(made).streams


def test_bench_without_motion_shows_the_same_gap(bench_sample: Path) -> None:
    campaign = read_campaign(bench_sample)
    made, _ = said_of(without(campaign, "time_s", "feed_mm_min", "approach_mm"))

    gaps = compare(made, seed=1, jobs=2).differing

    late = next(gap for gap in gaps if gap.observable.name == "latch_after_edge_us")
    assert 41 < late.mean_difference.value < 43


def test_moves_that_are_timed_by_their_edges_tell_no_noise_of_these(bench_sample: Path) -> None:
    """Edges would lie just where they are expected, whatever the instrument that read them."""
    campaign = read_campaign(bench_sample)
    rough = believing(campaign.nominal, {("bench", "reference_jitter_us"): 5.0})
    campaign = played_again(replace(campaign, nominal=rough))
    assert "motion" in Scene.of(playable(campaign)).streams

    made, _ = said_of(without(campaign, "time_s", "feed_mm_min", "approach_mm"))
    scene = Scene.of(made)

    assert "motion" not in scene.streams
    fitted = fit_beliefs(scene, NOTHING, uncertain(made.nominal))
    assert fitted.nominal.bench.reference_jitter_us == pytest.approx(5.0, rel=0.15)


def test_machine_without_times_keeps_its_deviations_alone(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    stamped = replace(
        campaign, touches=replace(campaign.touches, latch_us=np.ones(len(campaign.touches)))
    )

    made, said = said_of(without(stamped, "time_s", "approach_mm"))

    assert said[1].startswith("time_s: not recorded; what cannot be told without it: drifts")
    np.testing.assert_array_equal(made.touches.deviation_um, campaign.touches.deviation_um)
    assert np.isnan(made.touches.latch_us).all()
    assert (np.diff(made.touches.time_s) > 0).all()
    assert (expected_contact(made.nominal, made.touches).speed_mm_s * 60).tolist() == (
        pytest.approx(made.touches.feed_mm_min.tolist())
    )


def test_a_touch_without_a_time_begins_once_the_one_before_has_met_its_surface(
    machine_sample: Path,
) -> None:
    bare = without(read_campaign(machine_sample), "time_s", "edge_us", "latch_us", "report_us")
    # A slow touch is followed by fast ones.
    slow = np.arange(len(bare.touches)) % 5 == 0
    feed_mm_min = np.where(slow, 10.0, 1000.0)

    made, _ = said_of(replace(bare, touches=replace(bare.touches, feed_mm_min=feed_mm_min)))

    contact_s = expected_contact(made.nominal, made.touches).time_us / 1e6
    assert np.all(made.touches.time_s[1:] > contact_s[:-1])


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
def test_times_that_stand_in_beside_known_ones_keep_the_order_of_the_file(
    machine_sample: Path,
) -> None:
    campaign = read_campaign(machine_sample)
    touches = campaign.touches.in_order_of_time()
    time_s = touches.time_s - touches.time_s[3]
    time_s[[0, 1, 2, 5, 6, 20]] = np.nan

    made = playable(replace(campaign, touches=replace(touches, time_s=time_s))).touches

    assert (np.diff(made.time_s) >= 0.0).all()
    assert (made.time_s[[0, 1, 2]] == 0.0).all()


def test_machine_without_feed_is_told(machine_sample: Path) -> None:
    said = refusal(playable, without(read_campaign(machine_sample), "feed_mm_min"))

    assert said.endswith(
        "touches.csv: feed_mm_min: not recorded in 400 of 400 touches; "
        "without it nobody can tell a delay from a length; import has --feed"
    )


def test_degrees_stand_for_millimetres(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    turned = Touches.from_columns(
        touch=np.arange(2),
        time_s=np.arange(2.0),
        feed_mm_min=np.full(2, 60.0),
        approach_mm=np.ones(2),
        axis=np.array([Axis.B, Axis.X]),
        position_deg=np.array([45.0, np.nan]),
        position_mm=np.array([np.nan, 9.0]),
        deviation_arcsec=np.array([3.6, np.nan]),
        deviation_um=np.array([np.nan, 5.0]),
    )

    made = playable(replace(campaign, touches=turned)).touches

    assert made.position_mm.tolist() == [45.0, 9.0]
    assert made.deviation_um.tolist() == [1.0, 5.0]


def test_believed_effects_are_played(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    controller = Controller.for_campaign(campaign.nominal, campaign.touches)
    believed = BelievedEffect("isr_latency", {"latency_us": 500.0})
    nominal = replace(campaign.nominal, believed_effects=(believed,))
    effect = Effect("isr_latency", {"latency_us": 500.0})

    switched_on = play(
        replace(campaign.nominal, version=2),
        controller,
        campaign.touches,
        seed=3,
        switched_on=[effect],
    )
    of_the_belief = play(nominal, controller, campaign.touches, seed=3)

    np.testing.assert_array_equal(of_the_belief.deviation_um, switched_on.deviation_um)


def test_calibration_temperature_is_what_is_neither_warm_nor_cold(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    controller = Controller.for_campaign(campaign.nominal, campaign.touches)
    growth = [Effect("thermal_drift", {"drift_um_k": 10.0})]
    warmer = replace(campaign.touches, temp_c=campaign.touches.temp_c + 3.0)
    probe = replace(campaign.nominal.probe, calibrated_at_c=23.0)
    nominal = replace(campaign.nominal, version=2)

    at_20 = play(nominal, controller, campaign.touches, seed=3, switched_on=growth)
    at_23 = play(replace(nominal, probe=probe), controller, warmer, seed=3, switched_on=growth)

    np.testing.assert_allclose(at_23.deviation_um, at_20.deviation_um, atol=0.51)


@pytest.mark.parametrize(("version", "least_um"), [(1, 0.0), (2, -12.0)])
def test_pretravel_below_nothing_is_played_in_version_2(
    machine_sample: Path, version: int, least_um: float
) -> None:
    campaign = read_campaign(machine_sample)
    still = replace(campaign.nominal.probe, pretravel_um=0.0, lobe_um=10.0, delay_us=0.0)
    nominal = replace(campaign.nominal, probe=still, version=version)
    controller = Controller.for_campaign(nominal, campaign.touches)

    found = play(nominal, controller, campaign.touches, seed=3).deviation_um

    assert least_um <= np.nanmin(found) <= least_um + 4.0


def simulator_takes(nominal: Nominal) -> bool:
    _, lib = connection()
    rig = filled_rig(nominal, Controller(overtravel_mm=2.0))
    return bool(lib.sim_play_check(rig.structure) == lib.SIM_PLAY_OK)


@pytest.mark.parametrize(("section", "name"), PLAYED)
def test_what_is_refused_of_a_rig_is_what_the_simulator_refuses(
    bench_sample: Path, section: str, name: str
) -> None:
    believed = read_campaign(bench_sample).nominal
    for limit, beyond in zip(PLAYED[section, name], (-np.inf, np.inf), strict=True):
        at = replace(getattr(believed, section), **{name: limit})
        past = replace(getattr(believed, section), **{name: float(np.nextafter(limit, beyond))})

        refuse_unplayable(Path("x"), replace(believed, version=2, **{section: at}))
        assert simulator_takes(replace(believed, version=2, **{section: at}))
        assert not simulator_takes(replace(believed, version=2, **{section: past}))
        told = refusal(refuse_unplayable, Path("x"), replace(believed, **{section: past}))
        assert told.startswith(f"x: {section}.{name}: expected ")


@pytest.mark.parametrize("name", PLAYED_TOUCHES)
def test_what_is_refused_of_a_touch_is_what_the_simulator_refuses(
    bench_sample: Path, name: str
) -> None:
    campaign = read_campaign(bench_sample)
    for beyond in (PLAYED_TOUCHES[name][0] / 2 - 1e-9, PLAYED_TOUCHES[name][1] * 1.001):
        values = getattr(campaign.touches, name).copy()
        values[7] = beyond
        touches = replace(campaign.touches, **{name: values})

        told = refusal(refuse_unplayable_touches, Path("x"), touches)
        assert told.startswith(f"x: {name} of touch {touches.touch[7]}: expected ")
        with pytest.raises(SimulationError, match="a condition of a touch"):
            play(campaign.nominal, Controller(overtravel_mm=2.0), touches, seed=1)


@pytest.mark.parametrize("name", ["edge_us", "latch_us", "report_us"])
def test_a_stamp_of_another_century_is_refused(bench_sample: Path, name: str) -> None:
    """A search for what may have made latches 28 years late did not end."""
    campaign = read_campaign(bench_sample)
    stamps = getattr(campaign.touches, name).copy()
    stamps[3] = 9e14
    late = replace(campaign, touches=replace(campaign.touches, **{name: stamps}))

    with pytest.raises(InputError, match=rf"{name} of touch 4: .*9e\+14"):
        playable(late)


def test_one_effect_more_than_the_simulator_has_room_for_is_refused(bench_sample: Path) -> None:
    believed = read_campaign(bench_sample).nominal
    lost = BelievedEffect("backlash", {"backlash_um": 1.0})
    full = replace(believed, believed_effects=(lost,) * 8)
    over = replace(believed, believed_effects=(lost,) * 9)

    refuse_unplayable(Path("x"), full)
    assert simulator_takes(full)
    assert not simulator_takes(over)
    assert refusal(refuse_unplayable, Path("x"), over) == "x: effect: expected at most 8, got 9"


def test_a_deviation_tells_nothing_where_the_axis_may_not_have_had_its_feed(
    machine_sample: Path,
) -> None:
    """How far it had come is not recorded: who accelerates for longer than 1 mm may have met it."""
    campaign = read_campaign(machine_sample)
    slow = replace(campaign.nominal, axis=replace(campaign.nominal.axis, accel_mm_s2=100.0))
    feeds = campaign.touches.feed_mm_min
    is_long = (feeds / 60.0) ** 2 / 200.0 > 1.0
    assert is_long.any()
    assert not is_long.all()

    made, said = said_of(without(replace(campaign, nominal=slow), "approach_mm"))

    np.testing.assert_array_equal(
        np.isnan(made.touches.deviation_um),
        is_long | np.isnan(campaign.touches.deviation_um),
    )
    assert any(
        f"from {feeds[is_long].min():g} mm/min on: the ramp is longer than 1 mm" in line
        for line in said
    )
    np.testing.assert_array_equal(
        playable(replace(campaign, nominal=slow)).touches.deviation_um,
        campaign.touches.deviation_um,
    )
