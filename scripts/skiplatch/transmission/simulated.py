"""Trains of pulses from the simulated gear train: gears, screw, load, encoders, clock."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np
from numpy.typing import NDArray

from skiplatch.simulator.library import SimulationError, connection
from skiplatch.transmission.pulses import BLOCK_PULSES, Pulses


@dataclass(frozen=True, slots=True, kw_only=True)
class Gear:
    """A gear and its errors, as ways along its pitch circle."""

    teeth: float
    eccentricity_um: float = 0.0
    eccentricity_phase_deg: float = 0.0
    mesh_um: float = 0.0
    mesh_phase_deg: float = 0.0
    pitch_rms_um: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class GearStage:
    """Two gears that mesh."""

    driver: Gear
    driven: Gear
    module_mm: float = 1.0
    play_um: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """Lines on a track, its mounting, and the time jitter of its pulses."""

    lines: float
    eccentricity_um: float = 0.0
    eccentricity_phase_deg: float = 0.0
    radius_mm: float = 25.0
    jitter_ns: float = 0.0
    mark: float = 0.0
    """Width of the mark of a line, in pitches: both edges are given. 0: one pulse a line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """The whole rig; see ``host_sim/gear_train.h`` for each field."""

    stages: Sequence[GearStage]
    input: Encoder = field(default_factory=lambda: Encoder(lines=1024))
    output: Encoder = field(default_factory=lambda: Encoder(lines=3600))
    screw_lead_mm: float = 0.0
    screw_error_um: float = 0.0
    screw_error_phase_deg: float = 0.0
    screw_lead_error_ppm: float = 0.0
    stiffness_nm_per_rad: float = 0.0
    load_nm: float = 0.0
    load_ripple_nm: float = 0.0
    load_ripple_order: float = 0.0
    speed_rev_s: float = 5.0
    speed_ripple: float = 0.0
    speed_ripple_hz: float = 0.0
    turns: float = 1.0
    """Of the input, in each sense."""
    clock_hz: float = 10e6
    seed: int = 1
    both_senses: bool = False


def simulated_pulses(machine: Machine) -> Iterator[Pulses]:
    """Yield the pulses of a run in blocks.

    Raises:
        SimulationError: The machine is none that could turn.
    """
    run = GearPulses({**asdict(machine), "stage_count": len(machine.stages)})
    while True:
        channel, t_ns = run.take(BLOCK_PULSES)
        if not len(t_ns):
            return
        yield Pulses(channel, t_ns)


class GearPulses:
    """Pulses of a simulated gear train, a block at a time; ``host_sim/gear_train.h``."""

    def __init__(self, train: Mapping[str, object]) -> None:
        """Begin a run.

        Args:
            train: Fields of ``sim_gear_train_t``, structures in it as mappings; what is not given
                is 0.

        Raises:
            SimulationError: The train refuses to turn; says why.
        """
        ffi, self._library = connection()
        self._run = ffi.new("sim_gear_run_t *")
        given = ffi.new("sim_gear_train_t *", train)
        code = self._library.sim_gear_start(self._run, given)
        if code != 0:
            said = self._library.sim_gear_error(code)
            raise SimulationError(ffi.string(said).decode())

    def take(self, n: int) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """Give channels and times in ns of the next n pulses; fewer at the end of the way."""
        ffi, _ = connection()
        channels, t_ns = np.empty(n, dtype=np.uint8), np.empty(n, dtype=np.int64)
        count = self._library.sim_gear_pulses(
            self._run,
            n,
            ffi.from_buffer("uint8_t[]", channels, require_writable=True),
            ffi.from_buffer("int64_t[]", t_ns, require_writable=True),
        )
        return channels[:count], t_ns[:count]
