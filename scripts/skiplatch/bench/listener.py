"""Hearing a bench's bus: edges, latches, and what the injector answers."""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import can

from skiplatch.bench.bus import arrival_ns
from skiplatch.bench.latches import Latch, LatchReports
from skiplatch.bench.latches import time_ns as latch_time_ns
from skiplatch.bench.protocol import (
    EDGE_ID,
    LATCH_ID,
    STATUS_ID,
    Edge,
    EdgeReports,
    Verdict,
    get_frame,
)
from skiplatch.errors import InputError

RUNNING = 2  # state of the injector
CHALLENGE_PAGE = 8  # where the injector has a key


@dataclass(frozen=True, slots=True)
class Arrival:
    """A latch and when its report arrived; CLOCK_MONOTONIC in ns."""

    latch: Latch
    latch_ns: int
    report_ns: int


@dataclass(frozen=True, slots=True)
class Answer:
    """What the injector said to a command."""

    verdict: Verdict
    answered: int
    token: int


class Listener:
    """Keeps what came on the bus until it is asked for.

    Attributes:
        edges: Edges that came and were not taken yet.
        latches: Latches that came and were not taken yet.
        edge_reports: Counters of damaged and unpaired edge reports.
        latch_reports: Counters of lost, damaged, repeated and unpaired latch records.
        damaged_status: Status frames with a wrong checksum.
    """

    def __init__(self, bus: can.BusABC, interface: str, latch_id: int = LATCH_ID) -> None:
        self.edges: deque[Edge] = deque()
        self.latches: deque[Arrival] = deque()
        self.edge_reports = EdgeReports()
        self.latch_reports = LatchReports()
        self.damaged_status = 0
        self._bus = bus
        self._interface = interface
        self._latch_id = latch_id
        self._answers: deque[Answer] = deque()
        self._counts: dict[str, int] = {}
        self._token = 0
        self._is_running = False
        self._challenges: deque[int] = deque()

    def listen(self, seconds: float, is_done: Callable[[], object] = lambda: False) -> bool:
        """Hear what comes until something is so; tell whether it is, or time was up."""
        end_s = time.monotonic() + seconds
        while not is_done():
            left_s = end_s - time.monotonic()
            message = self._receive(max(left_s, 0.0))
            if message is not None:
                self._take(message)
            elif left_s <= 0:
                return False
        return True

    def _receive(self, timeout_s: float) -> can.Message | None:
        try:
            return self._bus.recv(timeout_s)
        except (OSError, can.CanError) as error:
            raise self._lost(error) from error

    def _take(self, message: can.Message) -> None:
        if message.is_error_frame or message.is_remote_frame or message.is_extended_id:
            return
        data = bytes(message.data)
        if message.arbitration_id == STATUS_ID:
            self._take_status(data)
        elif message.arbitration_id == EDGE_ID:
            edge = self.edge_reports.take(data)
            if edge is not None:
                self.edges.append(edge)
        elif message.arbitration_id == self._latch_id:
            self._take_latch(data, arrival_ns(message))

    def _take_latch(self, data: bytes, report_ns: int) -> None:
        latch = self.latch_reports.take(data)
        if latch is not None:
            self.latches.append(Arrival(latch, latch_time_ns(latch, report_ns), report_ns))

    def _take_status(self, data: bytes) -> None:
        signals = get_frame(STATUS_ID, data)
        if signals is None or signals.get("Verdict", 0) >= len(Verdict):
            self.damaged_status += 1
        elif signals["Page"] == 0:
            verdict = Verdict(signals["Verdict"])
            self._answers.append(Answer(verdict, signals["Answered"], signals["NextToken"]))
            self._token = signals["NextToken"]
            self._is_running = signals["State"] == RUNNING
        elif signals["Page"] == CHALLENGE_PAGE:
            self._challenges.append(signals["Challenge"])
        else:
            about = ("Page", "Counter", "Crc")
            self._counts |= {name: n for name, n in signals.items() if name not in about}

    def _lost(self, error: Exception) -> InputError:
        message = f"the bus fails: {error}; see: ip -details link show {self._interface}"
        return InputError(self._interface, None, None, message)
