"""A recorded campaign beside the nominal simulation.

False-alarm rates of the statistical tests stand with them; seeds are fixed, so that a test that
passes once passes always.
"""

import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from skiplatch.campaign import Axis, Campaign, InputPath, Status, Touches, read_campaign
from skiplatch.comparison import Comparison, as_json, as_text, compare
from skiplatch.comparison.gap import adjusted_p_values, distance_to, quantiles_of
from skiplatch.report.comparison import as_html
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller
from skiplatch.stand_ins import playable

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
DATA = Path(__file__).parent / "data"
ALPHA = 0.1
JOBS = 2


def simulated(campaign: Campaign, seed: int) -> Campaign:
    """The nominal simulation in place of what was recorded."""
    touches = campaign.touches
    controller = Controller.for_campaign(campaign.nominal, touches)
    outcomes = play(campaign.nominal, controller, touches, seed=seed)
    played = replace(
        touches,
        edge_us=outcomes.edge_us[0],
        latch_us=outcomes.latch_us[0],
        report_us=outcomes.report_us[0],
        deviation_um=outcomes.deviation_um[0],
    )
    return replace(campaign, touches=played)


def with_touches(campaign: Campaign, **columns: np.ndarray) -> Campaign:
    return replace(campaign, touches=replace(campaign.touches, **columns))


def changed(comparison: Comparison) -> set[tuple[str, str]]:
    return {(gap.observable.name, gap.path.name) for gap in comparison.differing}


@pytest.mark.parametrize("folder", [SAMPLES / "machine_no_gap", DATA / "bench_no_gap"])
def test_recorded_campaigns_without_a_gap_agree(folder: Path) -> None:
    comparison = compare(read_campaign(folder), seed=1)

    assert comparison.agrees
    assert "agree within the noise floor" in as_text(comparison)


def test_a_longer_interrupt_latency_shows_on_the_skip_path_alone() -> None:
    comparison = compare(read_campaign(SAMPLES / "bench_isr_latency"), seed=1)

    assert changed(comparison) == {("deviation_um", "SKIP"), ("latch_after_edge_us", "SKIP")}
    for gap in comparison.differing:
        if gap.observable.unit == "µs":
            assert gap.mean_difference.low < 41.7 < gap.mean_difference.high
            assert gap.distance == pytest.approx(gap.mean_difference.value, rel=0.01)


@pytest.fixture(scope="module")
def without_a_gap() -> list[Comparison]:
    """60 campaigns with no gap, held against the simulation at a rate of 10 %.

    With the fewest replicates: the rates hold for any number of them.
    """
    campaign = read_campaign(SAMPLES / "machine_no_gap")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(import_module("skiplatch.comparison.compare"), "SIMULATED_TOUCHES", 0)
        return [
            compare(simulated(campaign, seed=1000 + i), seed=i, alpha=ALPHA, jobs=JOBS)
            for i in range(60)
        ]


@pytest.mark.long
def test_false_alarms_are_as_rare_as_stated(without_a_gap: list[Comparison]) -> None:
    """More than 14 alarms come once in 1,000 runs."""
    alarms = sum(bool(comparison.differing) for comparison in without_a_gap)

    assert stats.binom.sf(alarms - 1, len(without_a_gap), ALPHA) > 1e-3


def test_a_small_shift_of_every_touch_is_found_and_measured() -> None:
    campaign = simulated(read_campaign(SAMPLES / "machine_no_gap"), seed=5)
    on_skip = campaign.touches.path == InputPath.SKIP
    shift_um = np.where(on_skip, 0.5, 0.0)
    shifted = with_touches(campaign, deviation_um=campaign.touches.deviation_um + shift_um)

    comparison = compare(shifted, seed=2)

    assert changed(comparison) == {("deviation_um", "SKIP")}
    for gap in comparison.differing:
        assert gap.mean_difference.low < 0.5 < gap.mean_difference.high


def test_intervals_of_the_mean_hold_zero_as_often_as_stated(
    without_a_gap: list[Comparison],
) -> None:
    """60 campaigns × 10 cells at 95 %: fewer than 90 % come less than once in 10,000 runs."""
    gaps = [gap for comparison in without_a_gap for gap in comparison.gaps]

    held = [gap.mean_difference.low <= 0.0 <= gap.mean_difference.high for gap in gaps]

    assert np.mean(held) > 0.90


def test_missed_touches_are_a_difference() -> None:
    campaign = simulated(read_campaign(SAMPLES / "machine_no_gap"), seed=5)
    touches = campaign.touches
    gone = np.arange(len(touches)) % 20 == 0
    empty = {
        name: np.where(gone, np.nan, getattr(touches, name))
        for name in ("latch_us", "report_us", "deviation_um")
    }
    status = np.where(gone, Status.MISSED, Status.OK).astype(np.int8)

    comparison = compare(with_touches(campaign, status=status, **empty), seed=1)

    assert not comparison.agrees
    assert sum(missed.missed for missed in comparison.missed) == gone.sum()
    assert "touches missed" in as_text(comparison)


def test_the_order_of_rows_and_the_number_of_threads_do_not_matter() -> None:
    campaign = read_campaign(SAMPLES / "bench_isr_latency")
    order = np.random.default_rng(1).permutation(len(campaign.touches))
    shuffled = replace(campaign, touches=campaign.touches.select(order))

    one = as_json(compare(campaign, seed=3, jobs=1))
    two = as_json(compare(shuffled, seed=3, jobs=2))

    assert one == two


