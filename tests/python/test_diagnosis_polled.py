"""Touches that a PLC polls, without stamps, tell errors of the position: the slow ones best."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played_again, stamped_machine
from skiplatch.campaign import Axis, Campaign, Datum, InputPath, Kind, Touches, read_campaign
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.cell_scores import Ensemble, floor_of
from skiplatch.diagnosis.verdict.shrink import PlayedRigs
from skiplatch.simulator.effects import Effect

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
        Ensemble.of(plays + there, np.ones(400), is_pooled=True).scored(recorded + there)
        for there in (place, 0.0)
    )

    floor = float(floor_of(rng.random((1, 4000)))[0])
    assert alike.scores.mean() == pytest.approx(floor, rel=0.05)
    assert apart.scores.mean() == pytest.approx(floor, rel=0.05)
    assert apart.floor.mean() == pytest.approx(alike.floor.mean(), rel=0.02)
