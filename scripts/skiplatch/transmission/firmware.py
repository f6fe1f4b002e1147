"""The firmware's five methods of measuring transmission error, fed with blocks of pulses."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from skiplatch.simulator.library import CData, SimulationError, connection, layout
from skiplatch.units import NS_PER_S

INPUT = 1
OUTPUT = 2
INPUT_INDEX = 3
OUTPUT_INDEX = 4
BACKWARD = 128
"""Added to a channel: the shaft turns backward."""

NAS_PER_ARCSEC = 1e9


class Method(StrEnum):
    """The five methods; see ``firmware/comp/transmission.h``."""

    SUBDIVIDED = "subdivided"
    DIRECT = "direct"
    PHASE_SUBDIVIDED = "phase-subdivided"
    PHASE_DIGITAL = "phase-digital"
    PHASE_ANALOG = "phase-analog"


class TransmissionError(Exception):
    """The set-up makes no sense, or a pulse is wrong.

    Attributes:
        pulse: Number of the pulse at fault over all blocks, from 0; None for the set-up.
    """

    def __init__(self, message: str, pulse: int | None = None) -> None:
        """Remember the pulse."""
        super().__init__(message)
        self.pulse = pulse


SETUP_FAULTS = {
    "TRANSMISSION_ERR_LINES": "lines per turn: expected 1 to 16777216",
    "TRANSMISSION_ERR_RATIO": "ratio: expected more than 0",
    "TRANSMISSION_ERR_RANGE": (
        "ratio: lines1 times the ratio over lines2 has more than 31 bits as a fraction, "
        'one train has a million times the pulses of the other, or a line is less than 0.001"'
    ),
    "TRANSMISSION_ERR_METHOD": "method: unknown",
    "TRANSMISSION_ERR_METER": "time constant of the meter: zero, or the range too large",
}
PULSE_FAULTS = {
    -1: "channel: expected 1 or 2, or 3 or 4 for an index, plus 128 for backward",
    -2: "time: earlier than the pulse before",
}


@dataclass(frozen=True, slots=True)
class Counters:
    """What was found in one train."""

    pulses: int
    """As they came."""
    missing: int
    """Lines without a pulse; they were added to the count."""
    extra: int
    """Pulses without a line; they were left out."""
    slips: int
    """Advances that fit no whole number of lines: taken as they came."""


@dataclass(frozen=True, slots=True)
class Index:
    """What is known of the index pulses of one shaft."""

    count: int
    slips: int
    """Those that were not a whole number of turns after the one before."""
    line: int
    """The line of its train that had passed at the last one."""


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Transmission error at n instants, in order of time; each array has the shape (n,)."""

    t_ns: NDArray[np.int64]
    line: NDArray[np.int64]
    """Line of the gating train, counted with its sign from its first pulse."""
    turn: NDArray[np.float64]
    """The same as turns of the output; of the mean motion where the input gates."""
    delta_arcsec: NDArray[np.float64]
    """theta2 - theta1/i at the output; its zero is where counting began."""


class Transmission:
    """One run of one method over two trains; keeps no pulses."""

    def __init__(
        self,
        lines1: int,
        lines2: int,
        ratio: Fraction,
        method: Method = Method.SUBDIVIDED,
        *,
        tick_ns: int = 1,
        phase_range: int = 0,
        meter_s: float = 0.1,
    ) -> None:
        """Begin.

        Args:
            lines1: Lines of the input's encoder, a turn.
            lines2: Lines of the output's.
            ratio: Input turns in an output turn.
            method: Which of the five.
            tick_ns: Period of the clock that subdivides.
            phase_range: How many periods of the highest common frequency the range of digital and
                analog phase comparison holds; 0: enough for four lines of the denser train.
            meter_s: Time constant of the analog meter.

        Raises:
            TransmissionError: The set-up makes no sense.
            SimulationError: The library is not built.
        """
        if ratio <= 0:
            raise TransmissionError(SETUP_FAULTS["TRANSMISSION_ERR_RATIO"])
        if tick_ns < 1:
            raise TransmissionError("period of the clock: expected at least 1 ns")
        setup = TrainsSetup(
            method="TRANSMISSION_" + method.name,
            lines1=lines1,
            lines2=lines2,
            ratio_over=ratio.numerator,
            ratio_under=ratio.denominator,
            range=phase_range,
            meter_ticks=round(meter_s * NS_PER_S / tick_ns),
            tick_ns=tick_ns,
        )
        try:
            self._trains = Trains(setup)
        except OverflowError as error:
            raise TransmissionError(f"more than 32 bits: {error}") from error
        except SimulationError as error:
            if str(error) not in SETUP_FAULTS:
                raise
            raise TransmissionError(SETUP_FAULTS[str(error)]) from error
        self._lines_per_turn = float(lines2 if self.gate_is_output else lines1 * ratio)

    @property
    def gate_is_output(self) -> bool:
        """Whether points stand at the output's lines: where it has fewer pulses than the input."""
        return self._trains.gate_is_output

    def feed(self, channel: NDArray[np.uint8], t_ns: NDArray[np.int64]) -> Points:
        """Take in a block of n pulses and give the points that are ready.

        Args:
            channel: Shape (n,): INPUT, OUTPUT, INPUT_INDEX, OUTPUT_INDEX, each perhaps plus
                BACKWARD.
            t_ns: Shape (n,), in order of time, over all blocks.

        Raises:
            TransmissionError: A channel that is none, or time running back.
        """
        points, code = self._trains.feed(channel, t_ns)
        if code != 0:
            raise TransmissionError(PULSE_FAULTS[code], self._trains.pulses)
        return Points(
            t_ns=np.ascontiguousarray(points["t_ns"]),
            line=np.ascontiguousarray(points["line"]),
            turn=points["line"] / self._lines_per_turn,
            delta_arcsec=points["delta_nas"] / NAS_PER_ARCSEC,
        )

    def counters(self, channel: int) -> Counters:
        """What was found so far in the train of INPUT or OUTPUT."""
        return Counters(**self._trains.counters(channel))

    def index(self, channel: int) -> Index:
        """What is known so far of the index of INPUT or OUTPUT."""
        return Index(**self._trains.index(channel))


