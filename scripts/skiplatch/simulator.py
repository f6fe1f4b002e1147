"""The C simulation with the real firmware in it: the one place where Python reaches C.

The shared library is built by ``make setup``, or comes with the wheel. Its structures are read from
the C headers themselves, so that their fields stand in one place.
"""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, Self

import cffi
import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Kind, Nominal, Status, Touches
from skiplatch.campaign.nominal import KEYS
from skiplatch.former_names import PRESENT, present_names
from skiplatch.places import ROOT
from skiplatch.span import ALWAYS, Span

LIBRARY = ROOT / "build" / "host" / "libskiplatch_sim.so"
HEADERS = (
    ROOT / "firmware" / "comp" / "pulse_judge.h",
    ROOT / "firmware" / "comp" / "phase_meter.h",
    ROOT / "firmware" / "comp" / "transmission.h",
    ROOT / "host_sim" / "chain.h",
    ROOT / "host_sim" / "effects" / "description.h",
    ROOT / "host_sim" / "gear_train.h",
    ROOT / "scripts" / "skiplatch" / "diagnosis" / "law.h",
    ROOT / "host_sim" / "api" / "batch.h",
    ROOT / "firmware" / "cycle" / "overtravel.h",
    ROOT / "firmware" / "comp" / "pretravel.h",
    ROOT / "firmware" / "comp" / "pretravel_fit.h",
    ROOT / "firmware" / "comp" / "pretravel_map.h",
    ROOT / "firmware" / "comp" / "pretravel_lookup.h",
    ROOT / "firmware" / "comp" / "pretravel_grid.h",
    ROOT / "firmware" / "comp" / "kinematics.h",
    ROOT / "firmware" / "comp" / "kinematics_circle.h",
    ROOT / "host_sim" / "api" / "kinematics_fit.h",
    ROOT / "host_sim" / "five_axis.h",
    ROOT / "host_sim" / "api" / "five_axis_points.h",
    ROOT / "host_sim" / "api" / "sim_station.h",
    ROOT / "host_sim" / "api" / "five_axis_cycle.h",
    ROOT / "host_sim" / "api" / "kinematics_results.h",
    ROOT / "host_sim" / "api" / "kinematics_memory.h",
    ROOT / "host_sim" / "api" / "trains.h",
)

CData = Any
"""What cffi hands out has no static type."""

# What stands in the simulation for a condition that was not recorded.
NOT_RECORDED_IS = {
    "alpha_deg": 0.0,
    "beta_deg": 0.0,
    "sign": 1.0,
    "position_mm": 0.0,
    "rotary_deg": 0.0,
}

CALIBRATED_AT_C = 20.0
"""What counts as neither warm nor cold in the simulation."""

BESIDE_THE_CHAIN = {("probe", "calibrated_at_c"), ("axis", "min_mm"), ("axis", "max_mm")}
"""Keys of nominal.toml that are no field of sim_chain_t."""

ROOM_MM = 10.0
"""For latches that come later than the nominal chain lets expect."""

UM_PER_MM = 1000.0
S_PER_MIN = 60.0
US_PER_S = 1e6


