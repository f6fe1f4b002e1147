"""Latch errors through the firmware are those of the nominal chain.

Every test with chance in it fixes its seed and has a false-alarm rate of at most 1e-6.
"""

import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from skiplatch.campaign import (
    AxisNominal,
    InputNominal,
    InputPath,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    SkipNominal,
)
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import latch_errors
from skiplatch.latch.probing import CHUNK_TOUCHES, DEFAULT_RIG, Probing, on_bench, one_touch
from skiplatch.latch.reaction import Reaction, reaction_of
from skiplatch.simulator.library import SimulationError
from skiplatch.simulator.rig import Controller

FEED = 3000.0
FALSE_ALARM = 1e-6
FINE_RIG = replace(
    DEFAULT_RIG,
    skip=SkipNominal(latency_us=20.0, jitter_us=50.0, tick_us=0.001),
    axis=AxisNominal(resolution_um=0.001, accel_mm_s2=3000.0),
)


def latencies(probing: Probing, touches: int, seed: int) -> NDArray[np.float64]:
    played = probing.latched(Effort(touches, seed, jobs=2))
    return np.concatenate([(o.latch_us - o.true_edge_us)[0] for o in played])


@pytest.mark.parametrize(
    ("path", "low", "width"), [(InputPath.SKIP, 25.0, 50.0), (InputPath.PLC, 5.0, 4000.0)]
)
def test_latency_is_uniform_from_earliest_to_latest(
    path: InputPath, low: float, width: float
) -> None:
    found = latencies(one_touch(FINE_RIG, path, FEED), 20_000, seed=1)

    assert stats.kstest(found, stats.uniform(low, width).cdf).pvalue > FALSE_ALARM


def test_test_of_uniformity_notices_a_scan_that_is_two_percent_longer() -> None:
    rig = replace(FINE_RIG, plc=PlcNominal(4080.0))
    found = latencies(one_touch(rig, InputPath.PLC, FEED), 20_000, seed=1)

    assert stats.kstest(found, stats.uniform(5.0, 4000.0).cdf).pvalue < FALSE_ALARM


def test_touches_are_independent_of_each_other() -> None:
    found = latencies(one_touch(FINE_RIG, InputPath.PLC, FEED), 20_000, seed=2)

    assert stats.pearsonr(found[:-1], found[1:]).pvalue > FALSE_ALARM


@pytest.mark.parametrize("path", list(InputPath))
def test_bias_and_spread_are_those_of_the_chain(path: InputPath) -> None:
    probing = one_touch(FINE_RIG, path, FEED)
    errors = latch_errors(probing, Effort(100_000, seed=3, jobs=2))
    reaction = reaction_of(FINE_RIG, path)

    six_sigma = 6.0 * reaction.width_us / math.sqrt(12.0 * 100_000)
    assert errors.latency_us.mean.value == pytest.approx(reaction.mean_us, abs=six_sigma)
    assert errors.formula_us == pytest.approx(reaction.width_us / math.sqrt(12.0))
    assert errors.latency_us.standard_deviation.value == pytest.approx(errors.formula_us, rel=0.01)
    assert errors.latency_us.range.value == pytest.approx(reaction.width_us, rel=3e-4)


@pytest.mark.parametrize("path", list(InputPath))
def test_position_error_is_latency_times_feed(path: InputPath) -> None:
    probing = one_touch(FINE_RIG, path, FEED)
    (outcomes,) = probing.latched(Effort(1000, seed=4))
    late_us = outcomes.latch_us - outcomes.true_edge_us

    rounding_um = 0.5 * 0.001 + 0.001 * probing.feed_um_us
    np.testing.assert_allclose(
        outcomes.deviation_um, probing.feed_um_us * late_us, atol=rounding_um * 1.01
    )


def test_time_stamp_is_rounded_down_so_that_it_may_be_early() -> None:
    rig = replace(
        DEFAULT_RIG,
        input=InputNominal(0.0),
        skip=SkipNominal(latency_us=0.0, jitter_us=0.0, tick_us=8.0),
    )
    latency = latch_errors(one_touch(rig, InputPath.SKIP, FEED), Effort(20_000, 5)).latency_us

    assert latency.minimum.value == pytest.approx(-8.0, abs=0.01)
    assert latency.maximum.value == pytest.approx(0.0, abs=0.01)
    assert latency.mean.value == pytest.approx(-4.0, abs=0.1)


@pytest.mark.parametrize("feed", [1.0, 30.0, 100_000.0])
@pytest.mark.parametrize("path", list(InputPath))
def test_any_feed_is_reached_and_latched(path: InputPath, feed: float) -> None:
    errors = latch_errors(one_touch(DEFAULT_RIG, path, feed), Effort(2000, 6))
    reaction = reaction_of(DEFAULT_RIG, path)
    speed = feed / 60e3

    half_um = DEFAULT_RIG.axis.resolution_um / 2.0
    assert errors.position_um.minimum.value >= speed * reaction.earliest_us - half_um * 1.01
    assert errors.position_um.maximum.value <= speed * reaction.latest_us + half_um * 1.01


