"""Every figure of the reference document's section on probing strategies, held by simulation.

Ranges are found from 100 000 touches each. Their intervals are widened here to a false-alarm rate
of 1e-6 each; the random numbers are fixed.
"""

import math
from functools import cache

import pytest

from skiplatch.campaign import InputPath, Nominal
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import LatchErrors, latch_errors
from skiplatch.latch.probing import one_touch
from skiplatch.latch.reference_figures import ReferenceFigures, as_json, as_text, play_figures
from skiplatch.latch.reference_figures.cycles import (
    FITTED_BACK_OFF_MM,
    TYPICAL_BACK_OFF_MM,
    cycle,
    cycle_s,
)
from skiplatch.latch.reference_figures.example import deviation_um
from skiplatch.latch.reference_figures.model import (
    IDEAL,
    ReferenceFigure,
    certain,
    direct_input,
    range_um,
)
from skiplatch.statistics import Interval

CONFIDENCE = 1.0 - 1e-6
EFFORT = Effort(touches=100_000, seed=1, jobs=2)


@cache
def errors_at(rig: Nominal, path: InputPath, feed: float) -> LatchErrors:
    return latch_errors(one_touch(rig, path, feed), EFFORT)


@pytest.fixture(scope="module")
def found() -> ReferenceFigures:
    return play_figures(EFFORT)


@pytest.mark.parametrize(
    ("rig", "path", "feed", "document_um"),
    [
        (IDEAL, InputPath.PLC, 3000.0, 200.0),
        (IDEAL, InputPath.PLC, 30.0, 2.0),
        (direct_input(200.0), InputPath.SKIP, 3000.0, 10.0),
        (direct_input(4.0), InputPath.SKIP, 3000.0, 0.2),
    ],
    ids=["4 ms at 3000", "4 ms at 30", "0.2 ms at 3000", "4 µs at 3000"],
)
def test_range_is_reaction_time_times_feed(
    rig: Nominal, path: InputPath, feed: float, document_um: float
) -> None:
    width = range_um(errors_at(rig, path, feed), CONFIDENCE)

    assert width.low <= document_um <= width.high
    assert width.high - width.low < 2e-3 * document_um  # so that it says something


def test_scan_period_that_is_a_thousandth_longer_would_be_noticed() -> None:
    width = range_um(errors_at(IDEAL, InputPath.PLC, 3000.0), CONFIDENCE)

    assert not width.low <= 200.2 <= width.high


@pytest.mark.parametrize(("wait_us", "expected_um"), [(3250.0, 162.5), (750.0, 37.5)])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_edge_is_measured_where_the_scan_finds_the_axis(
    wait_us: float, expected_um: float, seed: int
) -> None:
    probing = one_touch(IDEAL, InputPath.PLC, 3000.0)

    assert deviation_um(probing, wait_us, seed) == pytest.approx(expected_um, abs=1e-3)


def test_range_is_proportional_to_the_feed(found: ReferenceFigures) -> None:
    line = found.proportionality

    assert len(line.feeds_mm_min) >= 6
    assert line.slope_ms.value == pytest.approx(4.0, rel=2e-4)
    assert abs(line.intercept_um) < 1e-4 * max(line.ranges_um)
    assert line.largest_residual < 3e-4


def test_standard_uncertainty_is_range_over_root_twelve() -> None:
    found = errors_at(IDEAL, InputPath.PLC, 3000.0).position_um.standard_deviation

    # A uniform distribution's standard deviation varies by √(0.2/n), here six times that.
    assert found.value == pytest.approx(200.0 / math.sqrt(12.0), rel=6.0 * math.sqrt(0.2 / 1e5))


@pytest.mark.parametrize(
    ("feed", "back_off_mm", "document_s"),
    [(3000.0, None, 0.254), (30.0, FITTED_BACK_OFF_MM, 0.444), (30.0, TYPICAL_BACK_OFF_MM, 0.778)],
    ids=["one touch", "two touches", "two touches, typical back-off"],
)
def test_cycle_time_is_that_of_the_stated_model(
    feed: float, back_off_mm: float | None, document_s: float
) -> None:
    assert round(cycle_s(cycle(InputPath.SKIP, feed, back_off_mm)), 3) == document_s


def test_second_touch_costs_a_fifth_of_a_second_for_a_hundredth_of_the_range() -> None:
    one = cycle_s(cycle(InputPath.SKIP, 3000.0))
    two = cycle_s(cycle(InputPath.SKIP, 30.0, FITTED_BACK_OFF_MM))
    polled = latch_errors(cycle(InputPath.PLC, 30.0, TYPICAL_BACK_OFF_MM), EFFORT)
    small = range_um(polled, CONFIDENCE)
    large = range_um(errors_at(IDEAL, InputPath.PLC, 3000.0), CONFIDENCE)

    assert round(two - one, 2) == 0.19
    assert large.low / small.high <= 100.0 <= large.high / small.low


def test_fitted_back_off_is_too_short_for_the_documents_own_scan(found: ReferenceFigures) -> None:
    """A latch is later than 0.0849 of 0.2 mm in 57.55 % of cases; false-alarm rate 1e-6."""
    failing = found.remarks[1].simulated
    five_sigma = 100.0 * 5.0 * math.sqrt(0.5755 * 0.4245 / EFFORT.touches)

    assert failing.value == pytest.approx(57.55, abs=five_sigma)


def test_every_figure_of_the_document_agrees(found: ReferenceFigures) -> None:
    assert [figure.name for figure in found.figures if not figure.agrees] == []
    assert found.agree
    assert len(found.figures) == 14


def test_figure_agrees_only_within_three_intervals_and_rounding() -> None:
    def figure(document: float, last_place: float) -> ReferenceFigure:
        return ReferenceFigure(
            name="x",
            unit="µm",
            document=document,
            last_place=last_place,
            simulated=Interval(1.0, 0.9, 1.1),
        )

    assert figure(0.71, 0.0).agrees
    assert not figure(0.69, 0.0).agrees
    assert figure(0.69, 0.02).agrees
    assert figure(1.29, 0.0).agrees
    assert not figure(1.31, 0.0).agrees
    assert figure(1.31, 0.02).agrees
    assert figure(0.75, 0.0).difference == 0.25


def test_text_names_document_simulation_and_difference(found: ReferenceFigures) -> None:
    text = as_text(found)

    for column in ("document", "simulated", "95 % interval", "difference", "µm", "ms"):
        assert column in text
    assert "DIFFERS" not in text
    assert "fitted to this figure" in text
    assert "0.77791" in text


def test_json_holds_every_figure(found: ReferenceFigures) -> None:
    document = as_json(found)

    assert document["agree"] is True
    assert [entry["document"] for entry in document["figures"]][:4] == [200.0, 2.0, 10.0, 0.2]
    for entry in document["figures"]:
        assert {"name", "unit", "simulated", "difference", "agrees", "note"} <= entry.keys()
    assert len(document["remarks"]) == 3


def test_certain_figure_has_no_width() -> None:
    assert certain(2.0) == Interval(2.0, 2.0, 2.0)