@dataclass(frozen=True, slots=True)
class TrainsSetup:
    """What ``firmware/comp/transmission.h`` wants to know; see there."""

    method: str
    """An enumerator of ``transmission_method_t``."""
    lines1: int
    lines2: int
    ratio_over: int
    ratio_under: int
    range: int
    meter_ticks: int
    tick_ns: int


class Trains:
    """The firmware's transmission error, fed with blocks of pulses; ``api/trains.h``."""

    def __init__(self, setup: TrainsSetup) -> None:
        """Begin a run.

        Raises:
            SimulationError: The firmware refuses the set-up; the name of its code.
            OverflowError: A value has more than 32 bits.
        """
        ffi, self._library = connection()
        self._trains = ffi.new("sim_trains_t *")
        values = asdict(setup)
        tick_ns = values.pop("tick_ns")
        values["method"] = getattr(self._library, setup.method)
        config = ffi.new("transmission_config_t *", values)
        code = self._library.sim_trains_begin(self._trains, config, tick_ns)
        if code != 0:
            raise SimulationError(ffi.string(ffi.cast("transmission_error_t", code)))

    def feed(
        self, channel: NDArray[np.uint8], t_ns: NDArray[np.int64]
    ) -> tuple[NDArray[np.void], int]:
        """Take in a block.

        Args:
            channel: Shape (n,), see ``transmission.h``.
            t_ns: Shape (n,), never falling, not below that of the block before.

        Returns:
            Fields t_ns, line, delta_nas of the points, and a negative code ``SIM_TRAINS_ERR_...``
            if the block was taken in only as far as `pulses`, else 0.
        """
        ffi, library = connection()
        most = len(t_ns) + library.TRANSMISSION_PENDING
        points = np.empty(most, dtype=layout("sim_trains_point_t"))
        count = ffi.new("uint64_t *")
        code = library.sim_trains_feed(
            self._trains,
            ffi.from_buffer("uint8_t[]", np.ascontiguousarray(channel, dtype=np.uint8)),
            ffi.from_buffer("int64_t[]", np.ascontiguousarray(t_ns, dtype=np.int64)),
            len(t_ns),
            ffi.from_buffer("sim_trains_point_t[]", points, require_writable=True),
            count,
        )
        return points[: count[0]], int(code)

    @property
    def pulses(self) -> int:
        """How many pulses have been taken in."""
        return int(self._trains.pulses)

    @property
    def gate_is_output(self) -> bool:
        """Whether the points stand at the output's lines."""
        return bool(self._trains.core.gate_is_output)

    def counters(self, channel: int) -> dict[str, int]:
        """Give pulse_counters_t of a train."""
        return _as_dict(self._library.sim_trains_counters(self._trains, channel))

    def index(self, channel: int) -> dict[str, int]:
        """Give transmission_index_t of a shaft."""
        return _as_dict(self._library.sim_trains_index(self._trains, channel))


def _as_dict(structure: CData) -> dict[str, int]:
    return {name: int(getattr(structure, name)) for name in dir(structure)}
