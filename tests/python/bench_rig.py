"""A bench without hardware: an injector and a controller of Python on python-can's virtual bus.

They obey the protocol as the C programs do; what goes wrong on the way can be switched on.
"""

from __future__ import annotations

import subprocess
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import can

from skiplatch.bench.protocol import (
    COMMAND_ID,
    EDGE_ID,
    LATCH_ID,
    STATUS_ID,
    Kind,
    Verdict,
    get_frame,
    put_frame,
)

CODEC = Path(__file__).parents[2] / "build" / "host" / "inject-codec"
POLL_S = 0.02
TICK_NS = 100


def c_frames(*lines: str) -> list[bytes]:
    """Let the C codec encode what the lines name."""
    done = subprocess.run(
        [CODEC], input="\n".join(lines) + "\n", capture_output=True, text=True, check=True
    )
    return [bytes.fromhex(line) for line in done.stdout.split()]


@dataclass
class Faults:
    """What goes wrong; each is a number of touches or of commands, counted from 1."""

    missed: set[int] = field(default_factory=set)
    doubled: set[int] = field(default_factory=set)
    damaged_edges: set[int] = field(default_factory=set)
    refused: dict[int, Verdict] = field(default_factory=dict)
    mute_answers: set[int] = field(default_factory=set)
    expired: set[int] = field(default_factory=set)
    restarts: set[int] = field(default_factory=set)
    is_silent: bool = False


class FakeBench(threading.Thread):
    """Injector and controller on a virtual bus; latches `delay_us` after the edge.

    Attributes:
        commands: The signals of every command that came.
        triggers: How many pulses were played.
    """

    def __init__(
        self,
        channel: str,
        faults: Faults | None = None,
        *,
        delay_us: float = 50.0,
        feed_mm_min: float = 600.0,
        resolution_um: float = 0.1,
    ) -> None:
        super().__init__(daemon=True)
        self.commands: list[dict[str, int]] = []
        self.triggers = 0
        self._faults = faults or Faults()
        self._delay_ns = int(delay_us * 1000)
        self._counts_per_ns = feed_mm_min / 60 * 1000 / resolution_um / 1e9
        self._bus = can.Bus(interface="virtual", channel=channel)
        self._codec = subprocess.Popen(
            [CODEC], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._ending = threading.Event()
        self._counter = 0
        self._sequence = 0
        self._token = 0

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self.join()
        self._bus.shutdown()
        self._codec.communicate()

    def run(self) -> None:
        """Obey until the end."""
        while not self._ending.is_set():
            message = self._bus.recv(POLL_S)
            if message is not None and message.arbitration_id == COMMAND_ID:
                self._take(bytes(message.data))

    def send(self, frame_id: int, frame: bytes) -> None:
        """Put a frame on the bus."""
        self._bus.send(can.Message(arbitration_id=frame_id, data=frame, is_extended_id=False))

    def restart(self) -> None:
        """Number latches from 0 again, as a controller does after a reset."""
        self._sequence = 0

    def latch(self, at_ns: int) -> None:
        """Report a latch, through the C codec."""
        position = int(at_ns * self._counts_per_ns) % 2**32
        self._encode(LATCH_ID, f"latch {at_ns // TICK_NS % 2**32} {position} {self._sequence} 0 8")
        self._sequence += 1

    def _take(self, frame: bytes) -> None:
        signals = get_frame(COMMAND_ID, frame)
        if signals is not None and not self._faults.is_silent:
            self._obey(signals)

    def _obey(self, signals: dict[str, int]) -> None:
        kind = Kind(signals["Kind"])
        if kind is Kind.ASK:
            self._answer_page(signals["WantedPage"])
            return
        self.commands.append(signals)
        self._counter = signals["Counter"]
        number = len(self.commands)
        verdict = self._faults.refused.get(number, Verdict.OBEYED)
        is_trigger = kind is Kind.TRIGGER and verdict is Verdict.OBEYED
        if is_trigger and signals["Token"] != self._token:
            verdict, is_trigger = Verdict.WRONG_TOKEN, False
        if kind is Kind.ARM or is_trigger:
            self._token = (self._token * 7 + 1234) % 65536 or 1
        if number not in self._faults.mute_answers:
            self._answer(verdict)
        if is_trigger:
            self._play(signals["DelayUs"])

    def _answer(self, verdict: Verdict) -> None:
        signals = {"Page": 0, "State": 1, "Verdict": verdict, "Answered": self._counter}
        self.send(
            STATUS_ID, put_frame(STATUS_ID, {**signals, "NextToken": self._token, "Counter": 0})
        )

    def _answer_page(self, page: int) -> None:
        if page == 0:
            self._answer(Verdict.OBEYED)
            return
        (frame,) = c_frames(f"status {page} 0 {page * 10} {page * 10 + 1}")
        self.send(STATUS_ID, frame)

    def _play(self, delay_us: int) -> None:
        time.sleep(delay_us / 1e6)
        self.triggers += 1
        edge_ns = time.monotonic_ns()
        if self.triggers in self._faults.restarts:
            self.restart()
        damage = self.triggers in self._faults.damaged_edges
        self._encode(EDGE_ID, f"edge {edge_ns} {self.triggers} 12 1 0", damage=damage)
        if self.triggers not in self._faults.missed:
            self.latch(edge_ns + self._delay_ns)
        if self.triggers in self._faults.doubled:
            self.latch(edge_ns + 2 * self._delay_ns)
        if self.triggers in self._faults.expired:
            self._token = 0
            self._answer(Verdict.OBEYED)

    def _encode(self, frame_id: int, line: str, *, damage: bool = False) -> None:
        assert self._codec.stdin is not None
        assert self._codec.stdout is not None
        self._codec.stdin.write(line + "\n")
        self._codec.stdin.flush()
        for _ in range(2):
            frame = bytearray.fromhex(self._codec.stdout.readline())
            frame[5] ^= damage
            self.send(frame_id, bytes(frame))


class GuardedBench(FakeBench):
    """The same with the firmware's own guard, with a key or without one.

    Attributes:
        verdicts: What the guard made of each command.
        heard: All commands as they came.
        drops: Numbers of commands that never reach the guard, counted from 1.
        mutes: Numbers of those whose answer gets lost.
    """

    def __init__(self, channel: str, key: bytes = b"") -> None:
        super().__init__(channel)
        self.verdicts: list[Verdict] = []
        self.heard: list[bytes] = []
        self.drops: set[int] = set()
        self.mutes: set[int] = set()
        self._guard = subprocess.Popen(
            [CODEC], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._tell(f"guard {key.hex()}")

    def __exit__(self, *exception: object) -> None:
        super().__exit__(*exception)
        self._guard.communicate()

    def _tell(self, line: str) -> None:
        assert self._guard.stdin is not None
        self._guard.stdin.write(line + "\n")
        self._guard.stdin.flush()

    def _take(self, frame: bytes) -> None:
        assert self._guard.stdout is not None
        self.heard.append(frame)
        number = len(self.heard)
        if number in self.drops:
            return
        self._tell(f"take {frame.hex()}")
        status = bytes.fromhex(self._guard.stdout.readline())
        if number not in self.mutes:
            self.send(STATUS_ID, status)
        answer = get_frame(STATUS_ID, status)
        command = get_frame(COMMAND_ID, frame)
        assert answer is not None
        assert command is not None
        self.verdicts.append(Verdict(answer.get("Verdict", 0)))
        if command["Kind"] == Kind.TRIGGER and self.verdicts[-1] is Verdict.OBEYED:
            self._play(command["DelayUs"])