class SimulationError(Exception):
    """The simulation refused what it was given, or is not built."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """How the firmware's cycle and the motion behind it are set up; see ``host_sim/chain.h``."""

    overtravel_mm: float
    """How far past the nominal surface the probe may be driven in search of it."""
    back_off_mm: float = 0.25
    fast_feed_mm_min: float = 3000.0
    reaction_us: float = 0.0
    """Stop request to the start of the deceleration: task, motion queue."""
    confirm_us: float = 0.0
    holdoff_us: float = 10_000.0
    settle_us: float = 1e6
    two_touches: bool = False
    image_delay_scans: int = 0
    every_scan: bool = False

    @classmethod
    def for_campaign(cls, nominal: Nominal, touches: Touches) -> Self:
        """One touch at the programmed feed, with room for the latest latch and the stop."""
        speed_mm_s = float(np.max(touches.feed_mm_min)) / S_PER_MIN
        delay_us = (
            nominal.probe.delay_us
            + nominal.input.filter_us
            + nominal.plc.scan_us
            + nominal.skip.latency_us
            + nominal.skip.jitter_us
        )
        pretravel_um = max(0.0, nominal.probe.pretravel_um) + abs(nominal.probe.lobe_um)
        scatter_um = 10.0 * nominal.probe.repeatability_um
        stop_mm = speed_mm_s**2 / (2.0 * nominal.axis.accel_mm_s2)
        latch_mm = speed_mm_s * delay_us / US_PER_S + (pretravel_um + scatter_um) / UM_PER_MM
        slow_start_mm = float(np.max(touches.approach_mm))  # an effect may make the stop as long
        return cls(overtravel_mm=ROOM_MM + latch_mm + stop_mm + slow_start_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Seat:
    """A probe by the mechanics of its three-contact seat; see ``sim_seat_t``."""

    spring_n: float
    seat_mm: float
    stylus_mm: float
    stem_n_m2: float
    """Flexural rigidity of the stylus."""
    axial_um_n: float
    evenness: float
    azimuth_deg: float = 0.0
    reseat_um: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """What came of playing n touches r times; every array has the shape (r, n).

    Where there was no such outcome a time or a length is NaN.
    """

    edge_us: FloatArray
    """What the reference instrument saw; bench only."""
    latch_us: FloatArray
    """The firmware's own time stamp of the latch."""
    report_us: FloatArray
    deviation_um: FloatArray
    overtravel_um: FloatArray
    """Latch to standstill."""
    cycle_s: FloatArray
    """The whole cycle, until the axis is back at the start."""
    true_edge_us: FloatArray
    """When the contact really closed at the connector."""
    status: NDArray[np.int32]
    """Codes of `Status`."""
    error: NDArray[np.int32]
    """Why the firmware's cycle failed: codes of ``touch_error_t``, 0 for none."""

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Latched; shape (r, n)."""
        return np.asarray(self.status == Status.OK)

    def select(self, touches: NDArray[np.intp]) -> "Outcomes":
        """Give those of some of the touches, by their numbers from 0 up."""
        return replace(self, **{f.name: getattr(self, f.name)[:, touches] for f in fields(self)})


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of an effect; `low` and `high` are the range that makes sense."""

    name: str
    unit: str
    meaning: str
    low: float
    high: float

    @property
    def when_unset(self) -> float:
        """What it is where nothing is given: 0, or the nearest admitted value."""
        return min(max(0.0, self.low), self.high)


@dataclass(frozen=True, slots=True)
class EffectDescription:
    """A row of the simulator's table of effects, ``host_sim/effects/table.c``."""

    index: int
    id: str
    stage: str
    paths: str
    """``both``, ``skip`` or ``plc``."""
    physics: str
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True, slots=True)
class Effect:
    """An effect switched on; parameters that are not given are as `Parameter.when_unset` says.

    Former names of parameters become the present ones.
    """

    id: str
    parameters: Mapping[str, float]
    span: Span = ALWAYS

    def __post_init__(self) -> None:
        if self.parameters.keys() & PRESENT.keys():
            object.__setattr__(self, "parameters", present_names(self.parameters))


@dataclass(frozen=True, slots=True)
class _Binding:
    """The library and the layout of its structures in numpy's terms."""

    ffi: CData
    library: CData
    touch: np.dtype[np.void]
    outcome: np.dtype[np.void]
    law: np.dtype[np.void]
    extra: np.dtype[np.void]
    trains_point: np.dtype[np.void]


def _declarations(header: Path) -> str:
    """Give what cffi understands of a header: no comments, nothing of the preprocessor."""
    text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.DOTALL)
    text = re.sub(r"#ifdef __cplusplus\n.*?#endif\n", "", text, flags=re.DOTALL)
    return "\n".join(line for line in text.splitlines() if not line.startswith("#"))


