"""Latch records out of CAN frames: the receiving side of firmware/report/latch_frame.h."""

from dataclasses import dataclass

from skiplatch.bench.protocol import FRAME_BYTES, LATCH_ID, decoded

CRC_POLYNOMIAL = 0x1021
CRC_START = 0xFFFF
CRC_OFFSET = 6
SEQUENCES = 1 << 15
REPEATED_MAX = 255  # LATCH_REPEATED_MAX of firmware/report/latch_frame.h
TICKS = 1 << 32
TICK_NS = 100  # of the Linux port
PLC_FLAG = 0x01
FIRST_LAP_FLAG = 0x08
FRAMES_PER_RECORD = 2


@dataclass(frozen=True, slots=True)
class Latch:
    """One latched touch.

    Attributes:
        ticks: Device clock, modulo 2³².
        position_counts: Where the axis was then.
        sequence: Number of the record, modulo 2¹⁵.
        flags: LATCH_FLAG_* of firmware/input/latch_record.h.
    """

    ticks: int
    position_counts: int
    sequence: int
    flags: int

    @property
    def path(self) -> str:
        """Which input path latched."""
        return "plc" if self.flags & PLC_FLAG else "skip"


def crc16(crc: int, data: bytes) -> int:
    """Carry CRC-16/CCITT-FALSE on over the data."""
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (CRC_POLYNOMIAL if crc & 0x8000 else 0)) & 0xFFFF
    return crc


def time_ns(latch: Latch, about_ns: int) -> int:
    """Extend the ticks to ns of CLOCK_MONOTONIC, nearest to a time within 214 s of the latch."""
    about = about_ns // TICK_NS
    ahead = (latch.ticks - about + TICKS // 2) % TICKS - TICKS // 2
    return (about + ahead) * TICK_NS


class LatchReports:
    """Puts records together, of two frames each, as firmware/report/latch_frame.h says.

    Attributes:
        lost: Records that are missing in the sequence.
        damaged: Frames with a wrong checksum.
        repeated: Frames that were seen before.
        unpaired: Frames whose other half did not come.
        restarts: How often the controller has started anew.
    """

    def __init__(self) -> None:
        self.lost = 0
        self.restarts = 0
        self.damaged = 0
        self.repeated = 0
        self.unpaired = 0
        self._first: bytes | None = None
        self._last: Latch | None = None
        self._last_crc = 0

    def start_anew(self) -> None:
        """Expect a controller that was switched on just now, whose numbers start from 0."""
        self._first = None
        self._last = None

    def take(self, frame: bytes) -> Latch | None:
        """Take one frame; give the record once it is complete and new."""
        if len(frame) != FRAME_BYTES:
            self.damaged += 1
            return None
        if frame[0] & 1:
            return self._take_second(frame)
        self._take_first(frame)
        return None

    def _take_first(self, frame: bytes) -> None:
        if crc16(CRC_START, frame[:CRC_OFFSET]) != _sum_of(frame):
            self.damaged += 1
        elif frame == self._first:
            self.repeated += 1
        else:
            self.unpaired += self._first is not None
            self._first = frame

    def _take_second(self, frame: bytes) -> Latch | None:
        first = self._first
        if first is None or frame[0] != first[0] | 1:
            self._count_stray(frame)
            return None
        if crc16(_sum_of(first), frame[:CRC_OFFSET]) != _sum_of(frame):
            self.damaged += 1
            return None
        self._first = None
        return self._in_order(_joined(first, frame), _sum_of(frame))

    def _count_stray(self, frame: bytes) -> None:
        if self._last is not None and frame[0] == (self._last.sequence << 1 | 1) & 0xFF:
            self.repeated += 1
        else:
            self.unpaired += 1

    def _in_order(self, latch: Latch, crc: int) -> Latch | None:
        if self._last is not None and not self._follows(self._last, latch, crc):
            self.repeated += FRAMES_PER_RECORD
            return None
        self._last, self._last_crc = latch, crc
        return latch

    def _follows(self, last: Latch, latch: Latch, crc: int) -> bool:
        """Count what lies between two records; tell whether the second one is new."""
        if self._is_restart(last, latch, crc):
            self.restarts += 1
            self.lost += latch.sequence
            return True
        step = (latch.sequence - last.sequence) % SEQUENCES
        if self._is_repeated(last, step, crc):
            return False
        self.lost += (step - 1) % SEQUENCES
        return True

    def _is_repeated(self, last: Latch, step: int, crc: int) -> bool:
        if step == 0:
            return crc == self._last_crc
        return not last.flags & FIRST_LAP_FLAG and step >= SEQUENCES - REPEATED_MAX

    def _is_restart(self, last: Latch, latch: Latch, crc: int) -> bool:
        if not latch.flags & FIRST_LAP_FLAG:
            return False
        is_again = latch.sequence == last.sequence and crc == self._last_crc
        return not last.flags & FIRST_LAP_FLAG or (latch.sequence <= last.sequence and not is_again)


def _sum_of(frame: bytes) -> int:
    return int.from_bytes(frame[CRC_OFFSET:], "little")


def _joined(first: bytes, second: bytes) -> Latch:
    low, high = decoded(LATCH_ID, first), decoded(LATCH_ID, second)
    assert low is not None  # noqa: S101 - eight bytes of a known message always decode
    assert high is not None  # noqa: S101
    sequence = high["SequenceHigh"] << 7 | low["SequenceLow"]
    return Latch(low["Ticks"], high["PositionCounts"], sequence, low["Flags"])
