"""The injection protocol, docs/INJECTION.md: frames by the DBC file, with their checksums."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any

import cantools.database
from cantools.database import Database

from skiplatch.places import ROOT

DBC = ROOT / "docs" / "injection.dbc"

COMMAND_ID = 0x300
STATUS_ID = 0x301
EDGE_ID = 0x302
LATCH_ID = 0x181

FRAME_BYTES = 8
COUNTERS = 256
CRC_POLYNOMIAL = 0x2F
CRC_START = 0xFF

Signals = Mapping[str, int]


class Kind(IntEnum):
    """Commands to the injector."""

    ARM = 1
    DISARM = 2
    PULSE = 3
    TRAIN = 4
    TRIGGER = 5
    ASK = 6
    SEAL = 7


class Verdict(IntEnum):
    """What the injector made of a command."""

    OBEYED = 0
    DAMAGED = 1
    REPEATED = 2
    STALE = 3
    OUT_OF_RANGE = 4
    UNARMED = 5
    WRONG_TOKEN = 6
    INCOMPLETE = 7
    BUSY = 8
    FORGED = 9


@dataclass(frozen=True, slots=True)
class Edge:
    """A leading edge that the injector drove.

    Attributes:
        time_ns: CLOCK_MONOTONIC of the injector just before it drove the line; stands for the edge
            in every campaign, see docs/INJECTION.md.
        window_ns: The edge came within this time after `time_ns`.
        number: Counts edges, modulo 2¹⁶.
        level: The level that was driven.
    """

    time_ns: int
    window_ns: int
    number: int
    level: int


@cache
def database() -> Database:
    """Give docs/injection.dbc."""
    loaded = cantools.database.load_file(DBC)
    assert isinstance(loaded, Database)  # noqa: S101 - a DBC is nothing else
    return loaded


@cache
def _crc_table() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = (crc << 1 ^ (CRC_POLYNOMIAL if crc & 0x80 else 0)) & 0xFF
        table.append(crc)
    return table


def crc8(data: bytes) -> int:
    """Give the CRC-8/AUTOSAR of the data."""
    crc = CRC_START
    for byte in data:
        crc = _crc_table()[crc ^ byte]
    return crc ^ 0xFF


def _summed(frame_id: int, frame: bytes) -> bytes:
    """Give what the checksum of a frame runs over."""
    return frame_id.to_bytes(2, "little") + frame[: FRAME_BYTES - 1]


def put_frame(frame_id: int, signals: Signals) -> bytes:
    """Encode a frame and close it with its checksum; `signals` names all but that."""
    message = database().get_message_by_frame_id(frame_id)
    frame = message.encode({**signals, "Crc": 0})
    return frame[:-1] + bytes([crc8(_summed(frame_id, frame))])


def put_command(kind: Kind, counter: int, **signals: int) -> bytes:
    """Encode a command; `signals` are those of its kind in the DBC file."""
    nothing = {"Nothing": 0} if kind is Kind.DISARM else {}
    return put_frame(COMMAND_ID, {"Kind": kind, "Counter": counter, **nothing, **signals})


def get_frame(frame_id: int, frame: bytes) -> dict[str, int] | None:
    """Decode a frame of the protocol, or give None if it is damaged."""
    if len(frame) != FRAME_BYTES or frame[-1] != crc8(_summed(frame_id, frame)):
        return None
    return decoded(frame_id, frame)


def decoded(frame_id: int, frame: bytes) -> dict[str, int] | None:
    """Decode a frame without a look at its checksum; None where the DBC knows no such frame."""
    message = database().get_message_by_frame_id(frame_id)
    try:
        signals: Any = message.decode(frame, decode_choices=False)
    except (cantools.database.DecodeError, KeyError):
        return None
    return {name: int(value) for name, value in signals.items()}


class EdgeReports:
    """Puts edge reports together, of two frames each, and counts what does not fit."""

    def __init__(self) -> None:
        self.damaged = 0
        self.unpaired = 0
        self._first: bytes | None = None

    def take(self, frame: bytes) -> Edge | None:
        """Take one frame; give the edge once it is complete."""
        if len(frame) == FRAME_BYTES and frame[0] & 1:
            return self._take_second(frame)
        if get_frame(EDGE_ID, frame) is None:
            self.damaged += 1
            return None
        self.unpaired += self._first is not None
        self._first = frame
        return None

    def _take_second(self, frame: bytes) -> Edge | None:
        first, self._first = self._first, None
        if first is None:
            self.unpaired += 1
            return None
        if frame[-1] != crc8(_summed(EDGE_ID, first) + frame[:-1]):
            self.damaged += 1
            return None
        low, high = decoded(EDGE_ID, first), decoded(EDGE_ID, frame)
        if low is None or high is None:
            self.damaged += 1
            return None
        time_ns = high["TimeHigh"] << 24 | low["TimeLow"]
        return Edge(time_ns, 1 << low["WindowBits"], low["Number"], low["EdgeLevel"])