@pytest.mark.parametrize(
    ("path", "feed", "jitter_us", "bias_um", "sigma_um"),
    [
        (InputPath.SKIP, 600.0, 33.0, 0.165, math.hypot(0.33, 10.0) / math.sqrt(12.0)),
        (InputPath.PLC, 100.0, 0.0, 10.0 / 3.0, math.hypot(20.0 / 3.0, 10.0) / math.sqrt(12.0)),
    ],
)
def test_surface_lies_anywhere_between_two_counts_of_a_coarse_axis(
    path: InputPath, feed: float, jitter_us: float, bias_um: float, sigma_um: float
) -> None:
    rig = replace(
        DEFAULT_RIG,
        input=InputNominal(0.0),
        skip=SkipNominal(latency_us=0.0, jitter_us=jitter_us, tick_us=0.001),
        axis=AxisNominal(resolution_um=10.0, accel_mm_s2=3000.0),
    )
    position = latch_errors(one_touch(rig, path, feed), Effort(100_000, 7)).position_um

    assert position.mean.value == pytest.approx(bias_um, abs=6.0 * sigma_um / math.sqrt(100_000))
    assert position.standard_deviation.value == pytest.approx(sigma_um, rel=0.015)
    assert position.quantiles[0.5].value == pytest.approx(bias_um, abs=0.1)
    assert position.range.low <= position.range.value <= position.range.high


def test_result_does_not_depend_on_the_number_of_threads() -> None:
    probing = one_touch(DEFAULT_RIG, InputPath.PLC, FEED)

    assert latch_errors(probing, Effort(70_000, 8, jobs=1)) == latch_errors(
        probing, Effort(70_000, 8, jobs=3)
    )


def test_more_touches_begin_with_the_same_ones() -> None:
    probing = one_touch(DEFAULT_RIG, InputPath.SKIP, FEED)

    np.testing.assert_array_equal(
        latencies(probing, 1000, seed=9), latencies(probing, 3000, seed=9)[:1000]
    )


def test_seed_picks_the_random_numbers() -> None:
    probing = one_touch(DEFAULT_RIG, InputPath.SKIP, FEED)

    assert np.all(latencies(probing, 100, seed=1) != latencies(probing, 100, seed=2))


def test_chunks_are_numbered_through() -> None:
    probing = one_touch(FINE_RIG, InputPath.SKIP, FEED)
    found = latencies(probing, CHUNK_TOUCHES + 100, seed=10)

    assert len(found) == CHUNK_TOUCHES + 100
    assert np.all(found[:100] != found[CHUNK_TOUCHES:])


def test_memory_does_not_grow_with_the_touches() -> None:
    def peak(touches: int) -> int:
        tracemalloc.start()
        latch_errors(one_touch(DEFAULT_RIG, InputPath.SKIP, FEED), Effort(touches, 11, jobs=2))
        size = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return size

    assert peak(12 * CHUNK_TOUCHES) < 1.1 * peak(2 * CHUNK_TOUCHES)


def test_the_probe_of_a_machine_is_taken_away() -> None:
    machine = replace(
        DEFAULT_RIG,
        kind=Kind.MACHINE,
        probe=ProbeNominal(
            pretravel_um=7.0,
            lobe_um=2.0,
            lobe_phase_deg=0.0,
            repeatability_um=0.3,
            delay_us=500.0,
        ),
    )

    assert on_bench(machine) == DEFAULT_RIG


def test_travel_beyond_the_counts_of_the_axis_is_refused() -> None:
    rig = replace(DEFAULT_RIG, axis=AxisNominal(resolution_um=1e-4, accel_mm_s2=3000.0))

    with pytest.raises(SimulationError, match=r"too many counts of 0\.0001 µm"):
        one_touch(rig, InputPath.SKIP, 100_000.0)


def test_touch_that_fails_is_not_taken_for_a_measurement() -> None:
    too_short = Controller(overtravel_mm=2.0, two_touches=True, back_off_mm=0.05)
    probing = replace(one_touch(DEFAULT_RIG, InputPath.PLC, 30.0), controller=too_short)

    with pytest.raises(SimulationError, match=r"failed \d+ of 1000 touches"):
        latch_errors(probing, Effort(1000, 12))


@pytest.mark.parametrize(
    ("rig", "path", "expected"),
    [
        (DEFAULT_RIG, InputPath.SKIP, Reaction(7.0, 1.0)),
        (DEFAULT_RIG, InputPath.PLC, Reaction(5.0, 4000.0)),
    ],
)
def test_reaction_is_read_from_the_rig(rig: Nominal, path: InputPath, expected: Reaction) -> None:
    assert reaction_of(rig, path) == expected
    assert expected.latest_us == expected.earliest_us + expected.width_us
    assert expected.mean_us == expected.earliest_us + expected.width_us / 2.0
