"""The host's end of the bench: hears everything, and commands the injector."""

from dataclasses import dataclass
from functools import partial

import can

from skiplatch.bench.listener import CHALLENGE_PAGE, Answer, Listener
from skiplatch.bench.protocol import (
    COMMAND_ID,
    COUNTERS,
    LATCH_ID,
    STATUS_ID,
    Kind,
    Verdict,
    put_command,
)
from skiplatch.bench.seal import NO_SHOT, Sealer, shot_bytes
from skiplatch.errors import InputError
from skiplatch.units import US_PER_S

ANSWER_S = 1.0
ATTEMPTS = 3
REST_S = 2.0  # beyond the width of the pulse that plays
VALID_MS = 60_000
PAGES = 6
FORGED_PAGE = 7  # where the injector has a key


@dataclass(frozen=True, slots=True)
class Pulse:
    """What a trigger plays: one pulse on a line of the injector."""

    line: int
    level: int
    width_us: int


class Station(Listener):
    """Sends commands in order, and hears what comes of them."""

    def __init__(
        self,
        bus: can.BusABC,
        interface: str,
        latch_id: int = LATCH_ID,
        key: bytes | None = None,
    ) -> None:
        super().__init__(bus, interface, latch_id)
        self._counter = 0
        self._pulse: Pulse | None = None
        self._sealer = Sealer(key) if key is not None else None

    def connect(self) -> None:
        """Learn the injector's counter, which changes nothing.

        Raises:
            InputError: Nobody answers.
        """
        self._answers.clear()
        self._send(Kind.ASK, 0, WantedPage=0)
        if not self.listen(ANSWER_S, lambda: self._answers):
            message = (
                f"no injector answers under 0x{STATUS_ID:X}; start skiplatch-injector --can "
                f"{self._interface}, or see: candump {self._interface}"
            )
            raise InputError(self._interface, None, None, message)
        self._counter = self._answers.popleft().answered

    def trigger(self, pulse: Pulse, delay_us: int) -> None:
        """Play one pulse after a delay; arms and sets what is needed first.

        Raises:
            InputError: The injector refuses again and again, or has no key where the host has.
        """
        verdict: Verdict | None = None
        for _ in range(ATTEMPTS):
            self._await_rest(pulse)
            is_ready = self._pulse == pulse and self._token
            verdict = Verdict.OBEYED if is_ready else self._prepare(pulse)
            is_set = verdict is Verdict.OBEYED
            if is_set:
                verdict = self._play(pulse, delay_us)
            if verdict is Verdict.OBEYED:
                return
            self._pulse = None
            sent = self._counter
            self.connect()
            if is_set and verdict is None and self._counter == sent:
                return  # it was taken, only its answer was lost: never trigger twice
        raise InputError(self._interface, None, None, self._refused(verdict))

    def disarm(self) -> None:
        """Make sure that nothing more is injected; whether anybody hears it or not."""
        self._pulse = None
        self._token = 0
        self._counter = (self._counter + 1) % COUNTERS
        self._send(Kind.DISARM, self._counter)

    def counts(self) -> dict[str, int]:
        """Ask the injector for its counters by their names in the DBC; empty if it is silent."""
        self._counts = {}
        for page in range(1, (FORGED_PAGE if self._sealer else PAGES) + 1):
            known = len(self._counts)
            self._send(Kind.ASK, 0, WantedPage=page)
            if not self.listen(ANSWER_S, partial(self._has_more_counts_than, known)):
                break
        return self._counts

    def _await_rest(self, pulse: Pulse) -> None:
        """Wait for the end of the pulse before, which the injector tells."""
        rests = self.listen(pulse.width_us / US_PER_S + REST_S, lambda: not self._is_running)
        if not rests:
            self.connect()  # what it told was lost, perhaps

    def _has_more_counts_than(self, known: int) -> bool:
        return len(self._counts) > known

    def _prepare(self, pulse: Pulse) -> Verdict | None:
        """Arm and set; remember the pulse if that was obeyed."""
        steps: list[tuple[Kind, dict[str, int]]] = [
            (Kind.ARM, {"ValidMs": VALID_MS}),
            (Kind.PULSE, {"Line": pulse.line, "Level": pulse.level, "WidthUs": pulse.width_us}),
            (Kind.TRAIN, {"Count": 1, "PeriodUs": 0}),
        ]
        if self._sealer is not None and not self._begin_session(self._sealer):
            return None
        for kind, signals in steps:
            is_sealed = kind is Kind.ARM
            verdict = (
                self._sealed(kind, NO_SHOT, **signals)
                if is_sealed
                else self._command(kind, **signals)
            )
            if verdict is not Verdict.OBEYED:
                return verdict
        self._pulse = pulse
        return Verdict.OBEYED

    def _begin_session(self, sealer: Sealer) -> bool:
        """Ask for the challenge to seal over; false if no answer came.

        Raises:
            InputError: The injector knows of no challenge.
        """
        self._challenges.clear()
        self._answers.clear()
        self._send(Kind.ASK, 0, WantedPage=CHALLENGE_PAGE)
        self.listen(ANSWER_S, lambda: self._challenges or self._answers)
        if self._challenges:
            sealer.begin(self._challenges.popleft())
            return True
        if any(answer.verdict is not Verdict.OBEYED for answer in self._answers):
            message = "the injector has no key; start it with --key FILE"
            raise InputError(self._interface, None, None, message)
        return False

    def _play(self, pulse: Pulse, delay_us: int) -> Verdict | None:
        shot = shot_bytes(pulse.line, pulse.level, 1, pulse.width_us, 0)
        return self._sealed(Kind.TRIGGER, shot, Token=self._token, DelayUs=delay_us)

    def _sealed(self, kind: Kind, shot: bytes, **signals: int) -> Verdict | None:
        """Send the next command and, where there is a key, its seal before it."""
        if self._sealer is None:
            return self._command(kind, **signals)
        frame = put_command(kind, (self._counter + 2) % COUNTERS, **signals)
        verdict = self._command(Kind.SEAL, Seal=self._sealer.seal(frame, shot))
        if verdict is not None and verdict is not Verdict.OBEYED:
            return verdict
        verdict = self._command(kind, **signals)  # also where the answer to the seal was lost
        if verdict is Verdict.OBEYED:
            self._sealer.go_on()
        return verdict

    def _refused(self, verdict: Verdict | None) -> str:
        words = "no answer" if verdict is None else verdict.name.lower().replace("_", " ")
        remedy = ""
        if verdict is Verdict.FORGED:
            remedy = "; it has another key" if self._sealer else "; it has a key: give --key FILE"
        return f"the injector refuses to trigger: {words}{remedy}"

    def _command(self, kind: Kind, **signals: int) -> Verdict | None:
        """Send the next command and give the verdict on it, or None if none came."""
        self._counter = (self._counter + 1) % COUNTERS
        self._answers.clear()
        self._send(kind, self._counter, **signals)

        def mine() -> Answer | None:
            return next((a for a in self._answers if a.answered == self._counter), None)

        self.listen(ANSWER_S, mine)
        answer = mine() or (self._answers[-1] if self._answers else None)
        return None if answer is None else answer.verdict

    def _send(self, kind: Kind, counter: int, **signals: int) -> None:
        data = put_command(kind, counter, **signals)
        message = can.Message(arbitration_id=COMMAND_ID, data=data, is_extended_id=False)
        try:
            self._bus.send(message, timeout=ANSWER_S)
        except (OSError, can.CanError) as error:
            raise self._lost(error) from error
