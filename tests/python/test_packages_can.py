"""The frames as others read them: python-can and cantools with the DBC, beside the C codec."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import can
import pytest

from bench_rig import c_frames
from documents import examples
from packages_rig import run
from skiplatch.bench.protocol import DBC, LATCH_ID

EXAMPLE = Path("firmware/examples/can/read_log.py")
SIGNALS = ("Ticks", "PositionCounts", "Channel", "Flags")
RECORDS = (
    # ticks, position, sequence, channel, flags: SIGNALS, and the number between
    (0x12345678, -2, 0x7ABC, 5, 0x9),
    (4294967295, 2147483647, 0, 0, 0x0),
    (0, -2147483648, 32767, 7, 0xF),
)


def frames_of_c() -> list[bytes]:
    lines = [
        f"latch {ticks} {position % 2**32} {sequence} {channel} {flags}"
        for ticks, position, sequence, channel, flags in RECORDS
    ]
    return c_frames(*lines)


@pytest.mark.parametrize("ending", ["log", "asc", "blf"])
def test_the_example_reads_what_the_c_codec_wrote(ending: str, tmp_path: Path) -> None:
    log = tmp_path / f"bus.{ending}"
    with can.Logger(log) as logger:
        for at, frame in enumerate(frames_of_c()):
            logger(
                can.Message(
                    timestamp=1.0 + at, arbitration_id=LATCH_ID, data=frame, is_extended_id=False
                )
            )

    latches = latches_read(log)

    read = [[latch[name] for name in SIGNALS] for latch in latches]
    assert read == [[record[name] for name in (0, 1, 3, 4)] for record in RECORDS]
    assert list(map(number_of, latches)) == [record[2] for record in RECORDS]


def latches_read(log: Path) -> list[dict[str, int]]:
    """Give the signals that the example prints of each latch of a log."""
    lines = run(sys.executable, EXAMPLE, DBC, log).splitlines()
    return [ast.literal_eval(line) for line in lines]


def number_of(latch: dict[str, int]) -> int:
    """Give its number as docs/INJECTION.md says it."""
    return latch["SequenceHigh"] * 128 + latch["SequenceLow"]


def test_the_page_shows_the_example_which_has_ten_lines() -> None:
    code = EXAMPLE.read_text().split('"""\n', 1)[1].strip("\n")

    lines = [line for line in code.splitlines() if line and not line.startswith("#")]
    assert len(lines) == 10
    shown = [one.text for one in examples(Path("docs/INJECTION.md")) if one.language == "python"]
    assert code in (text.strip("\n") for text in shown)


def row_of(frame: bytes, number: str = f"{LATCH_ID:03X}") -> str:
    return f"(1.000000) can0 {number}#{frame.hex().upper()}\n"


def numbers_read(log: Path, *rows: str) -> list[int]:
    """Give the sequence numbers that the example prints of such a log."""
    log.write_text("".join(rows))
    return list(map(number_of, latches_read(log)))


def test_a_second_half_alone_is_no_latch(tmp_path: Path) -> None:
    rows = [row_of(frame) for frame in frames_of_c()]

    assert numbers_read(tmp_path / "bus.log", rows[1], rows[0], rows[3]) == []


def test_halves_and_records_that_come_twice_are_one_latch(tmp_path: Path) -> None:
    first, second, *others = map(row_of, frames_of_c())
    twice = [first, first, second, second, first, second]

    assert numbers_read(tmp_path / "bus.log", *twice, *others) == [0x7ABC, 0, 32767]


def test_a_damaged_half_is_no_latch(tmp_path: Path) -> None:
    frames = frames_of_c()
    for half in (0, 1):
        for byte in range(8):
            damaged = list(frames)
            damaged[half] = bytes(x ^ (2 if at == byte else 0) for at, x in enumerate(frames[half]))
            rows = map(row_of, damaged)

            assert numbers_read(tmp_path / "bus.log", *rows) == [0, 32767], (half, byte)


def test_what_else_is_on_the_bus_is_left_alone(tmp_path: Path) -> None:
    frames = frames_of_c()
    others = [
        row_of(frames[0], f"{LATCH_ID:08X}"),  # extended
        f"(1.000000) can0 {LATCH_ID:03X}#R\n",
        row_of(frames[0][:2]),
        row_of(bytes(8), "20000080"),  # of the controller's errors
    ]
    rows = [row + other for row, other in zip(map(row_of, frames), others * 2, strict=False)]

    assert numbers_read(tmp_path / "bus.log", *rows) == [0x7ABC, 0, 32767]


def test_candump_is_decoded_by_cantools(tmp_path: Path) -> None:
    """As ``candump vcan0 | cantools decode docs/injection.dbc``."""
    shown = "".join(
        f"  vcan0  {LATCH_ID:03X}   [8]  {frame.hex(' ').upper()}\n" for frame in frames_of_c()
    )
    decoded = subprocess.run(
        [sys.executable, "-m", "cantools", "decode", "--single-line", DBC],
        input=shown, check=True, capture_output=True, text=True,
    ).stdout  # fmt: skip

    ticks = [int(value) for value in re.findall(r"\bTicks: (\d+)", decoded)]
    positions = [int(value) for value in re.findall(r"PositionCounts: (-?\d+)", decoded)]
    assert ticks == [record[0] for record in RECORDS]
    assert positions == [record[1] for record in RECORDS]


def test_the_dbc_names_every_flag() -> None:
    """What bit of Flags means what stands in latch_record.h, and in the comment of the signal."""
    header = Path("firmware/input/latch_record.h").read_text()
    comment = re.search(r'CM_ SG_ 385 Flags "([^"]*)"', DBC.read_text())

    assert comment is not None
    for name, bit in re.findall(r"#define LATCH_FLAG_(\w+)\s+(0x\w+)u", header):
        assert f"{int(bit, 16)} {name.lower().replace('_', ' ')}" in comment[1]
