"""The decoders of C and of Python make the same of the same frames, and see restarts."""

import re
import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench_rig import CODEC
from skiplatch.bench.latches import (
    CRC_START,
    FIRST_LAP_FLAG,
    REPEATED_MAX,
    SEQUENCES,
    Latch,
    LatchReports,
    crc16,
)
from skiplatch.bench.protocol import COMMAND_ID, Kind, crc8, get_frame, put_command

HALVES = 2
FLAGS = st.sampled_from([0, 1, FIRST_LAP_FLAG, FIRST_LAP_FLAG | 5])


def c_lines(lines: list[str]) -> list[str]:
    """Let the C codec work, one line of answer for each line."""
    done = subprocess.run(
        [CODEC], input="\n".join(lines) + "\n", capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()


def half(latch: Latch, *, is_second: bool, crc: int) -> bytes:
    """Write half of a record, after the table in firmware/report/latch_frame.h."""
    if is_second:
        number = latch.position_counts % 2**32
        head = bytes([(latch.sequence << 1 | 1) & 0xFF, latch.sequence >> 7])
    else:
        number = latch.ticks
        head = bytes([latch.sequence << 1 & 0xFF, latch.flags])
    body = head + number.to_bytes(4, "little")
    return body + crc16(crc, body).to_bytes(2, "little")


def halves(latch: Latch) -> tuple[bytes, bytes]:
    """Write a record."""
    first = half(latch, is_second=False, crc=CRC_START)
    return first, half(latch, is_second=True, crc=int.from_bytes(first[6:], "little"))


def judged(reports: LatchReports, frames: list[bytes]) -> str:
    """Let Python decode the frames, and write it as the C codec does."""
    latches = [latch for frame in frames if (latch := reports.take(frame))]
    text = "".join(f"{x.sequence}:{x.ticks}:{x.position_counts}:{x.flags} " for x in latches)
    counts = f"lost={reports.lost} damaged={reports.damaged} repeated={reports.repeated}"
    return f"{text}{counts} unpaired={reports.unpaired} restarts={reports.restarts}"


def in_c(frames: list[bytes]) -> str:
    return f"decode {b''.join(frames).hex()}"


@pytest.mark.parametrize(
    ("before", "flags"),
    [
        (0, 0),
        pytest.param(0, FIRST_LAP_FLAG, marks=pytest.mark.nightly),
        pytest.param(FIRST_LAP_FLAG, 0, marks=pytest.mark.nightly),
        pytest.param(FIRST_LAP_FLAG, FIRST_LAP_FLAG, marks=pytest.mark.long),
    ],
)
def test_both_decoders_agree_on_every_step(before: int, flags: int) -> None:
    last = halves(Latch(7, -7, 0x2345, before))
    scripts = [
        [*last, *halves(Latch(9, -9, (0x2345 + step) % SEQUENCES, flags))]
        for step in range(SEQUENCES)
    ]

    found = c_lines([in_c(frames) for frames in scripts])

    assert found == [judged(LatchReports(), frames) for frames in scripts]
    if not flags and not before:
        first_old = SEQUENCES - REPEATED_MAX
        assert found[first_old].endswith("lost=0 damaged=0 repeated=2 unpaired=0 restarts=0")
        assert f"lost={first_old - 2} damaged=0 repeated=0" in found[first_old - 1]


@st.composite
def frames_of_a_bad_bus(draw: st.DrawFn) -> list[bytes]:
    """Halves of records with near numbers: lost, doubled, swapped and damaged."""
    frames: list[bytes] = []
    for _ in range(draw(st.integers(1, 8))):
        sequence = draw(st.sampled_from([0, 1, 2, 3, 126, 127, 128, SEQUENCES - 1]))
        latch = Latch(draw(st.integers(0, 2)), draw(st.integers(-1, 1)), sequence, draw(FLAGS))
        for frame in halves(latch):
            damaged = bytearray(frame)
            damaged[draw(st.integers(0, 7))] ^= draw(st.sampled_from([0, 0, 0, 0, 1, 0x80]))
            frames += [bytes(damaged)] * draw(st.sampled_from([0, 1, 1, 1, 2]))
    return draw(st.sampled_from([frames, frames[::-1]]))


@settings(max_examples=15, deadline=None)
@given(st.lists(frames_of_a_bad_bus(), min_size=30, max_size=30))
def test_both_decoders_agree_on_a_bad_bus(scripts: list[list[bytes]]) -> None:
    scripts = [frames for frames in scripts if frames]

    found = c_lines([in_c(frames) for frames in scripts] or ["decode 00"])

    assert not scripts or found == [judged(LatchReports(), frames) for frames in scripts]


@pytest.mark.long
def test_a_reset_at_every_sequence_number_is_seen_and_costs_no_record() -> None:
    """The first records after it may be lost as well, and the sequence may have wrapped before."""
    for flags in (0, FIRST_LAP_FLAG):
        for last in range(SEQUENCES):
            lost = min(last, last % 3)
            reports = LatchReports()
            reports._last, reports._last_crc = Latch(1, 1, last, flags), 0
            frames = [
                frame
                for number in (lost, lost + 1)
                for frame in halves(Latch(number, 5, number, FIRST_LAP_FLAG))
            ]
            latches = [latch for frame in frames if (latch := reports.take(frame))]

            assert [latch.sequence for latch in latches] == [lost, lost + 1]
            assert (reports.restarts, reports.lost, reports.repeated) == (1, lost, 0)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.binary(min_size=1, max_size=64), min_size=20, max_size=20))
def test_both_sums_are_the_same_in_both_languages(texts: list[bytes]) -> None:
    found = c_lines([f"sums {text.hex()}" for text in texts])

    assert found == [f"{crc16(CRC_START, text)} {crc8(text)}" for text in texts]


def as_python_reads(frame: bytes) -> dict[str, int] | None:
    signals = get_frame(COMMAND_ID, frame)
    return None if signals is None or signals["Kind"] not in set(Kind) else signals


def test_every_kind_and_counter_of_a_command_is_read_alike() -> None:
    signals: dict[Kind, dict[str, int]] = {
        Kind.ARM: {"ValidMs": 60_000},
        Kind.DISARM: {},
        Kind.PULSE: {"Line": 7, "Level": 1, "WidthUs": 9_999_999},
        Kind.TRAIN: {"Count": 65_535, "PeriodUs": 123_456},
        Kind.TRIGGER: {"Token": 0xBEEF, "DelayUs": 7_654_321},
        Kind.ASK: {"WantedPage": 6},
    }
    frames = [put_command(kind, n, **given) for kind, given in signals.items() for n in range(256)]
    flipped = [
        bytes(byte ^ (1 << bit % 8 if place == bit // 8 else 0) for place, byte in enumerate(frame))
        for frame in frames[::64]
        for bit in range(64)
    ]

    answers = c_lines([f"parse {frame.hex()}" for frame in frames + flipped])

    for frame, answer in zip(frames, answers, strict=False):
        found = as_python_reads(frame)
        fields = {name: int(value) for name, value in re.findall(r"(\w+)=(\d+)", answer)}
        assert found is not None
        assert {name: value for name, value in found.items() if fields.get(name) != value} in (
            {"Crc": frame[-1]},
            {"Crc": frame[-1], "Nothing": 0},
        )
    assert answers[len(frames) :] == ["damaged"] * len(flipped)
    assert [as_python_reads(frame) for frame in flipped] == [None] * len(flipped)
