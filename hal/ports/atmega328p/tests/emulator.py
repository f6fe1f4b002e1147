"""The ATmega328P in simavr: stimuli go in at exact cycles, and what the rig told comes out.

How the times are known: an edge is applied at the end of the instruction that runs at its cycle,
and the rig is told that cycle. The clock of the board starts some cycles after the chip; how many
is taken from the overflows of Timer1, not from any edge. Pulses are counted on the step pin.

simavr 1.6 omits the four cycles (0.25 µs) in which the chip enters an interrupt: the latency of
the pin-change path and of the PLC path is that much shorter here than on the chip. A captured stamp
does not depend on it, but on the chip's synchroniser, 2 1/2 to 3 1/2 cycles, which simavr does not
have either.
"""

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

RIG = Path("build/rigs/atmega328p/tests/simavr_rig")
CYCLES_PER_US = 16
TIMER_TICKS = 1 << 16
CAPTURE, PIN_CHANGE = 10, 3

Stimulus = tuple[int, str, int]
"""Cycle, kind and value: see simavr_rig.c."""


@dataclass(frozen=True, slots=True)
class Figures:
    """How long something took, in cycles."""

    calls: int
    least: int
    mean: float
    most: int


@dataclass(slots=True)
class Events:
    """What the rig tells of a run; times are cycles."""

    rises: list[tuple[int, int]] = field(default_factory=list)
    """Edges into the deflected state: when, and the pulses on the step pin by then."""
    checks: list[tuple[int, int]] = field(default_factory=list)
    """After each touch: pulses on the pin, counts of the firmware."""
    received: list[tuple[int, int]] = field(default_factory=list)
    """Bytes of the UART: when, and which."""
    pulses: list[tuple[int, int]] = field(default_factory=list)
    """Edges on the pulse inputs: when, and the channel."""
    notes: list[tuple[int, int, int]] = field(default_factory=list)
    """What the firmware has noted of them: channel, ticks of its clock, pulses lost before."""
    overflows: list[int] = field(default_factory=list)
    arounds: list[tuple[int, int]] = field(default_factory=list)
    """For each edge: when the pulses on the step pin before it and after it came."""
    ticks: list[int] = field(default_factory=list)
    """Compares of Timer1, up to the first edge."""
    bodies: dict[int, Figures] = field(default_factory=dict)
    waits: dict[int, Figures] = field(default_factory=dict)
    end: int = 0
    busy: int = 0
    lost: int = 0

    def take(self, line: str) -> None:
        """Take one line."""
        name, *texts = line.split()
        if name not in _TAKERS:  # what simavr itself says
            return
        _TAKERS[name](self, [int(text) for text in texts])

    def _rise(self, values: Sequence[int]) -> None:
        cycle, level, pulses = values
        if level:
            self.rises.append((cycle, pulses))

    def _check(self, values: Sequence[int]) -> None:
        self.checks.append((values[1], values[2]))

    def _byte(self, values: Sequence[int]) -> None:
        self.received.append((values[0], values[1]))

    def _pulse(self, values: Sequence[int]) -> None:
        self.pulses.append((values[0], values[1]))

    def _note(self, values: Sequence[int]) -> None:
        _, channel, overflows, timer, lost = values
        self.notes.append((channel, overflows * TIMER_TICKS + timer, lost))

    def _overflow(self, values: Sequence[int]) -> None:
        self.overflows.append(values[0])

    def _around(self, values: Sequence[int]) -> None:
        self.arounds.append((values[0], values[1]))

    def _tick(self, values: Sequence[int]) -> None:
        self.ticks.append(values[0])

    def _body(self, values: Sequence[int]) -> None:
        self.bodies[values[0]] = _figures(values)

    def _wait(self, values: Sequence[int]) -> None:
        self.waits[values[0]] = _figures(values)

    def _end(self, values: Sequence[int]) -> None:
        self.end, self.busy, self.lost = values

    def clock_zero(self, prescaler: int) -> int:
        """Give the cycle at which the clock read 0: no overflow is told before it comes."""
        turn = TIMER_TICKS * prescaler
        return min(cycle - (i + 1) * turn for i, cycle in enumerate(self.overflows))


_TAKERS = {
    "edge": Events._rise,
    "check": Events._check,
    "byte": Events._byte,
    "pulse": Events._pulse,
    "note": Events._note,
    "overflow": Events._overflow,
    "around": Events._around,
    "tick": Events._tick,
    "body": Events._body,
    "wait": Events._wait,
    "end": Events._end,
}


def _figures(values: Sequence[int]) -> Figures:
    _, calls, least, mean_x1000, most = values
    return Figures(calls, least, mean_x1000 / 1e3, most)


def run(program: Path, stimuli: Sequence[Stimulus], pin: str = "B0") -> Events:
    """Run a program with these stimuli, in order of their cycles, the last one ("q", 0).

    `pin` is that of the trigger line.
    """
    text = "".join(f"{cycle} {kind} {value}\n" for cycle, kind, value in stimuli)
    command = [str(RIG), str(program), pin]
    result = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise RuntimeError(f"{program}: {result.stderr.strip() or result.returncode}")
    events = Events()
    for line in result.stdout.splitlines():
        events.take(line)
    return events
