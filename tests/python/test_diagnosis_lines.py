"""Values on coarse lines are held against plays by the line, and no closer."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again
from skiplatch.campaign import Campaign, Status, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.grid_starts import ticks
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.material import DEFAULT
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.likelihood.physics import line_bonus
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.leftover import Beside, left_over
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect


def mattering(campaign: Campaign, *effects: Effect) -> list[Left]:
    rig = Rig(campaign.nominal, effects).whose_scans_are(campaign.touches, seed=1)
    found = left_over(Beside.of(Scene.of(campaign), rig, seed=1))
    return [one for one in found if one.is_significant and one.is_material(DEFAULT)]


def test_ticks_are_stamped_as_they_are_though_plays_count_in_believed_ones() -> None:
    tick_us = 7.654_3
    coarse = Effect("timer_quantisation", {"tick_us": tick_us})
    campaign = played(BENCH, coarse)
    stamps = np.rint(campaign.touches.latch_us / tick_us) * tick_us
    as_stamped = replace(campaign, touches=replace(campaign.touches, latch_us=stamps))

    assert np.nanmax(np.abs(stamps - campaign.touches.latch_us)) > 0.0
    assert mattering(as_stamped, coarse) == []
    assert mattering(as_stamped) != []


@pytest.mark.parametrize("tick_us", [25.3, 299.57, 383.6, 640.1, 999.0])
def test_plays_begin_their_scans_where_coarse_ticks_tell(tick_us: float) -> None:
    """A µs beside that, some stamps fall to the next tick, and positions into another bin."""
    coarse = Effect("timer_quantisation", {"tick_us": tick_us})

    assert mattering(played(BENCH, coarse), coarse) == []


def test_stamps_on_no_believed_tick_tell_lines_that_are_not_far_apart() -> None:
    """What is written closer than the believed clock counts was never counted by it."""
    tick_us, believed_us = 48.269_2, 10.0
    campaign = played(BENCH, Effect("timer_quantisation", {"tick_us": tick_us}))
    stamps = np.rint(campaign.touches.latch_us / tick_us) * tick_us
    skip = replace(campaign.nominal.skip, tick_us=believed_us)
    touches = replace(campaign.touches, latch_us=np.round(stamps, 3))
    scene = Scene(replace(campaign.nominal, skip=skip), touches)
    coarse = CANDIDATES["timer_quantisation"]

    pitch, origin, nearest = max(ticks(scene, Change()), key=lambda p: score(scene, coarse, p))

    assert scene.stamp_step_us < 0.01 < Scene.of(campaign).stamp_step_us
    assert pitch == pytest.approx(tick_us, abs=1e-6)
    assert origin == pytest.approx(0.0, abs=0.01)
    assert nearest == 0.0


def score(scene: Scene, candidate: Candidate, parameters: Sequence[float]) -> float:
    change = candidate.change(scene, np.array(parameters))
    return float(sum(nats.sum() for nats in likelihood(scene, change).streams.values()))


def test_lines_of_a_counter_are_written_to_some_digits_where_surfaces_are_known() -> None:
    coarse = Effect("encoder_quantisation", {"resolution_um": 5.453_74, "is_coordinate": 1.0})
    campaign = played(MACHINE, coarse)
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.NONE))
    written = np.round(campaign.touches.deviation_um, 3)
    known = replace(
        campaign, nominal=nominal, touches=replace(campaign.touches, deviation_um=written)
    )

    assert mattering(known, coarse) == []
    assert mattering(known) != []


def test_a_latch_without_a_contact_says_nothing_of_the_scans() -> None:
    campaign = played(BENCH)
    touches = campaign.touches
    some = np.flatnonzero(touches.on_plc)[:3]
    stamps, status = touches.latch_us.copy(), touches.status.copy()
    stamps[some] -= 700.0
    off = replace(campaign, touches=replace(touches, latch_us=stamps))
    status[some] = Status.FALSE
    false = replace(campaign, touches=replace(touches, latch_us=stamps, status=status))

    assert "grid" in {one.observable for one in mattering(off)}
    assert mattering(false) == []


@pytest.mark.parametrize("origin_us", [0.0, -1.04e-4])
def test_plays_of_a_clock_lie_on_the_lines_that_were_found(origin_us: float) -> None:
    """A hair short of a believed tick they are stamped down to the one before."""
    coarse = CANDIDATES["timer_quantisation"]
    parameters = np.array([188.710_000_000_25, origin_us, 0.0])
    clock = Fit((coarse,), (parameters,), frozenset({"latch_skip"}))
    recorded = read_campaign(BENCH)
    fine = replace(recorded.nominal, skip=replace(recorded.nominal.skip, tick_us=0.01))

    scene = Scene.of(played_again(replace(recorded, nominal=fine), *as_effects(clock)))
    stream = scene.streams["latch_skip"]

    bonus = line_bonus(scene, stream, coarse.change(scene, parameters))[stream.indices]
    assert bonus.min() == bonus.max() > 0.0