def layout(ffi: CData, name: str) -> np.dtype[np.void]:
    """Give the numpy type of an array of structures, aligned as the compiler does it.

    Raises:
        SimulationError: numpy lays such a structure out differently.
    """
    codes = {
        "double": "f8",
        "int32_t": "i4",
        "int64_t": "i8",
        "uint32_t": "u4",
        "uint64_t": "u8",
    }
    members = ffi.typeof(name).fields
    layout = np.dtype([(member, codes[f.type.cname]) for member, f in members], align=True)
    if layout.itemsize != ffi.sizeof(name):
        raise SimulationError(f"{name}: numpy lays it out differently from the C compiler")
    return layout


@cache
def _binding() -> _Binding:
    if not LIBRARY.exists():
        raise SimulationError(f"{LIBRARY}: not built; run 'make setup'")
    ffi: CData = cffi.FFI()
    for header in HEADERS:
        ffi.cdef(_declarations(header))
    return _Binding(
        ffi=ffi,
        library=ffi.dlopen(os.fspath(LIBRARY)),
        touch=layout(ffi, "sim_touch_t"),
        outcome=layout(ffi, "sim_outcome_t"),
        law=layout(ffi, "sim_law_t"),
        extra=layout(ffi, "sim_extra_t"),
        trains_point=layout(ffi, "sim_trains_point_t"),
    )


@dataclass(frozen=True, slots=True, eq=False)
class FilledRig:
    """A sim_rig_t, and what it points at: it is valid as long as these are kept."""

    structure: CData
    chain: CData
    controller: CData
    settings: CData


def filled_rig(
    nominal: Nominal,
    controller: Controller,
    switched_on: Sequence[Effect] = (),
    *,
    seed: int = 0,
    replicate: int = 0,
    seat: Seat | None = None,
) -> FilledRig:
    """Give what all functions of the library that play a rig take."""
    binding = _binding()
    effects_on = with_believed(nominal, switched_on)
    chain = _chain(binding, nominal, seat)
    set_up = _controller(binding, controller)
    settings = _settings(binding, effects_on)
    values = {
        "chain": chain,
        "controller": set_up,
        "settings": settings,
        "settings_count": len(effects_on),
        "seed": seed,
        "replicate": replicate,
    }
    return FilledRig(binding.ffi.new("sim_rig_t *", values), chain, set_up, settings)


def connection() -> tuple[CData, CData]:
    """Give cffi's interface and the library, for modules that bind a part of it.

    Raises:
        SimulationError: The library is not built.
    """
    binding = _binding()
    return binding.ffi, binding.library


def _chain(binding: _Binding, nominal: Nominal, seat: Seat | None) -> CData:
    """Fill sim_chain_t: a field is named after its key, or after section and key."""
    chain = binding.ffi.new("sim_chain_t *")
    names = {name for name, _ in binding.ffi.typeof("sim_chain_t").fields}
    for section, key in KEYS.keys() - BESIDE_THE_CHAIN:
        long_name = f"{section}_{key}"
        setattr(chain, long_name if long_name in names else key, nominal.number(section, key))
    chain.is_machine = nominal.kind == Kind.MACHINE
    chain.is_signed = nominal.version > 1
    if seat is not None:
        chain.seat = asdict(seat)
    return chain


@cache
def effects() -> Mapping[str, EffectDescription]:
    """Give the table of all effects by id, in the order of the chain."""
    binding = _binding()
    rows: dict[str, EffectDescription] = {}
    while row := binding.library.sim_effect_describe(len(rows)):
        described = _description(binding, len(rows), row)
        rows[described.id] = described
    return rows


def _description(binding: _Binding, index: int, row: CData) -> EffectDescription:
    def text(value: CData) -> str:
        return str(binding.ffi.string(value).decode())

    parameters = tuple(
        Parameter(text(p.name), text(p.unit), text(p.meaning), p.low, p.high)
        for p in row.parameters
        if p.name
    )
    return EffectDescription(
        index, text(row.id), text(row.stage), text(row.paths), text(row.physics), parameters
    )


def _refuse_unknown(effect: Effect) -> None:
    if effect.id not in effects():
        raise SimulationError(f"{effect.id}: no such effect")
    known = {parameter.name for parameter in effects()[effect.id].parameters}
    for name in effect.parameters.keys() - known:
        raise SimulationError(f"{effect.id}: no parameter {name}")


