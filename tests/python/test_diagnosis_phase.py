"""Predictions keep to the edges and to the phase of the scans that a record shows."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, played, played_again, stamped_machine
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, read_campaign, read_nominal
from skiplatch.diagnosis.fit.material import DEFAULT
from skiplatch.diagnosis.plays.edges import at_given_edges
from skiplatch.diagnosis.plays.leftover import Beside, left_over
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.grid import off_grid
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.span import Span
from skiplatch.units import S_PER_MIN, UM_PER_MM, US_PER_S

REPLICATES = 4
FAR_US = 50_000.0


def predicted(campaign: Campaign, *effects: Effect, seed: int = 5) -> Outcomes:
    """Predict the recorded touches themselves, with the random numbers of another seed."""
    rig = rig_of(campaign, *effects)
    return rig.play(campaign.touches, seed=seed, replicates=REPLICATES, in_phase=True)


def rig_of(campaign: Campaign, *effects: Effect) -> Rig:
    """Give the rig of a campaign, whose stamps tell when its scans began."""
    return Rig(campaign.nominal, effects).whose_scans_are(campaign.touches, seed=1)


def test_scans_of_a_prediction_begin_when_the_recorded_ones_did() -> None:
    campaign = played(BENCH)
    plc = campaign.touches.on_plc

    off_us = predicted(campaign).latch_us[:, plc] - campaign.touches.latch_us[plc]

    within_ticks = np.abs(off_us) <= 2.0 * campaign.nominal.skip.tick_us
    assert within_ticks.mean() > 0.98  # the rest wait for another scan by a hair's breadth


def test_stamps_that_keep_no_grid_leave_every_replicate_its_own_phase() -> None:
    campaign = played(BENCH)
    plc = campaign.touches.on_plc
    anywhere = np.random.default_rng(1).uniform(0.0, 1e5, len(plc))
    lost = replace(campaign, touches=replace(campaign.touches, latch_us=anywhere))

    controller = Controller.for_campaign(campaign.nominal, campaign.touches)
    free = play(campaign.nominal, controller, campaign.touches, seed=5, replicates=REPLICATES)

    np.testing.assert_array_equal(predicted(lost).latch_us, free.latch_us)


def test_the_skip_path_is_played_at_its_own_time() -> None:
    campaign = played(BENCH, Effect("timer_quantisation", {"tick_us": 8.0}))
    effect = Effect("timer_quantisation", {"tick_us": 8.0})

    stamps = predicted(campaign, effect).latch_us[:, ~campaign.touches.on_plc]

    np.testing.assert_allclose(stamps % 8.0, 0.0, atol=1e-6)


def test_updates_of_the_position_are_those_of_the_record_on_both_paths() -> None:
    held = Effect("servo_hold", {"period_us": 800.0, "phase_deg": 70.0})
    campaign = played(BENCH, held)

    off_um = predicted(campaign, held).deviation_um - campaign.touches.deviation_um

    # Beside an update or a scan by a hair's breadth it is the other one.
    assert (np.abs(off_um) <= 2.0 * campaign.nominal.axis.resolution_um).mean() > 0.9


def test_plays_keep_how_old_a_position_is_in_a_scan_that_lasts_whole_updates() -> None:
    period_us = read_nominal(BENCH / "nominal.toml").plc.scan_us / 8.0
    held = Effect("servo_hold", {"period_us": period_us, "phase_deg": 70.0})
    campaign = played(BENCH, held)
    touches = campaign.touches

    def ages_us(rig: Rig) -> FloatArray:
        plays = rig.play(touches, seed=5, replicates=REPLICATES)
        waits_us = plays.latch_us - plays.true_edge_us
        shown_us = plays.deviation_um / (touches.feed_mm_min * UM_PER_MM / S_PER_MIN / US_PER_S)
        return np.median((waits_us - shown_us)[:, touches.on_plc], axis=1)

    kept, drawn = (ages_us(rig) for rig in (rig_of(campaign, held), Rig(campaign.nominal, [held])))
    assert np.ptp(kept) < 0.03 * period_us < 0.1 * period_us < np.ptp(drawn)


def test_plays_round_the_stamps_of_scans_as_the_clock_that_was_recorded_did() -> None:
    coarse = Effect("timer_quantisation", {"tick_us": 11.0})
    campaign = played(BENCH, coarse)
    period_us, plc = campaign.nominal.plc.scan_us, campaign.touches.on_plc

    plays = rig_of(campaign, coarse).play(campaign.touches, seed=5, replicates=REPLICATES)

    off_us = off_grid(plays.latch_us[:, plc], period_us)
    recorded_us = off_grid(campaign.touches.latch_us[plc], period_us)
    assert np.std(recorded_us) > 3.0
    assert (np.abs(off_us - recorded_us) < 1.5).mean() > 0.95  # beside a scan it is the other one


@pytest.mark.parametrize("seed", range(3))
def test_stamps_of_a_coarse_clock_tell_when_scans_began_as_closely_as_can_be(seed: int) -> None:
    """A tick of 0.3 of a scan: their mean tells it to some twentieth of one."""
    coarse = Effect("timer_quantisation", {"tick_us": 610.0})
    campaign = played(BENCH, coarse, seed=seed)
    plc = campaign.touches.on_plc

    plays = rig_of(campaign, coarse).play(campaign.touches, seed=5, replicates=50)

    off_us = plays.latch_us[:, plc] - campaign.touches.latch_us[plc]
    assert (off_us == 0.0).mean() > 0.97


def test_plays_wait_for_the_recorded_scans_as_long_as_for_any() -> None:
    campaign = played(BENCH)
    touches, scan_us = campaign.touches, campaign.nominal.plc.scan_us

    plays = rig_of(campaign).play(touches, seed=5, replicates=50)

    waits = (plays.latch_us - plays.true_edge_us)[:, touches.on_plc] / scan_us
    assert np.mean(waits) == pytest.approx(0.5, abs=0.01)
    assert np.std(waits) == pytest.approx(1.0 / np.sqrt(12.0), abs=0.01)
    late = (plays.latch_us - touches.latch_us)[:, touches.on_plc]
    assert (np.abs(late) < 0.01 * scan_us).mean() > 0.98
    assert not plays.start_delay_us[:, touches.on_skip].any()


def test_a_move_at_the_beginning_of_time_waits_for_a_later_scan() -> None:
    """It would have to begin before, for some waits that the recorded scan allows."""
    campaign = played(BENCH)
    plc = np.flatnonzero(campaign.touches.on_plc)
    for first in plc[:8]:
        touches = campaign.touches.select(slice(first, None))
        begun_s = touches.time_s[0]
        stamps = ("edge_us", "latch_us", "report_us")
        sooner = {name: getattr(touches, name) - begun_s * US_PER_S for name in stamps}
        touches = replace(touches, time_s=touches.time_s - begun_s, **sooner)
        rig = Rig(campaign.nominal).whose_scans_are(touches, seed=1)

        plays = rig.play(touches, seed=5, replicates=50)

        waits = (plays.latch_us - plays.true_edge_us)[:, 0] / campaign.nominal.plc.scan_us
        assert np.all((waits >= 0.0) & (waits < 1.01))
        assert np.std(waits) > 0.2


@pytest.mark.parametrize(
    ("tick_us", "open_us"),
    [(None, 0.25), (8.0, 8.0), (11.0, 1.0), (3.0, 1.0)],  # of scans of 2000 µs
)
def test_it_stays_open_by_how_much_scans_may_move_before_a_stamp_shows_it(
    tick_us: float | None, open_us: float
) -> None:
    effects = [Effect("timer_quantisation", {"tick_us": tick_us})] if tick_us else []
    campaign = played(BENCH, *effects)
    assert (campaign.nominal.plc.scan_us, campaign.nominal.skip.tick_us) == (2000.0, 0.25)

    ((period_us, scans),) = rig_of(campaign, *effects).scans.items()

    assert period_us == campaign.nominal.plc.scan_us
    assert scans.open_us == pytest.approx(open_us)


@pytest.mark.parametrize("in_phase", [False, True])
def test_scans_that_change_their_period_begin_as_recorded_before_and_after(in_phase: bool) -> None:
    """At the longer period the scans go on from one of the shorter: one of five, here the first."""
    bench = read_campaign(BENCH)
    last = int(np.median(bench.touches.touch))
    slower = Effect("scan_period", {"period_us": 8000.0}, Span(until=last))
    campaign = played_again(bench, slower)
    touches, plc = campaign.touches, campaign.touches.on_plc

    plays = rig_of(campaign, slower).play(touches, seed=5, replicates=40, in_phase=in_phase)

    off_us = (plays.latch_us - touches.latch_us)[:, plc]
    period_us = np.where(touches.touch <= last, 10_000.0, 2000.0)[plc]
    off_grid_us = off_us - np.rint(off_us / period_us) * period_us
    assert np.abs(off_grid_us).max() <= 2.0 * campaign.nominal.skip.tick_us
    waits_us = (plays.latch_us - plays.true_edge_us)[:, plc]
    longest_us = [waits_us[:, period_us == each].max() for each in (10_000.0, 2000.0)]
    assert longest_us == pytest.approx([10_000.0, 2000.0], rel=0.1)


def test_scans_that_nothing_tells_go_on_from_the_same_one_at_another_period() -> None:
    bench = read_campaign(BENCH)
    last = int(np.median(bench.touches.touch))
    slower = Effect("scan_period", {"period_us": 8000.0}, Span(until=last))

    plays = Rig(bench.nominal, [slower]).play(bench.touches, seed=5, replicates=REPLICATES)

    off_us = off_grid(plays.latch_us[:, bench.touches.on_plc], 2000.0)
    assert np.ptp(off_us, axis=1).max() <= 2.0 * bench.nominal.skip.tick_us
    first_us = plays.latch_us[:, bench.touches.on_plc][:, 0] % 2000.0
    assert np.ptp(first_us) > 50.0


def test_noise_of_the_reference_instrument_moves_no_contact() -> None:
    campaign = played(BENCH)

    assert at_given_edges(Rig(campaign.nominal), campaign.touches) is campaign.touches


@pytest.mark.parametrize("off_us", [FAR_US, -FAR_US])
def test_contacts_close_at_the_edges_that_were_injected(off_us: float) -> None:
    campaign = played(BENCH)
    edges = campaign.touches.edge_us + off_us * np.linspace(0.5, 1.0, len(campaign.touches))
    conditions = replace(campaign.touches, edge_us=edges)

    retimed = at_given_edges(Rig(campaign.nominal), conditions)
    controller = Controller.for_campaign(campaign.nominal, retimed)
    closed_us = play(campaign.nominal, controller, retimed, seed=1).true_edge_us[0]

    np.testing.assert_allclose(closed_us, edges, atol=0.01)


def test_an_edge_that_waits_for_a_slot_waits_for_the_scan_that_comes_then() -> None:
    """Slots and scans keep their distance in time: no edge passes both at another one."""
    slots = Effect("link_slotting", {"slot_us": 900.0, "phase_deg": 40.0})
    recorded = played_again(stamped_machine(), slots)

    found = left_over(Beside.of(Scene.of(recorded), rig_of(recorded, slots), seed=1))

    assert [one for one in found if one.is_significant and one.is_material(DEFAULT)] == []
