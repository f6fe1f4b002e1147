"""Latch records out of raw CAN frames, decoded apart from the project's own codec.

The layout stands in `firmware/report/latch_frame.h`; a whole run is decoded at once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tests.bench.bus import FRAME_BYTES

FRAME_TYPE = np.dtype([("can_id", "<u4"), ("length", "u1"), ("pad", "V3"), ("data", "u1", 8)])
CRC_START = 0xFFFF
CRC_POLYNOMIAL = 0x1021
SEQUENCES = 1 << 15
TICK_NS = 100
TICKS_WRAP = 1 << 32
Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Latches:
    """Whole records in the order of their arrival."""

    sequence: Numbers
    ticks: Numbers
    position_counts: Numbers
    flags: Numbers
    damaged: int

    def __len__(self) -> int:
        return len(self.sequence)

    def times_ns(self, about_ns: int) -> Numbers:
        """Extend the ticks of the records to ns, the first being within 200 s of `about_ns`."""
        about_ticks = about_ns // TICK_NS
        half = TICKS_WRAP // 2
        first = about_ticks + ((int(self.ticks[0]) - about_ticks + half) % TICKS_WRAP) - half
        steps = np.diff(self.ticks) % TICKS_WRAP
        return TICK_NS * np.concatenate([[first], first + np.cumsum(steps)]).astype(np.int64)


def _crc_table() -> NDArray[np.uint16]:
    table = np.arange(256, dtype=np.uint32) << 8
    for _ in range(8):
        table = ((table << 1) ^ np.where(table & 0x8000, CRC_POLYNOMIAL, 0)) & 0xFFFF
    return table.astype(np.uint16)


CRC_TABLE = _crc_table()


def _crc(start: NDArray[np.uint16], data: NDArray[np.uint8]) -> NDArray[np.uint16]:
    """CRC-16/CCITT of each row, carried on from `start`."""
    crc = start.copy()
    for column in data.T:
        crc = (crc << 8) ^ CRC_TABLE[(crc >> 8) ^ column]
    return crc


def decode(raw: bytes, can_id: int) -> Latches:
    """Decode the records among the frames `raw`; a half without its other half is dropped."""
    usable = len(raw) - len(raw) % FRAME_BYTES
    frames = np.frombuffer(raw[:usable], FRAME_TYPE)
    data = frames["data"][frames["can_id"] == can_id]
    first, second = data[:-1], data[1:]
    start = np.full(len(first), CRC_START, np.uint16)
    first_crc = _crc(start, first[:, :6])
    good_first = first_crc == _number(first[:, 6:]).astype(np.uint16)
    second_crc = _crc(first_crc, second[:, :6])
    good = good_first & (second_crc == _number(second[:, 6:]).astype(np.uint16))
    a, b = first[good], second[good]
    return Latches(
        sequence=(a[:, 0].astype(np.int64) >> 1) | (b[:, 1].astype(np.int64) << 7),
        ticks=_number(a[:, 2:6]),
        position_counts=_number(b[:, 2:6]).astype(np.uint32).astype(np.int32).astype(np.int64),
        flags=a[:, 1].astype(np.int64),
        damaged=len(data) - 2 * int(np.count_nonzero(good)),
    )


def _number(columns: NDArray[np.uint8]) -> Numbers:
    """Little-endian unsigned number of each row."""
    weights = 256 ** np.arange(columns.shape[1], dtype=np.int64)
    return columns.astype(np.int64) @ weights