def _settings(binding: _Binding, switched_on: Sequence[Effect]) -> CData:
    """Fill an array of sim_setting_t, in the order of the table."""
    table = effects()
    for effect in switched_on:
        _refuse_unknown(effect)
    settings = binding.ffi.new("sim_setting_t[]", len(switched_on))
    ordered = sorted(switched_on, key=lambda effect: table[effect.id].index)
    for setting, effect in zip(settings, ordered, strict=True):
        setting.effect = table[effect.id].index
        for i, parameter in enumerate(table[effect.id].parameters):
            setting.parameters[i] = effect.parameters.get(parameter.name, parameter.when_unset)
    return settings


def _controller(binding: _Binding, controller: Controller) -> CData:
    return binding.ffi.new("sim_controller_t *", asdict(controller))


def with_believed(nominal: Nominal, switched_on: Sequence[Effect]) -> tuple[Effect, ...]:
    """Give the effects that the rig is believed to have, and those switched on."""
    believed = (Effect(effect.id, effect.values) for effect in nominal.believed_effects)
    return (*believed, *switched_on)


def _touches(
    binding: _Binding, nominal: Nominal, touches: Touches, pulse_us: float
) -> NDArray[np.void]:
    rows = np.zeros(len(touches), dtype=binding.touch)
    for name in ("time_s", "feed_mm_min", "approach_mm", "touch"):
        rows[name] = getattr(touches, name)
    for name, value in NOT_RECORDED_IS.items():
        rows[name] = np.nan_to_num(getattr(touches, name), nan=value)
    rows["path"] = np.where(
        touches.path == InputPath.PLC, binding.library.SIM_PATH_PLC, binding.library.SIM_PATH_SKIP
    )
    rows["axis"] = np.maximum(touches.axis, 0)  # what was not recorded counts as X
    at_c = nominal.probe.calibrated_at_c
    rows["temp_c"] = np.nan_to_num(touches.temp_c, nan=at_c) + (CALIBRATED_AT_C - at_c)
    rows["pulse_us"] = pulse_us
    return rows


def play(
    nominal: Nominal,
    controller: Controller,
    touches: Touches,
    *,
    seed: int,
    replicates: int = 1,
    first_replicate: int = 0,
    jobs: int = 1,
    pulse_us: float = 0.0,
    switched_on: Sequence[Effect] = (),
    seat: Seat | None = None,
) -> Outcomes:
    """Play the conditions of n touches through the firmware, `replicates` times.

    The result depends on everything but `jobs`, the number of threads. A replicate is a rig
    switched on anew: its scan phase and all its noise are its own.

    Args:
        nominal: The rig.
        controller: The set-up of its controller.
        touches: The conditions; outcomes in it are not looked at.
        seed: Picks the random numbers, together with the number of the replicate and of the touch.
        replicates: How often to play.
        first_replicate: Number of the first replicate.
        jobs: Threads to play on.
        pulse_us: Contact opens again after this time; 0 means when the axis retreats.
        switched_on: Effects that the nominal chain knows nothing of; one that begins or ends is
            played as if it had always been there, and taken where it is.
        seat: The mechanics of the probe, in place of its calibrated mean and lobes.

    Raises:
        SimulationError: A value is out of range, or the library is not built.
    """
    alone = partial(
        _play,
        nominal,
        controller,
        touches,
        seed=seed,
        replicates=replicates,
        first_replicate=first_replicate,
        jobs=jobs,
        pulse_us=pulse_us,
        seat=seat,
    )
    if all(effect.span == ALWAYS for effect in switched_on):
        return alone(switched_on=switched_on)
    held = np.array([effect.span.holds(touches.touch) for effect in switched_on])
    sets, which = np.unique(held, axis=1, return_inverse=True)
    plays = [
        alone(switched_on=[e for e, is_there in zip(switched_on, there, strict=True) if is_there])
        for there in sets.T
    ]
    return spliced(plays, which.ravel())


def spliced(plays: Sequence[Outcomes], which: NDArray[np.intp]) -> Outcomes:
    """Take each touch from one of several plays, by its number of shape (n,)."""
    touches = np.arange(len(which))
    return Outcomes(
        *(
            np.ascontiguousarray(
                np.stack([getattr(one, f.name) for one in plays])[which, :, touches].T
            )
            for f in fields(Outcomes)
        )
    )