@pytest.mark.parametrize(("folder", "is_free"), [("machine_no_gap", True), ("rig_nominal", False)])
def test_means_beside_a_place_that_nobody_knows_are_said_to_hold_it(
    folder: str, is_free: bool
) -> None:
    campaign = read_campaign(SAMPLES / folder)

    comparison = compare(campaign, seed=1)

    for said in (as_text(comparison), as_html(campaign, comparison, name="c")):
        assert ("Where the surfaces lie is not known here" in said) == is_free
    assert as_json(comparison)["is_datum_free"] == is_free


def test_a_campaign_with_no_outcomes_has_nothing_to_compare() -> None:
    campaign = read_campaign(SAMPLES / "machine_no_gap")
    bare = Touches.from_columns(
        **{
            name: getattr(campaign.touches, name)
            for name in ("touch", "time_s", "path", "feed_mm_min", "approach_mm")
        }
    )

    comparison = compare(replace(campaign, touches=bare), seed=1)

    assert not comparison.agrees
    assert "nothing to compare" in as_text(comparison)


def test_distance_is_the_mean_way_a_touch_has_to_be_moved() -> None:
    rng = np.random.default_rng(1)
    reference = rng.normal(size=(400, 50))

    shifted = distance_to(quantiles_of(reference), quantiles_of(reference) + 3.0)

    assert shifted == pytest.approx(3.0)
    sample = rng.normal(2.0, 1.0, size=50)
    expected = stats.wasserstein_distance(sample, reference.ravel())
    assert distance_to(quantiles_of(reference), sample) == pytest.approx(expected, rel=0.02)


def test_adjusted_p_values_hold_the_family_wise_rate() -> None:
    """1,000 families of 30 cells at 5 %: off by 2.5 points once in 3,000 runs."""
    rng = np.random.default_rng(7)
    families = rng.gamma(2.0, size=(1000, 30))
    replicates = rng.gamma(2.0, size=(999, 30))

    alarms = [adjusted_p_values(family, replicates).min() <= 0.05 for family in families]

    assert np.mean(alarms) == pytest.approx(0.05, abs=0.025)


def test_comparison_becomes_a_page_that_needs_nothing_else() -> None:
    campaign = read_campaign(SAMPLES / "bench_isr_latency")
    few = replace(campaign, touches=campaign.touches.select(slice(80)))

    page = as_html(few, compare(few, seed=1, jobs=2), name="<bench>")

    assert "Recorded and simulated differ" in page
    assert "&lt;bench&gt; · bench campaign · 80 touches" in page
    assert page.count("<svg") >= 4
    assert "Words on this page" in page
    assert "<script" not in page
    ids = re.findall(r' id="([^"]+)"', page)
    assert len(ids) == len(set(ids))


ARCSEC_PER_MDEG = 3.6


def turned(campaign: Campaign, rows: np.ndarray) -> Campaign:
    """The same touches by a rotary axis: a degree for each millimetre."""
    old = campaign.touches
    return with_touches(
        campaign,
        axis=np.where(rows, Axis.C, old.axis),
        position_deg=np.where(rows, old.position_mm, np.nan),
        deviation_arcsec=np.where(rows, old.deviation_um * ARCSEC_PER_MDEG, np.nan),
        position_mm=np.where(rows, np.nan, old.position_mm),
        deviation_um=np.where(rows, np.nan, old.deviation_um),
    )


@pytest.fixture(scope="module")
def few() -> Campaign:
    campaign = read_campaign(SAMPLES / "machine_no_gap")
    return replace(campaign, touches=campaign.touches.select(np.arange(60)))


@pytest.fixture(scope="module")
def all_turned(few: Campaign) -> tuple[Campaign, Comparison]:
    rotary = playable(turned(few, np.full(len(few.touches), fill_value=True)))
    return rotary, compare(rotary, seed=1)


def test_rotary_axes_are_compared_in_arcsec(
    few: Campaign, all_turned: tuple[Campaign, Comparison]
) -> None:
    rotary, comparison = all_turned

    linear = compare(few, seed=1)
    assert len(comparison.gaps) == len(linear.gaps) > 0
    for of_c, of_x in zip(comparison.gaps, linear.gaps, strict=True):
        scale = ARCSEC_PER_MDEG if of_x.observable.unit == "µm" else 1.0
        assert of_c.recorded_mean == pytest.approx(scale * of_x.recorded_mean)
    for said in (as_text(comparison), as_html(rotary, comparison, name="c"), as_json(comparison)):
        assert "arcsec" in str(said)
        assert "deg/min" in str(said)
        assert "µm" not in str(said)
        assert "mm/min" not in str(said)


def test_time_at_a_rotary_axis_is_an_angle_at_its_feed(
    all_turned: tuple[Campaign, Comparison],
) -> None:
    cells = [c for c in as_json(all_turned[1])["cells"] if c["unit"] == "arcsec"]

    assert cells
    for cell in cells:
        arcsec_per_us = cell["feed_mm_min"] * 3600.0 / 60e6  # deg/min
        expected_us = cell["mean_difference"]["value"] / arcsec_per_us
        assert cell["mean_difference_at_feed"] == pytest.approx(expected_us)
        assert cell["mean_difference_at_feed_unit"] == "µs"


def test_touches_by_linear_and_rotary_axes_are_apart(few: Campaign) -> None:
    rows = np.arange(len(few.touches)) % 4 < 2

    comparison = compare(playable(turned(few, rows)), seed=1)

    assert {"µm", "arcsec"} <= {gap.observable.unit for gap in comparison.gaps}
    for cell in comparison.cells:
        assert (rows[cell.rows] == cell.observable.is_rotary).all()
