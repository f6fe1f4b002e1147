"""An effect gains on the record what it gains on its own plays, or it stands for something else."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, played, played_again, stamped_machine, thinned
from skiplatch.campaign import Campaign
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.material import DEFAULT
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.gains import shares_gained
from skiplatch.diagnosis.verdict.work import Work
from skiplatch.simulator.effects import Effect

LATE = Effect("isr_latency", {"latency_us": 40.0})
SLOW = Effect("report_delay", {"delay_us": 300.0})
BOUNCE = Effect("contact_bounce", {"probability": 0.3, "mean_us": 100.0})


def fit_of(*effects: Effect) -> Fit:
    candidates = tuple(CANDIDATES[effect.id] for effect in effects)
    parameters = tuple(
        np.array([effect.parameters.get(name, 0.0) for name in candidate.names])
        for effect, candidate in zip(effects, candidates, strict=True)
    )
    return Fit(candidates, parameters, frozenset())


def shares(campaign: Campaign, fit: Fit, seed: int = 1) -> Mapping[str, float]:
    scene = Scene.of(campaign)
    rigs = Rig(scene.nominal), Rig(scene.nominal, as_effects(fit))
    return shares_gained(scene, np.ones(len(scene), bool), rigs, fit, seed=seed)


def latency(size_us: float) -> Effect:
    return replace(LATE, parameters={"latency_us": size_us})


@pytest.mark.parametrize("effects", [(LATE,), (BOUNCE,), (SLOW, LATE)])
def test_the_truth_gains_as_its_plays_do(effects: tuple[Effect, ...]) -> None:
    for seed in range(3):
        found = shares(played(BENCH, *effects, seed=seed), fit_of(*effects), seed)

        assert list(found.values()) == pytest.approx([1.0] * len(effects), abs=0.15)


def bound_to_the_scan(phase: float, spread: float) -> Campaign:
    """A rig that begins its motions on a scan, so that the scans keep their grid."""
    campaign = played(BENCH)
    touches, scan_us = campaign.touches, campaign.nominal.plc.scan_us
    rng = np.random.default_rng(3)
    wait_us = (-rng.normal(phase, spread, len(touches)) % 1.0) * scan_us
    later_us = np.where(touches.on_plc, touches.latch_us - touches.edge_us - wait_us, 0.0)
    speed_um_us = touches.feed_mm_min / 60e3
    bound = replace(
        touches,
        edge_us=touches.edge_us + later_us,
        time_s=touches.time_s + later_us * 1e-6,
        deviation_um=touches.deviation_um - speed_um_us * later_us,
    )
    return replace(campaign, touches=bound)


def test_plays_that_move_scans_to_the_touches_are_asked_for_no_grid() -> None:
    fit = fit_of(Effect("scan_phase_lock", {"phase": 0.4, "spread": 0.08}))

    (there,) = shares(bound_to_the_scan(0.4, 0.08), fit).values()
    (elsewhere,) = shares(bound_to_the_scan(0.6, 0.08), fit).values()

    assert there == pytest.approx(1.0, abs=0.15)
    assert elsewhere < 0.0


@pytest.mark.parametrize("size_us", [20.0, 80.0])
def test_one_of_another_size_gains_less(size_us: float) -> None:
    (share,) = shares(played(BENCH, LATE), fit_of(latency(size_us))).values()

    assert share < 0.5


def test_the_one_that_is_off_is_told_from_the_others() -> None:
    found = shares(played(BENCH, SLOW, LATE), fit_of(SLOW, latency(60.0)))

    assert found[SLOW.id] == pytest.approx(1.0, abs=0.15)
    assert found[LATE.id] < 0.5


def test_what_looks_like_it_gains_less() -> None:
    """Most edges bounce a little, in place of few that do so much."""
    alike = Effect("contact_bounce", {"probability": 0.9, "mean_us": 30.0})

    (share,) = shares(played(BENCH, BOUNCE), fit_of(alike)).values()

    assert share < 0.5


def test_of_a_rig_as_noisy_as_the_record_the_truth_gains_no_less_than_its_plays() -> None:
    """At one slow feed, a noise a third above the belief tells retries worse than believed."""
    retry = Effect("link_retry", {"probability": 0.15, "period_us": 6000.0})
    machine = stamped_machine()
    slow = np.full(len(machine.touches), 60.0)
    near = np.ones(len(slow))
    touches = replace(machine.touches, feed_mm_min=slow, approach_mm=near)
    machine = replace(machine, touches=touches)

    def repeating_to(campaign: Campaign, um: float) -> Campaign:
        probe = replace(campaign.nominal.probe, repeatability_um=um)
        return replace(campaign, nominal=replace(campaign.nominal, probe=probe))

    campaign = repeating_to(played_again(repeating_to(machine, 0.65), retry, seed=0), 0.5)
    work = Work(Scene.of(thinned(campaign)), None, 1, 1, DEFAULT)
    fit, rows = fit_of(retry), np.ones(len(work.scene), bool)
    rig = Rig(work.scene.nominal, as_effects(fit))

    plain, noisy = (
        shares_gained(work.scene, rows, (work.rig(None), one), fit, seed=1)[retry.id]
        for one in (rig, work.as_noisy(rig, fit))
    )

    assert plain < 2.0 / 3.0
    assert noisy == 1.0


def test_an_effect_that_gains_nothing_where_it_is_there_is_none() -> None:
    (share,) = shares(played(BENCH, LATE), fit_of(latency(1e-3))).values()

    assert share == 0.0


def test_only_the_touches_that_count_are_asked() -> None:
    campaign, calm = played(BENCH, LATE), played(BENCH)
    touches, fit = campaign.touches, fit_of(LATE)
    first = np.arange(len(touches)) < len(touches) // 2
    latch_us = np.where(first, touches.latch_us, calm.touches.latch_us)
    scene = Scene.of(replace(campaign, touches=replace(touches, latch_us=latch_us)))
    rigs = Rig(scene.nominal), Rig(scene.nominal, as_effects(fit))

    there, everywhere = (
        shares_gained(scene, rows, rigs, fit, seed=1)[LATE.id] for rows in (first, first | True)
    )

    assert there == pytest.approx(1.0, abs=0.15)
    assert everywhere < 0.75