def _play(
    nominal: Nominal,
    controller: Controller,
    touches: Touches,
    *,
    seed: int,
    replicates: int,
    first_replicate: int,
    jobs: int,
    pulse_us: float,
    switched_on: Sequence[Effect],
    seat: Seat | None,
) -> Outcomes:
    binding = _binding()
    order = np.argsort(touches.time_s, kind="stable")  # effects remember what came before
    rows = _touches(binding, nominal, touches, pulse_us)[order]
    rig = filled_rig(
        nominal, controller, switched_on, seed=seed, replicate=first_replicate, seat=seat
    )
    raw = np.empty((replicates, len(touches)), dtype=binding.outcome)
    ffi = binding.ffi
    code = binding.library.sim_play(
        rig.structure,
        ffi.from_buffer("sim_touch_t[]", rows),
        len(touches),
        replicates,
        jobs,
        ffi.from_buffer("sim_outcome_t[]", raw, require_writable=True),
    )
    if code != binding.library.SIM_PLAY_OK:
        raise SimulationError(ffi.string(binding.library.sim_play_error(code)).decode())
    back = np.argsort(order)
    return Outcomes(*(np.ascontiguousarray(raw[field.name][:, back]) for field in fields(Outcomes)))


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """Residuals laid out for C with the law of each; see ``diagnosis/law.h``.

    Attributes:
        values: Shape (n,).
        laws: Shape (n,).
        extras: Shape (e, n).
        reach: Width over which a contaminated one may lie anywhere; shape (n,).
        resolution: Scatter below which nothing is resolved.
    """

    values: FloatArray
    laws: NDArray[np.void]
    extras: NDArray[np.void]
    reach: FloatArray
    resolution: float

    @classmethod
    def of(
        cls,
        values: FloatArray,
        law: object,
        extras: Sequence[object],
        reach: float,
        resolution: float,
    ) -> Self:
        """Lay them out.

        Args:
            values: Shape (n,).
            law: Has an attribute for each field of sim_law_t: arrays of shape (n,), or numbers.
            extras: The same, each for the fields of sim_extra_t.
            reach: Width over which a contaminated one may lie anywhere.
            resolution: Scatter below which nothing is resolved.
        """
        binding, n = _binding(), len(values)
        laws = np.empty(n, dtype=binding.law)
        _fill(laws, law)
        more = np.empty((len(extras), n), dtype=binding.extra)
        for row, extra in zip(more, extras, strict=True):
            _fill(row, extra)
        return cls(
            np.ascontiguousarray(values, dtype=np.float64),
            laws,
            more,
            np.full(n, reach),
            resolution,
        )

    @classmethod
    def together(cls, several: Sequence[Self]) -> Self:
        """Put residuals end to end; who has fewer extras has some of no share."""
        if len(several) == 1:
            return several[0]
        ends = np.cumsum([0, *(len(one.values) for one in several)])
        laws = np.empty(ends[-1], several[0].laws.dtype)
        extras = np.zeros((max(len(one.extras) for one in several), ends[-1]), _binding().extra)
        for begin, end, one in zip(ends[:-1], ends[1:], several, strict=True):
            laws[begin:end] = one.laws
            extras[: len(one.extras), begin:end] = one.extras
        return cls(
            np.concatenate([one.values for one in several]),
            laws,
            extras,
            np.concatenate([one.reach for one in several]),
            several[0].resolution,
        )

    def _laid_out(self) -> tuple[CData, object]:
        """Give the structure for C, and what has to live as long."""
        ffi = _binding().ffi
        parts = (
            ffi.from_buffer("double[]", self.values),
            ffi.from_buffer("sim_law_t[]", self.laws),
            ffi.from_buffer("sim_extra_t[]", self.extras),
            ffi.from_buffer("double[]", self.reach),
        )
        counts = (len(self.values), len(self.extras), self.resolution)
        return ffi.new("sim_residuals_t *", (*parts, *counts)), parts

    def log_densities(self) -> FloatArray:
        """Logarithm of the density of each; shape (n,)."""
        binding, found = _binding(), np.empty(len(self.values))
        laid_out, _kept = self._laid_out()
        binding.library.sim_law_log_density(
            laid_out, binding.ffi.from_buffer("double[]", found, require_writable=True)
        )
        return found

    def at_best_datum(
        self,
        per_length: FloatArray,
        groups: NDArray[np.intp],
        guesses: FloatArray,
        steps: FloatArray,
        u: float | None,
    ) -> tuple[FloatArray, FloatArray]:
        """Find the length that each group of residuals is off by; see ``sim_law_at_best_datum``.

        Args:
            per_length: By how much a unit of it moves each residual; shape (n,).
            groups: Numbers of the groups; shape (n,).
            guesses: Where the search begins, beside 0; shape (g,).
            steps: Its steps; shape (g,).
            u: Standard uncertainty about 0; None if it may be anything.

        Returns:
            The lengths, shape (g,), and the logarithms of the densities there, shape (n,).
        """
        binding, found, logs = _binding(), np.zeros(len(guesses)), np.empty(len(self.values))
        ffi = binding.ffi
        kept = (
            ffi.from_buffer("double[]", np.ascontiguousarray(per_length, dtype=np.float64)),
            ffi.from_buffer("uint32_t[]", np.ascontiguousarray(groups, dtype=np.uint32)),
            ffi.from_buffer("double[]", np.ascontiguousarray(guesses, dtype=np.float64)),
            ffi.from_buffer("double[]", np.ascontiguousarray(steps, dtype=np.float64)),
        )
        laid_out, _alive = self._laid_out()
        code = binding.library.sim_law_at_best_datum(
            laid_out,
            ffi.new("sim_datum_t *", (*kept, len(guesses), u or 0.0)),
            ffi.from_buffer("double[]", found, require_writable=True),
            ffi.from_buffer("double[]", logs, require_writable=True),
        )
        if code:
            raise MemoryError
        return found, logs


