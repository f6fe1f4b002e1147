"""Which changes matter: thresholds as a fraction of the rig's own spread, in µs and in µm."""

import math

import numpy as np
import pytest

from played_campaigns import BENCH, LATE_BENCH, MACHINE, played, thinned
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis import Verdict, as_json, as_text, diagnose
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra
from skiplatch.diagnosis.fit.material import Materiality, is_material
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect


def bench() -> Scene:
    return Scene.of(read_campaign(BENCH))


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_a_shift_is_material_from_a_fraction_of_the_spread_on(share: float) -> None:
    scene = Scene.of(read_campaign(MACHINE))
    stream = scene.streams["deviation_plc"]
    change = Change(position_um=share * 0.3 * stream.law.spread * scene.plc)

    assert is_material(scene, change, Materiality(fraction=0.3)) == (share > 1.0)


@pytest.mark.parametrize("us", [90.0, 110.0])
def test_a_delay_is_material_from_the_stated_time_on(us: float) -> None:
    assert is_material(bench(), Change(skip_us=us), Materiality(us=100.0)) == (us > 100.0)


@pytest.mark.parametrize("um", [4.5, 5.5])
def test_an_error_is_material_from_the_stated_length_on(um: float) -> None:
    assert is_material(bench(), Change(position_um=um), Materiality(um=5.0)) == (um > 5.0)


@pytest.mark.parametrize("us", [90.0, 110.0])
def test_another_scan_period_is_material_from_the_stated_time_on(us: float) -> None:
    assert is_material(bench(), Change(period_us=us), Materiality(us=100.0)) == (us > 100.0)


@pytest.mark.parametrize("share", [0.08, 0.12])
def test_lobes_are_material_beyond_what_a_calibration_is_good_for(share: float) -> None:
    scene = Scene.of(read_campaign(MACHINE))
    other = Change(pretravel_um=share * scene.lobes_um)

    assert is_material(scene, other, Materiality(fraction=1e-3)) == (share > 0.1)
    assert is_material(scene, other, Materiality(um=1e-3))


@pytest.mark.parametrize("share", [0.05, 0.8])
def test_what_brings_waits_that_the_believed_scan_cannot_is_material(share: float) -> None:
    jitter_us = share * read_campaign(MACHINE).nominal.plc.scan_us
    late = Effect("scan_jitter", {"jitter_us": jitter_us, "tail_us": 0.0})
    scene = Scene.of(played(MACHINE, late))
    seldom = Change(scan_extra=(Extra(0.01, width=2.0 * jitter_us),))
    hardly = Change(position_um=0.1 * scene.streams["deviation_plc"].law.spread * scene.plc)

    assert is_material(scene, seldom) == (share > 0.1)
    assert not is_material(scene, seldom, Materiality(um=1e6))
    assert not is_material(scene, hardly)  # it leaves them where they cannot be


@pytest.mark.parametrize("ticks", [0.5, 2.0])
def test_a_clock_that_drifts_by_less_than_a_tick_in_all_is_not_material(ticks: float) -> None:
    scene = bench()
    stamp_us = scene.touches.latch_us / np.sqrt(np.mean(scene.touches.latch_us**2))
    drift = Change(stamp_us=ticks * scene.nominal.skip.tick_us * stamp_us)

    assert is_material(scene, drift) == (ticks > 1.0)


def test_lost_touches_are_always_material() -> None:
    assert is_material(bench(), Change(lost=0.01), Materiality(us=1e9, um=1e9))


@pytest.mark.parametrize("steps", [0.05, 0.5])
def test_a_shift_that_rounding_hides_is_not_material(steps: float) -> None:
    scene = bench()
    shift_um = steps * scene.nominal.axis.resolution_um
    shift_um += scene.speed.max() * scene.nominal.skip.tick_us * (steps > 0.1)

    assert is_material(scene, Change(position_um=shift_um), Materiality(um=1e-9)) == (steps > 0.1)


@pytest.mark.parametrize("steps", [0.3, 0.7])
def test_scatter_that_rounding_hides_is_not_material(steps: float) -> None:
    scene = bench()
    scatter_um = steps * scene.nominal.axis.resolution_um
    scatter = Change(position_sigma_us=scatter_um / scene.speed)

    assert is_material(scene, scatter, Materiality(um=1e-9)) == (steps > 0.5)


def test_a_stated_size_takes_away_the_least_gain() -> None:
    assert Materiality().nats_a_touch == pytest.approx(0.005)
    assert Materiality(us=1.0).nats_a_touch == 0.0


@pytest.mark.long
def test_a_delay_below_the_threshold_is_no_gap() -> None:
    above = Materiality(fraction=1e4)

    diagnosis = diagnose(thinned(read_campaign(LATE_BENCH), 8), seed=1, materiality=above)

    assert diagnosis.verdict == Verdict.NO_GAP
    assert not diagnosis.effects
    assert "A gap counts from 1e+04 of the rig's own spread on." in as_text(diagnosis)


@pytest.mark.long
def test_an_error_of_length_is_no_gap_below_the_threshold() -> None:
    campaign = thinned(played(BENCH, Effect("backlash", {"backlash_um": 3.5})))
    by_default = diagnose(campaign, seed=1)
    below = diagnose(campaign, seed=1, materiality=Materiality(um=10.0))

    assert [named.effect.id for named in by_default.effects] == ["backlash"]
    assert below.verdict == Verdict.NO_GAP
    assert as_json(by_default)["material"] == {"fraction": 0.2, "us": None, "um": None}
    assert as_json(below)["material"]["um"] == pytest.approx(10.0)
    assert math.isclose(as_json(below)["material"]["fraction"], 0.2)
