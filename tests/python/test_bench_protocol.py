"""The DBC file, by cantools, beside the C codec; and the frames that are put together from it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench_rig import c_frames
from skiplatch.bench.latches import TICK_NS, Latch, LatchReports, crc16, time_ns
from skiplatch.bench.protocol import (
    COMMAND_ID,
    DBC,
    EDGE_ID,
    LATCH_ID,
    STATUS_ID,
    EdgeReports,
    Kind,
    Verdict,
    crc8,
    database,
    decoded,
    get_frame,
    put_command,
    put_frame,
)

DIGITS = b"123456789"
TIME_NS = 0x1122334455667788

COMMANDS = [
    (Kind.ARM, {"ValidMs": 60_000}, "60000 0 0"),
    (Kind.DISARM, {}, "0 0 0"),
    (Kind.PULSE, {"Line": 7, "Level": 1, "WidthUs": 10_000_000}, "7 10000000 1"),
    (Kind.TRAIN, {"Count": 65_535, "PeriodUs": 1_234_567}, "65535 1234567 0"),
    (Kind.TRIGGER, {"Token": 0xABCD, "DelayUs": 7_654_321}, "0xABCD 7654321 0"),
    (Kind.ASK, {"WantedPage": 8}, "8 0 0"),
    (Kind.SEAL, {"Seal": 0x0102030405}, "0x0102030405 0 0"),
]
PAGES = {
    1: ("Obeyed", "Edges"),
    2: ("Damaged", "Repeated"),
    3: ("Stale", "OutOfRange"),
    4: ("Unarmed", "WrongToken"),
    5: ("Incomplete", "Busy"),
    6: ("LostCommands", "DroppedFrames"),
}
KEY = bytes(range(16))


def test_check_values_of_both_sums_are_the_published_ones() -> None:
    assert crc8(DIGITS) == 0xDF
    assert crc16(0xFFFF, DIGITS) == 0x29B1


@pytest.mark.parametrize(("kind", "signals", "fields"), COMMANDS)
def test_command_is_the_same_in_cantools_and_in_c(
    kind: Kind, signals: dict[str, int], fields: str
) -> None:
    (frame,) = c_frames(f"command {kind:d} 200 {fields}")

    assert put_command(kind, 200, **signals) == frame
    found = get_frame(COMMAND_ID, frame)
    assert found is not None
    assert {"Kind": kind, "Counter": 200, **signals}.items() <= found.items()


def test_every_message_and_every_kind_of_the_dbc_is_compared_here() -> None:
    ids = {message.frame_id for message in database().messages}

    assert ids == {COMMAND_ID, STATUS_ID, EDGE_ID, LATCH_ID}
    assert {kind for kind, _, _ in COMMANDS} == set(Kind)


def test_names_in_the_dbc_and_in_the_document_are_those_of_the_package() -> None:
    named = database().get_message_by_name("InjectStatus").get_signal_by_name("Verdict").choices
    document = (DBC.parent / "INJECTION.md").read_text(encoding="utf-8")

    assert named is not None
    for verdict in Verdict:
        words = verdict.name.lower().replace("_", " ")
        assert str(named[verdict]) == words
        assert f"| {words} | {verdict:d} |" in document
    for kind in Kind:
        assert f"| {kind.name} | {kind:d} |" in document


def test_answer_is_the_same_in_cantools_and_in_c() -> None:
    (frame,) = c_frames("status 0 77 2 8 200 0xBEEF")
    signals = {"Page": 0, "State": 2, "Verdict": 8, "Answered": 200, "NextToken": 0xBEEF}

    assert put_frame(STATUS_ID, {**signals, "Counter": 77}) == frame
    found = get_frame(STATUS_ID, frame)
    assert found is not None
    assert signals.items() <= found.items()


@pytest.mark.parametrize("page", PAGES)
def test_page_of_counts_is_the_same_in_cantools_and_in_c(page: int) -> None:
    (frame,) = c_frames(f"status {page} 9 0x1234 0x5678")
    first, second = PAGES[page]
    signals = {"Page": page, first: 0x1234, second: 0x5678}

    assert put_frame(STATUS_ID, {**signals, "Counter": 9}) == frame
    assert get_frame(STATUS_ID, frame) == {**signals, "Counter": 9, "Crc": frame[-1]}


def test_challenge_and_forged_frames_have_their_pages() -> None:
    asked = [put_command(Kind.ASK, 0, WantedPage=page).hex() for page in (7, 8)]
    bad = put_command(Kind.SEAL, 1, Seal=1).hex(), put_command(Kind.ARM, 2, ValidMs=1).hex()
    lines = [f"guard {KEY.hex()}", *(f"take {frame}" for frame in (*bad, *asked))]
    _, refused, forged, challenge = c_frames(*lines)

    assert (get_frame(STATUS_ID, refused) or {})["Verdict"] == Verdict.FORGED
    assert put_frame(STATUS_ID, {"Page": 7, "Forged": 1, "Counter": 0}) == forged
    number = int.from_bytes(challenge[1:6], "little")
    assert put_frame(STATUS_ID, {"Page": 8, "Challenge": number, "Counter": 0}) == challenge
    assert number != 0


def test_edge_report_of_c_is_put_together() -> None:
    reports = EdgeReports()
    first, second = c_frames(f"edge {TIME_NS} 0xABCD 20 1 255")

    assert reports.take(first) is None
    edge = reports.take(second)
    assert edge is not None
    assert (edge.time_ns, edge.number, edge.window_ns, edge.level) == (TIME_NS, 0xABCD, 1 << 20, 1)
    assert (reports.damaged, reports.unpaired) == (0, 0)


def test_edge_frames_are_the_same_in_cantools_and_in_c() -> None:
    first, second = c_frames(f"edge {TIME_NS} 0xABCD 20 1 255")
    about = {"EdgeLevel": 1, "WindowBits": 20}
    low = {"Half": 0, "Number": 0xABCD, "TimeLow": TIME_NS & 0xFFFFFF, "Counter": 255}
    high = {"Half": 1, "TimeHigh": TIME_NS >> 24, "Counter": 0}

    assert put_frame(EDGE_ID, {**about, **low}) == first
    assert put_frame(EDGE_ID, {**about, **high})[:-1] == second[:-1]


def test_halves_of_different_edges_make_no_edge() -> None:
    reports = EdgeReports()
    one, two = c_frames("edge 1 1 5 1 0"), c_frames("edge 1 2 5 1 0")

    assert reports.take(one[0]) is None
    assert reports.take(two[1]) is None
    assert reports.take(two[1]) is None
    assert (reports.damaged, reports.unpaired) == (1, 1)


@given(
    st.integers(0, 2**32 - 1),
    st.integers(-(2**31), 2**31 - 1),
    st.integers(0, 2**15 - 1),
    st.integers(0, 15),
)
def test_latch_record_of_c_is_put_together(
    ticks: int, position: int, sequence: int, flags: int
) -> None:
    reports = LatchReports()
    first, second = c_frames(f"latch {ticks} {position % 2**32} {sequence} 3 {flags}")

    assert reports.take(first) is None
    assert reports.take(second) == Latch(ticks, position, sequence, flags)


def test_latch_frames_are_the_same_in_cantools_and_in_c() -> None:
    first, second = c_frames("latch 0x12345678 0xFFFFFFFE 0x7ABC 5 9")

    assert decoded(LATCH_ID, first) == {
        "Half": 0,
        "SequenceLow": 0x3C,
        "Flags": 9,
        "Channel": 5,
        "Ticks": 0x12345678,
        "RunningCrc": int.from_bytes(first[6:], "little"),
    }
    message = database().get_message_by_frame_id(LATCH_ID)
    high = {"Half": 1, "SequenceLow": 0x3C, "SequenceHigh": 0x7ABC >> 7, "PositionCounts": -2}
    crc = int.from_bytes(second[6:], "little")
    assert message.encode({**high, "RunningCrc": crc}) == second


def test_lost_repeated_damaged_and_unpaired_latches_are_counted() -> None:
    reports = LatchReports()
    one, two, five = (c_frames(f"latch 1 1 {number} 0 0") for number in (1, 2, 5))
    bad = bytes([five[0][0], five[0][1] ^ 1]) + five[0][2:]
    got = [reports.take(frame) for frame in (*one, *two, *two, bad, *five, five[1], b"short")]

    assert [latch.sequence for latch in got if latch] == [1, 2, 5]
    assert (reports.lost, reports.repeated) == (2, 3)
    assert (reports.damaged, reports.unpaired) == (2, 0)


@pytest.mark.parametrize("bit", range(64))
def test_no_frame_with_a_wrong_bit_is_read(bit: int) -> None:
    frame = bytearray(put_command(Kind.TRIGGER, 5, Token=77, DelayUs=1000))
    frame[bit // 8] ^= 1 << bit % 8

    assert get_frame(COMMAND_ID, bytes(frame)) is None


@given(st.integers(0, 2**62), st.integers(-(2**31) + 1, 2**31 - 1))
def test_ticks_are_extended_to_the_nearest_time(about_ns: int, ahead_ticks: int) -> None:
    ticks = about_ns // TICK_NS + ahead_ticks

    assert time_ns(Latch(ticks % 2**32, 0, 0, 0), about_ns) == ticks * TICK_NS
