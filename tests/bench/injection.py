"""The host's side of the injection protocol, written apart from the project's from its document.

See `docs/INJECTION.md`. The tests forge frames with it, so every field can be set.
"""

import struct
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from siphash24 import siphash24

from tests.bench.bus import Bus
from tests.bench.latches import FRAME_TYPE

COMMAND_ID, STATUS_ID, EDGE_ID = 0x300, 0x301, 0x302
ARM, DISARM, PULSE, TRAIN, TRIGGER, ASK, SEAL = range(1, 8)
IDLE, ARMED, RUNNING = range(3)
(
    OBEYED,
    DAMAGED,
    REPEATED,
    STALE,
    OUT_OF_RANGE,
    UNARMED,
    WRONG_TOKEN,
    INCOMPLETE,
    BUSY,
    FORGED,
) = range(10)
COUNTS = {
    1: ("obeyed", "edges"),
    2: ("damaged", "repeated"),
    3: ("stale", "out_of_range"),
    4: ("unarmed", "wrong_token"),
    5: ("incomplete", "busy"),
    6: ("lost_commands", "dropped_frames"),
}
CRC_POLYNOMIAL = 0x2F
CHALLENGE_PAGE = 8
ANSWER_S = 5.0
START_US = 50_000


def crc8(data: bytes) -> int:
    """CRC-8/AUTOSAR."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = ((crc << 1) ^ (CRC_POLYNOMIAL if crc & 0x80 else 0)) & 0xFF
    return crc ^ 0xFF


def frame(kind: int, figures: bytes, counter: int) -> bytes:
    """Return the eight bytes of a command with its five bytes of figures."""
    body = bytes([kind]) + figures.ljust(5, b"\0") + bytes([counter & 0xFF])
    return body + bytes([crc8(COMMAND_ID.to_bytes(2, "little") + body)])


def u16(value: int) -> bytes:
    """Two bytes, low first."""
    return value.to_bytes(2, "little")


def u24(value: int) -> bytes:
    """Three bytes, low first."""
    return value.to_bytes(3, "little")


@dataclass(frozen=True)
class Answer:
    """What the injector says to a command."""

    state: int
    verdict: int
    answered: int
    token: int


class Host:
    """Speaks to the injector over `bus`, which has to hear the status frames.

    With a key it seals what has to be.
    """

    def __init__(self, bus: Bus, key: bytes | None = None) -> None:
        self.bus = bus
        self.key = key
        self.challenge = bytes(5)
        self.number = 0  # of the next sealed command in the session
        self.figures = {PULSE: bytes(5), TRAIN: bytes(5)}
        self.counter = (self.ask().answered + 1) & 0xFF
        self.token = 0

    def status(self, page: int, timeout_s: float = ANSWER_S) -> bytes:
        """Wait for a status frame with that page."""
        end_s = time.monotonic() + timeout_s
        while (left_s := end_s - time.monotonic()) > 0:
            received = self.bus.receive(left_s)
            if received is not None and received.can_id == STATUS_ID and received.data[0] == page:
                return received.data
        raise AssertionError(f"no status frame with page {page} in {timeout_s} s")

    def answer(self) -> Answer:
        """Wait for the answer to a command."""
        _, state, verdict, answered, token = struct.unpack("<BBBBH", self.status(0)[:6])
        return Answer(state, verdict, answered, token)

    def ask(self) -> Answer:
        """Ask for the state."""
        self.bus.send(COMMAND_ID, frame(ASK, b"\0", 0))
        return self.answer()

    def counts(self) -> dict[str, int]:
        """Ask for all counts."""
        result: dict[str, int] = {}
        for page, (first, second) in COUNTS.items():
            self.bus.send(COMMAND_ID, frame(ASK, bytes([page]), 0))
            figures = struct.unpack("<HH", self.status(page)[1:5])
            result.update(zip((first, second), figures, strict=True))
        return result

    def command(self, kind: int, figures: bytes = b"") -> Answer:
        """Send the next command in order, and take the answer."""
        self.figures[kind] = figures
        if self.key is not None and kind in (ARM, TRIGGER):
            self.seal(self.key, kind, figures)
        answer = self.send(kind, figures)
        self.number += answer.verdict == OBEYED and kind in (ARM, TRIGGER)
        return answer

    def seal(self, key: bytes, kind: int, figures: bytes) -> None:
        """Send the seal of a command; of an ARM, over a challenge that is asked for."""
        shot = bytes(10)
        if kind == ARM:
            self.bus.send(COMMAND_ID, frame(ASK, bytes([CHALLENGE_PAGE]), 0))
            self.challenge, self.number = self.status(CHALLENGE_PAGE)[1:6], 0
        else:
            pulse, train = self.figures[PULSE], self.figures[TRAIN]
            shot = pulse[:2] + train[:2] + pulse[2:] + train[2:]
        sealed = self.challenge + self.number.to_bytes(4, "little")
        sealed += frame(kind, figures, self.counter + 1)[:7] + shot
        self.send(SEAL, siphash24(sealed, key=key).digest()[:5])

    def send(self, kind: int, figures: bytes) -> Answer:
        """Send a command as it is, and take the answer."""
        self.bus.send(COMMAND_ID, frame(kind, figures, self.counter))
        self.counter = (self.counter + 1) & 0xFF
        answer = self.answer()
        self.token = answer.token
        return answer

    def prepare(self, *, count: int = 1, period_us: int = 0, width_us: int = 1000) -> None:
        """Arm and set a train on line 0."""
        for kind, figures in (
            (ARM, u16(60_000)),
            (PULSE, bytes([0, 1]) + u24(width_us)),
            (TRAIN, u16(count) + u24(period_us)),
        ):
            assert self.command(kind, figures).verdict == OBEYED

    def trigger(self, delay_us: int = 0) -> Answer:
        """Play what is set."""
        return self.command(TRIGGER, u16(self.token) + u24(delay_us))

    def rest(self) -> None:
        """Wait until the train is over, and let go what was said meanwhile."""
        while self.ask().state == RUNNING:
            time.sleep(0.01)
        self.bus.drain()

    def shoot(self, *, count: int = 1, period_us: int = 0, width_us: int = 1000) -> None:
        """Arm, set a train and play it, once the answer is out of the way."""
        self.prepare(count=count, period_us=period_us, width_us=width_us)
        assert self.trigger(delay_us=START_US).verdict == OBEYED


@dataclass(frozen=True)
class Edges:
    """Edge reports in the order of their arrival."""

    number: NDArray[np.int64]
    time_ns: NDArray[np.int64]  # the middle of the window
    half_window_ns: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.number)


def edges_of(raw: bytes) -> Edges:
    """Put the edge reports among raw frames together; halves that do not fit are dropped."""
    frames = np.frombuffer(raw, FRAME_TYPE)
    data = frames["data"][frames["can_id"] == EDGE_ID].astype(np.int64)
    first, second = data[:-1], data[1:]
    fits = (first[:, 0] & 1 == 0) & (second[:, 0] & 1 == 1)
    fits &= (first[:, 6] + 1) & 0xFF == second[:, 6]
    a, b = first[fits], second[fits]
    low = a[:, 3:6] @ (256 ** np.arange(3, dtype=np.int64))
    high = b[:, 1:6] @ (256 ** np.arange(5, dtype=np.int64))
    half_window_ns = (1 << (a[:, 0] >> 2)) // 2
    return Edges(
        number=a[:, 1] | a[:, 2] << 8,
        time_ns=(high << 24) + low + half_window_ns,  # the wire tells where the window begins
        half_window_ns=half_window_ns,
    )
