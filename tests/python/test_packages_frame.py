"""The table of a latch record in PACKAGES.md, held against what the C codec writes."""

import re
from pathlib import Path

from packages_rig import run

PAGE = Path("docs/PACKAGES.md")
PROGRAM = """
#include <stdio.h>
#include "report/latch_frame.h"
int main(void)
{
    latch_record_t record = {.ticks = 0x12345678u, .position_counts = -4711, .sequence = 300u,
                             .channel = 2u, .flags = LATCH_FLAG_BOUNCED | LATCH_FLAG_FIRST_LAP};
    uint8_t frames[2][8];
    latch_frame_encode(&record, frames);
    for (int i = 0; i < 16; i++) {
        printf("%02X%c", frames[i / 8][i % 8], i % 8 == 7 ? '\\n' : ' ');
    }
    return 0;
}
"""


def example() -> tuple[bytes, bytes]:
    found = re.search(
        r"```text\n((?:[0-9A-F]{2} ?){8})\n((?:[0-9A-F]{2} ?){8})\n```",
        PAGE.read_text(encoding="utf-8"),
    )
    assert found is not None
    return bytes.fromhex(found[1]), bytes.fromhex(found[2])


def crc(data: bytes, value: int) -> int:
    """CRC-16/CCITT-FALSE as the page words it."""
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = (value << 1 ^ (0x1021 if value & 0x8000 else 0)) & 0xFFFF
    return value


def test_the_example_is_what_the_codec_writes(tmp_path: Path) -> None:
    source = tmp_path / "encode.c"
    source.write_text(PROGRAM)
    run("gcc", "-std=c99", "-Ifirmware", "-Ihal/include", source,
        "firmware/report/latch_frame.c", "firmware/report/latch_crc.c",
        "-o", tmp_path / "encode")  # fmt: skip

    assert [bytes.fromhex(line) for line in run(tmp_path / "encode").splitlines()] == list(
        example()
    )


def test_the_example_can_be_decoded_by_the_table_alone() -> None:
    first, second = example()
    sums = [int.from_bytes(frame[6:], "little") for frame in (first, second)]

    assert [first[0] & 1, second[0] & 1] == [0, 1]
    assert first[0] >> 1 == second[0] >> 1
    assert second[1] << 7 | first[0] >> 1 == 300
    assert [first[1] >> bit & 1 for bit in range(4)] == [0, 1, 0, 1]
    assert first[1] >> 4 & 7 == 2
    assert int.from_bytes(first[2:6], "little") == 0x12345678
    assert int.from_bytes(second[2:6], "little", signed=True) == -4711
    assert sums[0] == crc(first[:6], 0xFFFF)
    assert sums[1] == crc(second[:6], sums[0])
