"""The shipped campaigns of the rig: read, believed, and diagnosed as what was switched on."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from skiplatch.bench.plan import read_plan
from skiplatch.campaign import read_campaign, read_nominal
from skiplatch.diagnosis import Diagnosis, Verdict, diagnose

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
PLANS = SAMPLES / "plans"
PLAYED = ("nominal", "cpu_load", "bus_load", "debounce")
LARGEST_BYTES = 150_000
JOBS = 2


@pytest.mark.parametrize("name", PLAYED)
def test_campaign_of_a_plan_is_whole_and_believes_in_the_rig(name: str) -> None:
    campaign, plan = read_campaign(SAMPLES / f"rig_{name}"), read_plan(PLANS / f"{name}.toml")

    touches = campaign.touches
    assert campaign.nominal == read_nominal(PLANS / "believed_vm.toml")
    assert touches.on_skip.sum() == touches.on_plc.sum() == plan.touches
    assert set(touches.feed_mm_min) == set(plan.feeds_mm_min)
    assert not np.isnan(touches.edge_us).any()
    assert (touches.path >= 0).all()
    assert touches.ok.mean() > 0.99
    assert (SAMPLES / f"rig_{name}" / "touches.csv").stat().st_size < LARGEST_BYTES


def test_figures_of_the_rig_are_another_campaigns_own() -> None:
    """Believed from a quiet campaign, they hold for the nominal one: the median is within 20 µs."""
    campaign = read_campaign(SAMPLES / "rig_nominal")
    skip, touches = campaign.nominal.skip, campaign.touches
    after_us = (touches.latch_us - touches.edge_us)[touches.on_skip]

    assert np.median(after_us) == pytest.approx(skip.latency_us + skip.jitter_us / 2, abs=20.0)


def found_in(name: str, one_of: int = 3) -> tuple[Diagnosis, Mapping[str, Mapping[str, float]]]:
    """Diagnose a campaign of the rig; give the parameters of the best model by effect.

    What is best need not be named: a kernel does more at a time than the catalogue has.

    Args:
        name: Of the campaign.
        one_of: So many touches one is diagnosed: they tell as much, and sooner.
    """
    campaign = read_campaign(SAMPLES / f"rig_{name}")
    some = campaign.touches.select(np.arange(len(campaign.touches)) % one_of == 0)
    diagnosis = diagnose(replace(campaign, touches=some), seed=1, jobs=JOBS)
    return diagnosis, {effect.id: effect.parameters for effect in diagnosis.ranking[0].effects}


@pytest.mark.long
def test_debounce_is_best_explained_by_a_filter() -> None:
    diagnosis, found = found_in("debounce", one_of=6)

    assert "input_filter" in found
    assert found["input_filter"]["delay_us"] >= 1000.0  # the plan's; the kernel counts in ticks
    assert diagnosis.gap["latch_after_edge_us"].shrink.low > 0.8


@pytest.mark.long
def test_busy_process_is_best_explained_by_late_scans_and_leaves_late_reports() -> None:
    """It is busy for 2920 µs at a time; reports wait for it in no way that the catalogue has."""
    diagnosis, found = found_in("cpu_load")

    assert set(found) & {"scan_jitter", "scan_overrun"}
    assert diagnosis.gap["latch_off_scan_grid_us"].shrink.low > 0.4
    late_us = {left.size for left in diagnosis.left if left.observable == "report"}
    assert max(late_us) > 1000.0
    assert diagnosis.verdict is not Verdict.EXPLAINED


@pytest.mark.long
def test_flood_is_best_explained_by_late_reports() -> None:
    diagnosis, found = found_in("bus_load", one_of=6)

    assert "report_delay" in found
    assert found["report_delay"]["queue_us"] > 256.0  # which is how long one frame takes
    assert found["report_delay"]["unqueued_share"] < 0.5
    assert diagnosis.verdict is not Verdict.EXPLAINED