def _fill(rows: NDArray[np.void], source: object) -> None:
    """Give structures the values of the attributes that are named like their fields."""
    for name in rows.dtype.fields or ():
        rows[name] = getattr(source, name)


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
        self._binding = _binding()
        ffi = self._binding.ffi
        self._trains = ffi.new("sim_trains_t *")
        values = asdict(setup)
        tick_ns = values.pop("tick_ns")
        values["method"] = getattr(self._binding.library, setup.method)
        config = ffi.new("transmission_config_t *", values)
        code = self._binding.library.sim_trains_begin(self._trains, config, tick_ns)
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
        ffi, library = self._binding.ffi, self._binding.library
        points = np.empty(len(t_ns) + library.TRANSMISSION_PENDING, self._binding.trains_point)
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
        return _as_dict(self._binding.library.sim_trains_counters(self._trains, channel))

    def index(self, channel: int) -> dict[str, int]:
        """Give transmission_index_t of a shaft."""
        return _as_dict(self._binding.library.sim_trains_index(self._trains, channel))


def _as_dict(structure: CData) -> dict[str, int]:
    return {name: int(getattr(structure, name)) for name in dir(structure)}


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
        self._binding = _binding()
        self._run = self._binding.ffi.new("sim_gear_run_t *")
        given = self._binding.ffi.new("sim_gear_train_t *", train)
        code = self._binding.library.sim_gear_start(self._run, given)
        if code != 0:
            said = self._binding.library.sim_gear_error(code)
            raise SimulationError(self._binding.ffi.string(said).decode())

    def take(self, n: int) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """Give channels and times in ns of the next n pulses; fewer at the end of the way."""
        ffi = self._binding.ffi
        channels, t_ns = np.empty(n, dtype=np.uint8), np.empty(n, dtype=np.int64)
        count = self._binding.library.sim_gear_pulses(
            self._run,
            n,
            ffi.from_buffer("uint8_t[]", channels, require_writable=True),
            ffi.from_buffer("int64_t[]", t_ns, require_writable=True),
        )
        return channels[:count], t_ns[:count]
