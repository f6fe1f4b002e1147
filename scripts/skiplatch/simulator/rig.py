"""A rig as the simulation takes it: chain, controller, seat of the probe, effects switched on."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Self

import numpy as np

from skiplatch.campaign import Kind, Nominal, Touches
from skiplatch.campaign.nominal import KEYS
from skiplatch.simulator.effects import Effect, effects, refuse_unknown
from skiplatch.simulator.library import CData, connection
from skiplatch.units import S_PER_MIN, UM_PER_MM, US_PER_S

BESIDE_THE_CHAIN = {("probe", "calibrated_at_c"), ("axis", "min_mm"), ("axis", "max_mm")}
"""Keys of nominal.toml that are no field of sim_chain_t."""

MOST_EFFECTS = 8  # SIM_EFFECTS_MAX of host_sim/effects/active.h
ROOM_MM = 10.0
"""For latches that come later than the nominal chain lets expect."""


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
    scan_phase_us: float = 0.0
    """A time at which a scan of the PLC begins; 0: anywhere in each replicate."""
    scan_spread_us: float = 0.0
    """By up to so much later than that, drawn for each replicate."""
    start_spread_us: float = 0.0
    """By up to so much the move of a touch on the PLC path begins later than it is to."""

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
class FilledRig:
    """A sim_rig_t, and what it points at: it is valid as long as these are kept."""

    structure: CData
    chain: CData
    controller: CData
    settings: CData


def with_believed(nominal: Nominal, switched_on: Sequence[Effect]) -> tuple[Effect, ...]:
    """Give the effects that the rig is believed to have, and those switched on."""
    believed = (Effect(effect.id, effect.values) for effect in nominal.believed_effects)
    return (*believed, *switched_on)


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
    ffi, _ = connection()
    effects_on = with_believed(nominal, switched_on)
    chain = _chain(ffi, nominal, seat)
    set_up = ffi.new("sim_controller_t *", asdict(controller))
    settings = _settings(ffi, effects_on)
    values = {
        "chain": chain,
        "controller": set_up,
        "settings": settings,
        "settings_count": len(effects_on),
        "seed": seed,
        "replicate": replicate,
    }
    return FilledRig(ffi.new("sim_rig_t *", values), chain, set_up, settings)


def _chain(ffi: CData, nominal: Nominal, seat: Seat | None) -> CData:
    """Fill sim_chain_t: a field is named after its key, or after section and key."""
    chain = ffi.new("sim_chain_t *")
    names = {name for name, _ in ffi.typeof("sim_chain_t").fields}
    for section, key in KEYS.keys() - BESIDE_THE_CHAIN:
        long_name = f"{section}_{key}"
        setattr(chain, long_name if long_name in names else key, nominal.number(section, key))
    chain.is_machine = nominal.kind == Kind.MACHINE
    chain.is_signed = nominal.version > 1
    if seat is not None:
        chain.seat = asdict(seat)
    return chain


def _settings(ffi: CData, switched_on: Sequence[Effect]) -> CData:
    """Fill an array of sim_setting_t, in the order of the table."""
    table = effects()
    for effect in switched_on:
        refuse_unknown(effect)
    settings = ffi.new("sim_setting_t[]", len(switched_on))
    ordered = sorted(switched_on, key=lambda effect: table[effect.id].index)
    for setting, effect in zip(settings, ordered, strict=True):
        setting.effect = table[effect.id].index
        for i, parameter in enumerate(table[effect.id].parameters):
            setting.parameters[i] = effect.parameters.get(parameter.name, parameter.when_unset)
    return settings
