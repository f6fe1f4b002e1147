"""Short pulses through the firmware: the filter swallows them, the scan overlooks them.

The random numbers are fixed, and false-alarm rates are at most 1e-6.
"""

from dataclasses import replace

import pytest
from scipy import stats

from skiplatch.campaign import InputNominal, InputPath
from skiplatch.latch.effort import Effort
from skiplatch.latch.probing import DEFAULT_RIG, one_touch
from skiplatch.latch.pulses import Pulses, default_widths_us, pulse_response

PULSES = 10_000
WIDTHS_US = (1.0, 5.0, 5.001, 40.0, 400.0, 2000.0, 3600.0, 4000.0, 9000.0)


def response(path: InputPath, filter_us: float = 5.0) -> Pulses:
    rig = replace(DEFAULT_RIG, input=InputNominal(filter_us))
    return pulse_response(one_touch(rig, path, 3000.0), WIDTHS_US, Effort(PULSES, 1, jobs=2))


@pytest.fixture(scope="module")
def skip() -> Pulses:
    return response(InputPath.SKIP)


@pytest.fixture(scope="module")
def plc() -> Pulses:
    return response(InputPath.PLC)


def test_skip_input_latches_every_pulse_longer_than_the_filter_and_none_shorter(
    skip: Pulses,
) -> None:
    for width, share in skip.triggering.items():
        assert share.value == (1.0 if width > 5.0 else 0.0), width


def test_plc_task_sees_the_share_of_the_scan_that_a_pulse_lasts(plc: Pulses) -> None:
    for width, share in plc.triggering.items():
        expected = min(width / 4000.0, 1.0) if width > 5.0 else 0.0
        seen = round(share.value * PULSES)
        assert stats.binomtest(seen, PULSES, expected).pvalue > 1e-6, width
        assert share.low <= share.value <= share.high


def test_filter_hides_short_pulses_from_the_plc_task_as_well(plc: Pulses) -> None:
    assert plc.triggering[5.0].value == 0.0
    assert response(InputPath.PLC, filter_us=0.0).triggering[40.0].value > 0.0


def test_shortest_pulse_always_seen_by_the_skip_input_is_the_filter_time(skip: Pulses) -> None:
    assert skip.shortest.pulse_us == pytest.approx(5.001)


def test_shortest_pulse_always_seen_by_the_plc_task_is_the_scan_but_for_chance(
    plc: Pulses,
) -> None:
    """The closest of n edges to a scan is an exponential share of about 1/n away from it."""
    missing = 1.0 - plc.shortest.pulse_us / 4000.0

    assert 0.0 <= missing < 14.0 / PULSES  # e^-14 is 1e-6


def test_always_says_of_how_many_and_how_certain(plc: Pulses) -> None:
    assert plc.shortest.pulses == PULSES
    assert plc.shortest.miss_bound == pytest.approx(3.0 / PULSES, rel=0.01)


def test_default_widths_are_about_the_filter_and_within_the_scan() -> None:
    assert default_widths_us(DEFAULT_RIG) == [2.5, 5, 7.5, 40, 400, 1000, 2000, 3000, 4000]
    assert default_widths_us(replace(DEFAULT_RIG, input=InputNominal(0.0)))[0] == 40.0
