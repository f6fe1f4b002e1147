"""The binding to the firmware's transmission error, beside a second writing of its definition."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from skiplatch.transmission.firmware import (
    BACKWARD,
    INPUT,
    INPUT_INDEX,
    OUTPUT,
    Method,
    Points,
    Transmission,
    TransmissionError,
)

LINES1, LINES2 = 1024, 3600
RATIO = Fraction(407, 10)
REV_PER_S = 5.0
TURN_ARCSEC = 1_296_000.0
TICK_NS = 100
COUNTING = (Method.SUBDIVIDED, Method.DIRECT, Method.PHASE_SUBDIVIDED)

Train = tuple[NDArray[np.uint8], NDArray[np.int64]]


def pulses(turns: float = 0.2, *, begin_ns: int = 0, ripple: float = 0.1) -> Train:
    """Trains of a chain with an error of two orders, at an uneven speed."""
    input_turn = np.arange(int(turns * RATIO * LINES1)) / LINES1
    output_turn = (np.arange(int(turns * LINES2)) + 0.3) / LINES2
    error = 5.0 * np.sin(2 * np.pi * output_turn) + 2.0 * np.cos(2 * np.pi * 37 * output_turn)
    at_output = float(RATIO) * (output_turn - error / TURN_ARCSEC)
    angles = np.concatenate([input_turn, at_output])
    t_s = (angles + ripple / (2 * np.pi) * np.sin(2 * np.pi * angles)) / REV_PER_S
    channel = np.repeat(np.array([INPUT, OUTPUT], np.uint8), [len(input_turn), len(output_turn)])
    t_ns = (t_s * 1e9).astype(np.int64) // TICK_NS * TICK_NS
    order = np.argsort(t_ns, kind="stable")
    return channel[order], begin_ns + t_ns[order]


def by_definition(channel: NDArray[np.uint8], t_ns: NDArray[np.int64]) -> NDArray[np.float64]:
    """theta2 - theta1/i at every output pulse, theta1 interpolated between its pulses."""
    input_ns, output_ns = t_ns[channel == INPUT], t_ns[channel == OUTPUT]
    input_line = np.interp(output_ns, input_ns, np.arange(len(input_ns)))
    output_turn = np.arange(len(output_ns)) / LINES2
    turns: NDArray[np.float64] = output_turn - input_line / LINES1 / float(RATIO)
    return turns * TURN_ARCSEC


def run(method: Method, train: Train, sizes: tuple[int, ...] = ()) -> tuple[Transmission, Points]:
    """Feed the train, in blocks that end where `sizes` say."""
    transmission = Transmission(LINES1, LINES2, RATIO, method, tick_ns=TICK_NS)
    blocks = [
        transmission.feed(channel, t_ns)
        for channel, t_ns in zip(np.split(train[0], sizes), np.split(train[1], sizes), strict=True)
    ]
    return transmission, Points(
        *(
            np.concatenate([getattr(block, name) for block in blocks])
            for name in ("t_ns", "line", "turn", "delta_arcsec")
        )
    )


def test_subdivided_counting_is_the_definition() -> None:
    channel, t_ns = pulses()

    _, points = run(Method.SUBDIVIDED, (channel, t_ns))

    expected = by_definition(channel, t_ns)[points.line]
    assert len(points.line) > 0.2 * LINES2 - 4
    np.testing.assert_allclose(points.delta_arcsec, expected, rtol=0.0, atol=1e-6)
    np.testing.assert_array_equal(points.t_ns, t_ns[channel == OUTPUT][points.line])
    np.testing.assert_allclose(points.turn, points.line / LINES2)


@pytest.mark.parametrize("method", COUNTING)
def test_neither_blocks_nor_the_begin_of_time_matter(method: Method) -> None:
    _, whole = run(method, pulses())
    train = pulses(begin_ns=1_760_000_000_123_456_700)

    _, points = run(method, train, (0, 1, 2, 100, 101, 5000))

    np.testing.assert_array_equal(points.delta_arcsec, whole.delta_arcsec)
    np.testing.assert_array_equal(points.t_ns - whole.t_ns, 1_760_000_000_123_456_700)


def test_the_input_gates_where_it_has_fewer_pulses() -> None:
    channel, t_ns = pulses()
    thinned = (channel == OUTPUT) | (np.cumsum(channel == INPUT) % 128 == 1)
    transmission = Transmission(LINES1 // 128, LINES2, RATIO, tick_ns=TICK_NS)

    points = transmission.feed(channel[thinned], t_ns[thinned])

    assert not transmission.gate_is_output
    output_ns = t_ns[channel == OUTPUT]
    output_turn = np.interp(points.t_ns, output_ns, np.arange(len(output_ns))) / LINES2
    expected = (output_turn - points.turn) * TURN_ARCSEC
    off = points.delta_arcsec - expected
    np.testing.assert_allclose(off, off[0], rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("method", COUNTING)
def test_missing_and_extra_pulses_are_counted_and_not_integrated(method: Method) -> None:
    rng = np.random.default_rng(8)
    channel, t_ns = pulses(turns=0.5)
    lost = np.sort(rng.choice(np.arange(1000, len(t_ns) - 1000, 50), 100, replace=False))
    added_ns = rng.integers(t_ns[1000], t_ns[-1000], 40)
    _, whole = run(method, (channel, t_ns))
    spoilt_ns = np.concatenate([np.delete(t_ns, lost), added_ns])
    spoilt = np.concatenate([np.delete(channel, lost), np.full(40, INPUT, np.uint8)])
    order = np.argsort(spoilt_ns, kind="stable")

    transmission, points = run(method, (spoilt[order], spoilt_ns[order]))

    assert transmission.counters(INPUT).missing == np.count_nonzero(channel[lost] == INPUT)
    assert transmission.counters(OUTPUT).missing == np.count_nonzero(channel[lost] == OUTPUT)
    assert transmission.counters(INPUT).extra == 40
    assert transmission.counters(OUTPUT).extra == 0
    same, here, there = np.intersect1d(points.line, whole.line, return_indices=True)
    assert len(same) > 0.98 * len(whole.line)
    off = points.delta_arcsec[here] - whole.delta_arcsec[there]
    line_arcsec = TURN_ARCSEC / LINES1 / float(RATIO)
    assert np.max(np.abs(off)) < (0.05 if method != Method.DIRECT else line_arcsec)


def test_a_long_rest_is_told_by_the_time_of_64_bits() -> None:
    channel, t_ns = pulses()
    half = len(t_ns) // 2
    rested = t_ns.copy()
    rested[half:] += 43 * 2**32 * TICK_NS + 700  # of the clock's rounds nothing would be seen

    transmission, points = run(Method.SUBDIVIDED, (channel, rested))

    assert transmission.counters(INPUT).missing == transmission.counters(INPUT).extra == 0
    expected = by_definition(channel, t_ns)[points.line]
    np.testing.assert_allclose(points.delta_arcsec[-500:], expected[-500:], rtol=0.0, atol=1e-6)


def test_the_way_back_is_counted_back() -> None:
    channel, t_ns = pulses()
    there_and_back = np.concatenate([channel, channel[::-1] + np.uint8(BACKWARD)])
    t_ns = np.concatenate([t_ns, 2 * t_ns[-1] + TICK_NS - t_ns[::-1]])

    _, points = run(Method.SUBDIVIDED, (there_and_back, t_ns))

    back = np.argmax(points.line) + 1
    np.testing.assert_allclose(
        points.delta_arcsec[back + 5 : back + 500],
        by_definition(*pulses())[points.line[back + 5 : back + 500]],
        rtol=0.0,
        atol=1e-6,
    )
    assert abs(int(points.line[-1])) <= 1


def test_index_pulses_are_looked_at() -> None:
    channel, t_ns = pulses()
    at_index = np.flatnonzero(channel == INPUT)[::LINES1]
    channel = np.insert(channel, at_index + 1, INPUT_INDEX)
    t_ns = np.insert(t_ns, at_index + 1, t_ns[at_index])

    transmission, _ = run(Method.SUBDIVIDED, (channel, t_ns))

    assert transmission.index(INPUT).count == len(at_index)
    assert transmission.index(INPUT).slips == 0
    assert transmission.index(INPUT).line == (len(at_index) - 1) * LINES1


@pytest.mark.parametrize(
    ("channel", "t_ns", "pulse", "what"),
    [
        ([1, 2, 5], [0, 1, 2], 2, "channel"),
        ([1, 0], [0, 1], 1, "channel"),
        ([1, 2, 1, 1], [0, 5, 4, 6], 2, "time"),
    ],
)
def test_a_bad_pulse_is_named_by_its_number(
    channel: list[int], t_ns: list[int], pulse: int, what: str
) -> None:
    transmission = Transmission(LINES1, LINES2, RATIO)
    transmission.feed(np.array([1, 2], np.uint8), np.array([-5, -4]))

    with pytest.raises(TransmissionError, match=what) as caught:
        transmission.feed(np.array(channel, np.uint8), np.array(t_ns))

    assert caught.value.pulse == 2 + pulse


@pytest.mark.parametrize(
    ("lines1", "lines2", "ratio", "what"),
    [
        (0, 3600, RATIO, "lines"),
        (-1, 3600, RATIO, "32 bits"),
        (1024, 2**24 + 1, RATIO, "lines"),
        (1024, 3600, Fraction(0), "ratio"),
        (1024, 3600, Fraction(-407, 10), "ratio"),
        (1024, 3600, Fraction(2**31 - 1, 2**31 - 19), "ratio"),
        (1024, 3600, Fraction(2**40, 3), "32 bits"),
    ],
)
def test_a_set_up_without_sense_is_refused(
    lines1: int, lines2: int, ratio: Fraction, what: str
) -> None:
    with pytest.raises(TransmissionError, match=what):
        Transmission(lines1, lines2, ratio)
