"""What happens to few touches: noticed by how many are beyond all plays, and by how far."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again, stamped_machine, thinned
from skiplatch.campaign import Campaign
from skiplatch.diagnosis.diagnose import diagnose
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.plays.leftover import Beside, left_over, noticed
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.rare import rarely_off
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import Effect

MASKED = Effect("isr_blocking", {"probability": 0.06, "length_us": 200.0})


def beside(campaign: Campaign, *switched_on: Effect) -> Beside:
    return Beside.of(Scene.of(campaign), Rig(campaign.nominal, switched_on), seed=1)


def off(campaign: Campaign, rows: np.ndarray, late_us: float | np.ndarray) -> Campaign:
    touches = campaign.touches
    latch_us, report_us = (
        np.where(rows, values + late_us, values) for values in (touches.latch_us, touches.report_us)
    )
    return replace(campaign, touches=replace(touches, latch_us=latch_us, report_us=report_us))


def test_few_late_touches_are_noticed_where_middle_and_scatter_tell_nothing() -> None:
    here = beside(played(BENCH, MASKED))

    assert "latch_skip" in rarely_off(here, DEFAULT)
    assert "latch_skip" not in noticed(left_over(here), DEFAULT)


@pytest.mark.parametrize("folder", [BENCH, MACHINE])
@pytest.mark.parametrize("seed", range(4))
def test_a_rig_is_not_off_beside_its_own_plays(folder: Path, seed: int) -> None:
    assert rarely_off(beside(played(folder, seed=seed)), DEFAULT) == frozenset()
    assert rarely_off(beside(played(folder, MASKED, seed=seed), MASKED), DEFAULT) == frozenset()


def test_five_that_are_far_off_are_noticed_on_their_path() -> None:
    campaign = played(BENCH)
    skip = np.flatnonzero(~Scene.of(campaign).plc)
    rows = np.isin(np.arange(len(campaign.touches)), skip[[10, 20, 30, 40, 50]])

    found = rarely_off(beside(off(campaign, rows, 400.0)), DEFAULT)

    assert "latch_skip" in found
    assert "latch_plc" not in found


def test_one_is_an_accident() -> None:
    campaign = played(BENCH)
    rows = np.arange(len(campaign.touches)) == np.flatnonzero(~Scene.of(campaign).plc)[10]

    assert rarely_off(beside(off(campaign, rows, 400.0)), DEFAULT) == frozenset()


def test_what_does_not_matter_is_not_noticed() -> None:
    here = beside(played(BENCH, MASKED))

    assert rarely_off(here, Materiality(us=1000.0, um=1000.0)) == frozenset()


@pytest.mark.long
def test_what_comes_to_few_touches_is_named() -> None:
    """Hardly any of them are held out: all are asked, in turn."""
    diagnosis = diagnose(thinned(played(BENCH, MASKED)), seed=1)

    assert diagnosis.verdict in (Verdict.EXPLAINED, Verdict.PARTLY_EXPLAINED)
    (named,) = diagnosis.effects
    assert MASKED.id in (named.effect.id, *named.alternatives)


@pytest.mark.long
def test_gross_errors_that_are_as_rare_are_no_effect() -> None:
    rng = np.random.default_rng(0)
    campaign = played(BENCH, seed=0)
    rows = rng.random(len(campaign.touches)) < 0.03
    far_us = rng.choice([-1.0, 1.0], len(rows)) * rng.uniform(300.0, 3000.0, len(rows))

    diagnosis = diagnose(off(campaign, rows, far_us), seed=1)

    assert diagnosis.effects == []


@pytest.mark.long
def test_what_no_look_notices_is_named_by_its_own_likelihood() -> None:
    """One touch in twenty late by less than a scan takes: middle, scatter and ends stay."""
    late = Effect("contact_bounce", {"probability": 0.05, "mean_us": 1.0, "least_us": 300.0})
    campaign = played(MACHINE, late, seed=2)
    here = beside(campaign)

    diagnosis = diagnose(campaign, seed=1)

    assert not noticed(left_over(here), DEFAULT) | rarely_off(here, DEFAULT)
    (named,) = diagnosis.effects
    assert late.id in (named.effect.id, *named.alternatives)
    assert diagnosis.verdict == Verdict.PARTLY_EXPLAINED


@pytest.mark.long
def test_the_likelihood_tells_what_no_look_notices_beside_a_larger_effect() -> None:
    bounce = Effect("contact_bounce", {"probability": 0.105, "span_us": 255.0})
    retry = Effect("link_retry", {"probability": 0.16, "period_us": 550.0})
    campaign = played_again(stamped_machine(), bounce, retry, seed=2)

    diagnosis = diagnose(campaign, seed=1)

    first, second = ({one.effect.id, *one.alternatives} for one in diagnosis.effects)
    assert retry.id in first
    assert bounce.id in second
